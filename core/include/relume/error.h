// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "relume/export.h"

namespace relume {

/// What kind of thing went wrong: callers branch on this (Python maps each to one exception class, the command line to
/// one exit code); people read the message.
enum class ErrorKind : std::uint8_t {
    file,       ///< missing, unreadable or unwritable file, full disk
    format,     ///< not an EXR, damaged, truncated, or beyond the sanity limits
    channel,    ///< a channel that is needed is missing, ambiguous, or has the wrong size
    rig,        ///< the rig is not TOML, or holds an unknown or ill-typed key
    parameter,  ///< unknown shader, light or parameter; value out of its range
    value,      ///< a bad argument: array shapes, sizes, thread counts
    plugin,     ///< a shader plugin that cannot be loaded
    cancelled,  ///< the caller asked to stop
};

/// The one exception type of librelume. `what()` says what is wrong, where (file, channel, line and column) and what to
/// do about it, in one line of UTF-8: whatever a file or a user put into it is escaped.
class RELUME_API Error : public std::runtime_error {
public:
    Error(ErrorKind kind, const std::string& message);
    ErrorKind kind() const noexcept { return kind_; }

private:
    ErrorKind kind_;
};

}  // namespace relume
