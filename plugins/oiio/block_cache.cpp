// SPDX-License-Identifier: Apache-2.0
#include "oiio/block_cache.h"

#include <algorithm>
#include <new>

#include "cache_budget.h"

namespace relume::oiio {

namespace {

void release(std::byte* data) { ::operator delete (data, std::align_val_t{kBlockAlignment}); }

}  // namespace

BlockMemory::BlockMemory(std::size_t bytes) : data_(BlockCache::instance().take(bytes)), bytes_(bytes) {}

BlockMemory::~BlockMemory() {
    if (data_) BlockCache::instance().give(data_, bytes_);
}

BlockCache::BlockCache() : limit_(cache_budget()) {}

BlockCache& BlockCache::instance() {
    // Never destroyed: hosts read until their last breath.
    static auto* const cache = new BlockCache;
    return *cache;
}

/// Takes blocks out until there is room for so many bytes, or one block is left. They are destroyed by the caller,
/// without the lock, since their memory comes back here.
BlockCache::Blocks BlockCache::dropped_for(std::size_t bytes) {
    Blocks dropped;
    while (blocks_.size() > 1 && bytes_ + bytes > limit_) {
        bytes_ -= blocks_.back()->memory.bytes();
        dropped.splice(dropped.begin(), blocks_, std::prev(blocks_.end()));
    }
    return dropped;
}

/// Frees spare memory, the oldest first, until there is room for so many bytes beside it and the blocks.
void BlockCache::trim_spare(std::size_t bytes) {
    while (!spare_.empty() && bytes_ + spare_bytes_ + bytes > limit_) {
        spare_bytes_ -= spare_.back().second;
        release(spare_.back().first);
        spare_.pop_back();
    }
}

std::byte* BlockCache::take(std::size_t bytes) {
    Blocks dropped;
    {
        const std::scoped_lock lock(mutex_);
        dropped = dropped_for(bytes);
    }
    dropped.clear();
    {
        const std::scoped_lock lock(mutex_);
        const auto found =
            std::find_if(spare_.begin(), spare_.end(), [&](const auto& memory) { return memory.second == bytes; });
        if (found != spare_.end()) {
            std::byte* const data = found->first;
            spare_.erase(found);
            spare_bytes_ -= bytes;
            return data;
        }
        trim_spare(bytes);
    }
    constexpr std::align_val_t alignment{kBlockAlignment};
    if (void* const data = ::operator new(bytes, alignment, std::nothrow)) return static_cast<std::byte*>(data);
    {
        const std::scoped_lock lock(mutex_);
        trim_spare(limit_);
    }
    return static_cast<std::byte*>(::operator new(bytes, alignment));
}

void BlockCache::give(std::byte* data, std::size_t bytes) {
    const std::scoped_lock lock(mutex_);
    if (bytes_ + bytes > limit_) {
        release(data);
        return;
    }
    trim_spare(bytes);
    spare_.emplace_front(data, bytes);
    spare_bytes_ += bytes;
}

void BlockCache::add(std::shared_ptr<const Block> block) {
    Blocks dropped;  // outlives the lock
    const std::scoped_lock lock(mutex_);
    bytes_ += block->memory.bytes();
    blocks_.push_front(std::move(block));
    dropped = dropped_for(0);
    trim_spare(0);
}

void BlockCache::touch(const std::shared_ptr<const Block>& block) {
    const std::scoped_lock lock(mutex_);
    if (!blocks_.empty() && blocks_.front() == block) return;
    const auto at = std::find(blocks_.begin(), blocks_.end(), block);
    if (at != blocks_.end()) blocks_.splice(blocks_.begin(), blocks_, at);
}

std::size_t BlockCache::limit() {
    const std::scoped_lock lock(mutex_);
    return limit_;
}

void BlockCache::set_limit(std::size_t bytes) {
    Blocks dropped;  // outlives the lock
    const std::scoped_lock lock(mutex_);
    limit_ = bytes;
    dropped = dropped_for(0);
    trim_spare(0);
}

std::size_t BlockCache::bytes() {
    const std::scoped_lock lock(mutex_);
    return bytes_;
}

std::size_t BlockCache::spare_bytes() {
    const std::scoped_lock lock(mutex_);
    return spare_bytes_;
}

}  // namespace relume::oiio
