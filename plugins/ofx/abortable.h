// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>

#include "ofx_abi.h"

namespace relume::ofx {

/// Runs `work` in a thread of its own while this one asks the host every few milliseconds whether to stop; then
/// `cancel` is set, and Error(cancelled) comes out once `work` has ended. What `work` throws is thrown here. The host
/// is asked in this thread alone, the one that it called.
void run_abortable(OfxImageEffectHandle effect, const std::function<void(const std::atomic<bool>& cancel)>& work);

/// The same without another thread, for work that calls `ask` every few milliseconds, from any thread; this thread's
/// calls are those that count. Starting threads costs a small tile more than its pixels do.
void run_abortable_here(
    OfxImageEffectHandle effect,
    const std::function<void(const std::atomic<bool>& cancel, const std::function<void()>& ask)>& work);

/// How often the host is asked.
inline constexpr int kAskMilliseconds = 4;

}  // namespace relume::ofx
