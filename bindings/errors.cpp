// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <filesystem>
#include <stdexcept>

#include "bindings.h"
#include "relume/error.h"
#include "text/printable.h"

namespace relume::python {

namespace {

const char* class_name(ErrorKind kind) {
    switch (kind) {
        case ErrorKind::file:
            return "FileError";
        case ErrorKind::format:
            return "FormatError";
        case ErrorKind::channel:
            return "ChannelError";
        case ErrorKind::rig:
            return "RigError";
        case ErrorKind::parameter:
            return "ParameterError";
        case ErrorKind::value:
            return "ArgumentError";
        case ErrorKind::plugin:
            return "PluginError";
        case ErrorKind::cancelled:
            return "Cancelled";
    }
    return "Error";
}

void raise(const char* name, const char* message) {
    // The classes are written in Python (relume/errors.py), where they can be documented and typed.
    const py::object type = py::module_::import("relume.errors").attr(name);
    PyErr_SetString(type.ptr(), message);
}

void translate(std::exception_ptr pointer) {
    try {
        if (pointer) std::rethrow_exception(pointer);
    } catch (const Error& error) {
        raise(class_name(error.kind()), error.what());
    } catch (const std::filesystem::filesystem_error& error) {
        raise("FileError", printable(error.what()).c_str());
    }
}

}  // namespace

void bind_errors(py::module_&) { py::register_exception_translator(&translate); }

}  // namespace relume::python
