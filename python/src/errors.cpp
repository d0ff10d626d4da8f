// Finds the class in vdwmesh.errors that belongs to an exception. The classes are written in
// Python, where their bases and descriptions are read, and looked up by name when an exception
// comes.
#include "errors.hpp"

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <new>

#include "core/errors.hpp"

namespace vdwmesh::python {
namespace {

namespace py = pybind11;

void raise(const char* name, const char* message) {
  const py::object type = py::module_::import("vdwmesh.errors").attr(name);
  PyErr_SetString(type.ptr(), message);
}

// Derived classes come before their bases. Exceptions of Python itself pass.
void translate(std::exception_ptr error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const InvalidInput& e) {
    raise("InvalidInput", e.what());
  } catch (const FileFormatError& e) {
    raise("FileFormatError", e.what());
  } catch (const BackendUnavailable& e) {
    raise("BackendUnavailable", e.what());
  } catch (const CudaError& e) {
    raise("CudaError", e.what());
  } catch (const LimitExceeded& e) {
    raise("LimitExceeded", e.what());
  } catch (const InternalError& e) {
    raise("InternalError", e.what());
  } catch (const Error& e) {
    raise("Error", e.what());
  } catch (const std::bad_alloc&) {
    raise("LimitExceeded", "out of memory");
  } catch (const std::filesystem::filesystem_error& e) {
    raise("FileFormatError", fmt::format("{}: {}", e.path1().string(), e.code().message()).c_str());
  }
}

}  // namespace

void translate_errors() { py::register_exception_translator(&translate); }

}  // namespace vdwmesh::python
