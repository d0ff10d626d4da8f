// The argument `device` of Python.
#pragma once

#include <string>

#include "cuda/backend.hpp"

namespace vdwmesh::python {

// "auto", "cpu" or "cuda". Throws InvalidInput for other names, and BackendUnavailable for "cuda"
// where no device is present.
Backend backend_of(const std::string& device);

}  // namespace vdwmesh::python
