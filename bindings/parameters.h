// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/typing.h>

#include <span>

#include "bindings.h"
#include "relume/parameter.h"

namespace relume::python {

py::tuple parameter_tuple(std::span<const Parameter> table);

}  // namespace relume::python
