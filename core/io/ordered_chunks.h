// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "io/output_file.h"

namespace relume::io {

/// Puts chunks into a file in the order of their numbers, whatever the order in which threads hand them in.
///
/// A chunk whose turn has come is written by the thread that brings it, together with those that waited for it. Others
/// are copied into a queue. When the queue is full (say one thread hands in the rows from bottom to top) the lowest of
/// them is written out of turn, which a file's offset table allows, so no order of calls blocks or takes more memory.
class OrderedChunks {
public:
    /// `count` chunks will come; the first goes to `offset`.
    OrderedChunks(OutputFile& file, std::size_t count, std::uint64_t offset, std::size_t queue_bytes);

    /// `leader` and `data` make one chunk. Thread-safe. False when chunk `number` was put before. Throws Error(file)
    /// when the file can't be written, from then on for every call.
    bool put(std::size_t number, std::span<const std::byte> leader, std::span<const std::byte> data);

    /// Where each chunk is, 0 for those that never came. To be called when no thread is in put().
    const std::vector<std::uint64_t>& offsets() const { return offsets_; }

private:
    struct Waiting {
        std::vector<std::byte> leader;
        std::vector<std::byte> data;
    };

    void write(std::size_t number, std::span<const std::byte> leader, std::span<const std::byte> data,
               std::unique_lock<std::mutex>& lock);
    void drain(std::unique_lock<std::mutex>& lock);

    OutputFile& file_;
    std::uint64_t end_;
    std::size_t queue_limit_;
    std::mutex mutex_;
    std::condition_variable progress_;
    std::map<std::size_t, Waiting> queue_;
    std::size_t queued_bytes_ = 0;
    std::size_t next_ = 0;
    bool writing_ = false;
    std::vector<bool> received_;
    std::vector<std::uint64_t> offsets_;
    std::exception_ptr failure_;
};

}  // namespace relume::io
