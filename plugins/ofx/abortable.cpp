// SPDX-License-Identifier: Apache-2.0
#include "abortable.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "host.h"
#include "relume/error.h"

namespace relume::ofx {

void run_abortable(OfxImageEffectHandle effect, const std::function<void(const std::atomic<bool>&)>& work) {
    std::atomic<bool> cancel{false};
    if (host().effect->abort == nullptr) {
        work(cancel);
        return;
    }
    if (aborted(effect)) throw Error(ErrorKind::cancelled, "cancelled");
    std::mutex mutex;
    std::condition_variable ended;
    bool done = false;
    std::exception_ptr failure;
    std::thread worker([&] {
        try {
            work(cancel);
        } catch (...) {
            failure = std::current_exception();
        }
        const std::scoped_lock lock(mutex);
        done = true;
        ended.notify_one();
    });
    {
        std::unique_lock lock(mutex);
        while (!ended.wait_for(lock, std::chrono::milliseconds(kAskMilliseconds), [&] { return done; })) {
            lock.unlock();
            if (!cancel && aborted(effect)) cancel = true;
            lock.lock();
        }
    }
    worker.join();
    if (failure) std::rethrow_exception(failure);
    if (cancel) throw Error(ErrorKind::cancelled, "cancelled");
}

void run_abortable_here(OfxImageEffectHandle effect,
                        const std::function<void(const std::atomic<bool>&, const std::function<void()>&)>& work) {
    using Clock = std::chrono::steady_clock;
    std::atomic<bool> cancel{false};
    const std::thread::id caller = std::this_thread::get_id();
    Clock::time_point asked{};
    const auto ask = [&] {
        if (std::this_thread::get_id() != caller) return;
        const Clock::time_point now = Clock::now();
        if (now - asked < std::chrono::milliseconds(kAskMilliseconds)) return;
        asked = now;
        if (aborted(effect)) cancel = true;
    };
    ask();
    if (!cancel) work(cancel, ask);
    if (cancel) throw Error(ErrorKind::cancelled, "cancelled");
}

}  // namespace relume::ofx
