// SPDX-License-Identifier: Apache-2.0
#include "relume/error.h"

#include "text/printable.h"

namespace relume {

// Here and not where messages are put together: one place that forgets it is enough for a file to draw on a terminal.
Error::Error(ErrorKind kind, const std::string& message) : std::runtime_error(printable(message)), kind_(kind) {}

}  // namespace relume
