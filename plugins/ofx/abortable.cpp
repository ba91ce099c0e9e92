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

}  // namespace relume::ofx
