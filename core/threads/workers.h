// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>

namespace relume {

/// Threads to use when the caller names none: the CPUs that the process may run on (affinity, cgroup masks).
int default_threads();

/// Calls work(worker, index) for every index in [0, count), each once, in rising order of their start, on `threads`
/// threads; worker is in [0, threads). With one thread nothing is started. The first exception stops the hand-out and
/// is thrown here; `cancel` (may be null) becoming true ends in Error(cancelled).
void parallel_for(int count, int threads, const std::atomic<bool>* cancel,
                  const std::function<void(int worker, int index)>& work);

}  // namespace relume
