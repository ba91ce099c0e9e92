// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"

#include <limits>
#include <optional>

#include "relume/error.h"

namespace relume::python {

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorKind::value, message); }

std::optional<PixelType> pixel_type(const py::dtype& dtype) {
    if (dtype.kind() == 'f' && dtype.itemsize() == 4) return PixelType::float32;
    if (dtype.kind() == 'f' && dtype.itemsize() == 2) return PixelType::half;
    if (dtype.kind() == 'u' && dtype.itemsize() == 4) return PixelType::uint32;
    return std::nullopt;
}

ArrayPlanes planes_of(const py::array& array, const std::string& name, const std::byte* data) {
    const py::dtype dtype = array.dtype();
    const auto type = pixel_type(dtype);
    const auto dtype_name = py::str(dtype).cast<std::string>();
    if (!type) {
        const bool whole = dtype.kind() == 'i' || dtype.kind() == 'u';
        refuse(name + ": an array of " + dtype_name +
               "; float32 and float16 (and uint32 for IDs) are taken without a copy: convert it by .astype(numpy." +
               (whole ? "uint32) if it holds IDs, else .astype(numpy.float32)" : "float32)"));
    }
    if (!dtype.attr("isnative").cast<bool>())
        refuse(name + ": an array of the other byte order (" + dtype_name + "): convert it by .astype(numpy." +
               py::str(dtype.attr("newbyteorder")("=")).cast<std::string>() + ")");
    if ((array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) == 0)
        refuse(name + ": its elements are not aligned in memory: make a copy by numpy.array(...)");
    if (array.ndim() != 2 && array.ndim() != 3)
        refuse(name + ": an array of " + std::to_string(array.ndim()) +
               " dimensions; give (height, width) or (height, width, components)");
    for (py::ssize_t k = 0; k < 2; ++k)
        if (array.shape(k) > std::numeric_limits<int>::max())
            refuse(name + ": larger than 2147483647 pixels along one side");

    ArrayPlanes result;
    result.height = static_cast<int>(array.shape(0));
    result.width = static_cast<int>(array.shape(1));
    const py::ssize_t components = array.ndim() == 3 ? array.shape(2) : 1;
    if (components < 1 || components > 4)
        refuse(
            name + ": shape (" + std::to_string(array.shape(0)) + ", " + std::to_string(array.shape(1)) + ", " +
            std::to_string(components) + "); give (height, width, components), the components last" +
            (array.shape(0) <= 4 ? ": this one looks like components first, turn it by numpy.moveaxis(a, 0, -1)" : ""));
    for (py::ssize_t c = 0; c < components; ++c) {
        Plane plane;
        // The planes of inputs become ConstPlane before anyone could write to them.
        plane.data = const_cast<std::byte*>(data) + (array.ndim() == 3 ? c * array.strides(2) : 0);
        plane.type = *type;
        plane.y_stride = array.strides(0);
        plane.x_stride = array.strides(1);
        result.planes.push_back(plane);
    }
    return result;
}

}  // namespace

ArrayPlanes planes_for_reading(const py::array& array, const std::string& name) {
    return planes_of(array, name, static_cast<const std::byte*>(array.data()));
}

ArrayPlanes planes_for_writing(const py::array& array, const std::string& name) {
    if (!array.writeable()) refuse(name + ": the array is read-only");
    return planes_of(array, name, static_cast<const std::byte*>(array.data()));
}

}  // namespace relume::python
