// Exceptions of the library as exceptions of Python.
#pragma once

#include <pybind11/pybind11.h>

namespace vdwmesh::python {

// From now on an exception of core/errors.hpp becomes the class of the same name in vdwmesh.errors,
// with its one line as the message. std::bad_alloc and errors of std::filesystem become
// LimitExceeded and FileFormatError; every other exception is our own fault, an InternalError.
void translate_errors();

}  // namespace vdwmesh::python
