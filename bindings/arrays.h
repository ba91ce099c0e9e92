// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>

#include <string>
#include <vector>

#include "bindings.h"
#include "relume/image.h"

namespace relume::python {

/// A numpy array of shape (H, W) or (H, W, C) as planes over its own memory: nothing is copied.
struct ArrayPlanes {
    int height = 0;
    int width = 0;
    std::vector<Plane> planes;  ///< one per component
};

/// Throws Error(value) that says how to convert when the array is of another kind: float32, float16 and uint32 in
/// native byte order are taken. `name` is what messages call it.
ArrayPlanes planes_for_reading(const py::array& array, const std::string& name);
ArrayPlanes planes_for_writing(const py::array& array, const std::string& name);

}  // namespace relume::python
