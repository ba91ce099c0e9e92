// SPDX-License-Identifier: Apache-2.0
#include "background.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

namespace relume::python {

void run_in_background(const std::function<void(Task&)>& work, const py::object& progress) {
    Task task;
    std::mutex mutex;
    std::condition_variable ended;
    bool done = false;
    std::exception_ptr failure;
    std::optional<py::error_already_set> interruption;
    {
        const py::gil_scoped_release release;
        std::thread worker([&] {
            std::exception_ptr caught;
            try {
                work(task);
            } catch (...) {
                caught = std::current_exception();
            }
            const std::lock_guard lock(mutex);
            failure = caught;
            done = true;
            ended.notify_one();
        });
        std::unique_lock lock(mutex);
        while (!ended.wait_for(lock, std::chrono::milliseconds(50), [&] { return done; })) {
            if (interruption) continue;
            lock.unlock();
            {
                const py::gil_scoped_acquire acquire;
                try {
                    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
                    if (!progress.is_none()) progress(task.progress.load());
                } catch (py::error_already_set& error) {
                    interruption.emplace(error);
                    task.cancel = true;
                }
            }
            lock.lock();
        }
        lock.unlock();
        worker.join();
    }
    if (interruption) throw py::error_already_set(*interruption);
    if (failure) std::rethrow_exception(failure);
    if (!progress.is_none()) progress(1.0);
}

}  // namespace relume::python
