// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>

#include "bindings.h"

namespace relume::python {

/// What long work is given: when to stop, and where to say how far it is (from any thread).
struct Task {
    std::atomic<bool> cancel{false};
    std::atomic<double> progress{0};
};

/// Runs `work` in a thread of its own with the GIL released. Meanwhile the calling thread, several times a second,
/// looks for signals (Ctrl-C sets `cancel` and becomes KeyboardInterrupt when the work has ended) and calls `progress`
/// (a callable that takes the share done, or None); an exception in it cancels too. Exceptions of the work come out
/// here.
void run_in_background(const std::function<void(Task&)>& work, const py::object& progress);

}  // namespace relume::python
