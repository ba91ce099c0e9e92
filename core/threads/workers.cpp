// SPDX-License-Identifier: Apache-2.0
#include "threads/workers.h"

#if defined(__linux__)
#  include <sched.h>
#endif

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "relume/error.h"

namespace relume {

int default_threads() {
#if defined(__linux__)
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) == 0) return std::max(1, CPU_COUNT(&set));
#endif
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for(int count, int threads, const std::atomic<bool>* cancel, const std::function<void(int, int)>& work) {
    std::atomic<int> next{0};
    std::atomic<bool> stop{false};
    std::exception_ptr failure;
    std::mutex failure_mutex;
    const auto run = [&](int worker) {
        try {
            for (;;) {
                if (stop.load(std::memory_order_relaxed)) return;
                if (cancel != nullptr && cancel->load(std::memory_order_relaxed))
                    throw Error(ErrorKind::cancelled, "cancelled");
                const int index = next.fetch_add(1, std::memory_order_relaxed);
                if (index >= count) return;
                work(worker, index);
            }
        } catch (...) {
            const std::scoped_lock lock(failure_mutex);
            if (!failure) failure = std::current_exception();
            stop = true;
        }
    };
    {
        std::vector<std::jthread> pool;
        const int extra = std::min(threads, count) - 1;
        for (int k = 1; k <= extra; ++k) pool.emplace_back(run, k);
        run(0);
    }
    if (failure) std::rethrow_exception(failure);
}

}  // namespace relume
