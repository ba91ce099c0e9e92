// SPDX-License-Identifier: Apache-2.0
#include "io/ordered_chunks.h"

#include <utility>

namespace relume::io {

OrderedChunks::OrderedChunks(OutputFile& file, std::size_t count, std::uint64_t offset, std::size_t queue_bytes)
    : file_(file), end_(offset), queue_limit_(queue_bytes), received_(count), offsets_(count) {}

// Called with the lock held and `writing_` set, so that no other thread moves the file's end meanwhile.
void OrderedChunks::write(std::size_t number, std::span<const std::byte> leader, std::span<const std::byte> data,
                          std::unique_lock<std::mutex>& lock) {
    const std::uint64_t offset = end_;
    lock.unlock();
    std::exception_ptr failure;
    try {
        file_.write(leader, data, offset);
    } catch (...) {
        failure = std::current_exception();
    }
    lock.lock();
    if (failure) {
        failure_ = failure;
        return;
    }
    end_ += leader.size() + data.size();
    offsets_[number] = offset;
    while (next_ < offsets_.size() && offsets_[next_] != 0) {
        ++next_;
    }
}

// Writes what may be written: the next in order, and while the queue is too full the lowest of it.
void OrderedChunks::drain(std::unique_lock<std::mutex>& lock) {
    while (!failure_ && !queue_.empty() && (queue_.begin()->first == next_ || queued_bytes_ > queue_limit_)) {
        auto chunk = queue_.extract(queue_.begin());
        write(chunk.key(), chunk.mapped().leader, chunk.mapped().data, lock);
        queued_bytes_ -= chunk.mapped().leader.size() + chunk.mapped().data.size();
        progress_.notify_all();
    }
}

bool OrderedChunks::put(std::size_t number, std::span<const std::byte> leader, std::span<const std::byte> data) {
    std::unique_lock lock(mutex_);
    if (received_[number]) {
        return false;
    }
    received_[number] = true;
    // Only while another thread is writing, which makes room, does anybody wait.
    progress_.wait(lock, [&] { return failure_ || !writing_ || queued_bytes_ <= queue_limit_; });
    if (failure_) {
        std::rethrow_exception(failure_);
    }
    if (writing_ || number != next_) {
        queue_.emplace(number, Waiting{{leader.begin(), leader.end()}, {data.begin(), data.end()}});
        queued_bytes_ += leader.size() + data.size();
    }
    if (!writing_) {
        writing_ = true;
        if (number == next_) {
            write(number, leader, data, lock);
        }
        drain(lock);
        writing_ = false;
        progress_.notify_all();
    }
    if (failure_) {
        std::rethrow_exception(failure_);
    }
    return true;
}

}  // namespace relume::io
