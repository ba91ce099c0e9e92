// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "relume/error.h"
#include "relume/parameter.h"

namespace relume::rigfile {

/// An Error(parameter) whose parts are kept, so that whoever knows the place in the file can put it in between:
/// "unknown key 'exposur' in light 'key'" + " at key.relume:12:1" + "; did you mean 'exposure'?".
class Problem : public Error {
public:
    enum class Cause { name, type, range };

    Problem(Cause cause, const std::string& message, const std::string& hint = {})
        : Error(ErrorKind::parameter, message + hint), cause_(cause), message_(message), hint_(hint) {}

    /// The same, as it is said of a file. `place` is "key.relume:12:1". Names and types are the file's own fault
    /// (Error(rig)), a value out of its range is one of parameters wherever it comes from.
    Error at(const std::string& place) const {
        return {cause_ == Cause::range ? ErrorKind::parameter : ErrorKind::rig, message_ + " at " + place + hint_};
    }

private:
    Cause cause_;
    std::string message_;
    std::string hint_;
};

/// Longer texts than this are not repeated in full in a hint.
inline constexpr std::size_t kLongestHint = 60;

/// The text on one line: control characters escaped, cut after some 60 bytes. Whatever a file or a user says goes
/// through this before it stands in a message.
std::string one_line(std::string_view text);
/// The same in single quotes.
std::string in_quotes(std::string_view text);

/// "; did you mean 'exposure'?", or "; there are a, b, c" when nothing is near.
std::string suggestion(std::string_view word, std::span<const std::string_view> candidates);

/// The row of that name. Throws Problem(name).
const Parameter& require_row(std::span<const Parameter> table, std::string_view name, std::string_view what);
const Parameter* find_row(std::span<const Parameter> table, std::string_view name);

}  // namespace relume::rigfile
