// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace relume::oiio {

/// Where pictures in blocks start: what the widest vectors like.
inline constexpr std::size_t kBlockAlignment = 64;

/// Memory of a block, not cleared. It comes from the cache's spare memory where that has some of the same size, and
/// goes back there.
class BlockMemory {
public:
    BlockMemory() = default;
    explicit BlockMemory(std::size_t bytes);
    BlockMemory(BlockMemory&& other) noexcept
        : data_(std::exchange(other.data_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}
    BlockMemory& operator=(BlockMemory&& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(bytes_, other.bytes_);
        return *this;
    }
    ~BlockMemory();

    std::byte* data() const { return data_; }
    std::size_t bytes() const { return bytes_; }

private:
    std::byte* data_ = nullptr;
    std::size_t bytes_ = 0;
};

/// A rendered run of strips, all pictures of it.
struct Block {
    int first_row = 0;  ///< from the top of the data window
    int rows = 0;
    std::vector<std::byte*> pictures;  ///< components interleaved, rows without gaps; in `memory`
    BlockMemory memory;
};

/// The blocks of all frames of the process, the least recently used thrown away first. Their memory is kept for the
/// next ones: touching fresh pages costs a tenth of a relight, and a rig that is changed and read again wants blocks of
/// the same sizes. Thread-safe.
class BlockCache {
public:
    static BlockCache& instance();

    void add(std::shared_ptr<const Block> block);
    /// It was used.
    void touch(const std::shared_ptr<const Block>& block);

    /// Bytes of blocks and spare memory at the most; a block that is in use stays whatever its size.
    std::size_t limit();
    void set_limit(std::size_t bytes);
    /// Bytes of the blocks, and of the memory that none of them uses.
    std::size_t bytes();
    std::size_t spare_bytes();

private:
    friend class BlockMemory;
    using Blocks = std::list<std::shared_ptr<const Block>>;

    BlockCache();
    std::byte* take(std::size_t bytes);
    void give(std::byte* data, std::size_t bytes);
    Blocks dropped_for(std::size_t bytes);
    void trim_spare(std::size_t bytes);

    std::mutex mutex_;
    Blocks blocks_;
    std::size_t bytes_ = 0;
    std::list<std::pair<std::byte*, std::size_t>> spare_;  ///< the last that came back first
    std::size_t spare_bytes_ = 0;
    std::size_t limit_;
};

}  // namespace relume::oiio
