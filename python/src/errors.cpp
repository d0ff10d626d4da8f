// Finds the class in vdwmesh.errors that belongs to an exception. The classes are written in
// Python, where their bases and descriptions are read, and looked up by name when an exception
// comes.
#include "errors.hpp"

#include <fmt/format.h>

#include <array>
#include <exception>
#include <filesystem>
#include <new>

#include "core/errors.hpp"

namespace vdwmesh::python {
namespace {

namespace py = pybind11;

void raise(const char* name, std::string_view message) {
  const py::object type = py::module_::import("vdwmesh.errors").attr(name);
  PyErr_SetObject(type.ptr(), message_of(message).ptr());
}

py::object decoded(std::string_view bytes, const char* otherwise) {
  const auto size = static_cast<Py_ssize_t>(bytes.size());
  py::object text =
      py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(bytes.data(), size, otherwise));
  if (!text) throw py::error_already_set();
  return text;
}

template <class Kind>
bool is_a(const Error& error) {
  return dynamic_cast<const Kind*>(&error) != nullptr;
}

struct Class {
  const char* name;
  bool (*holds)(const Error&);
};

// Of each cause; what is none of these is an Error.
constexpr std::array kClasses{Class{"InvalidInput", &is_a<InvalidInput>},
                              Class{"FileFormatError", &is_a<FileFormatError>},
                              Class{"BackendUnavailable", &is_a<BackendUnavailable>},
                              Class{"CudaError", &is_a<CudaError>},
                              Class{"LimitExceeded", &is_a<LimitExceeded>},
                              Class{"InternalError", &is_a<InternalError>}};

const char* class_of(const Error& error) {
  for (const Class& c : kClasses) {
    if (c.holds(error)) return c.name;
  }
  return "Error";
}

// Exceptions of Python itself pass.
void translate(std::exception_ptr error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const Error& e) {
    raise(class_of(e), e.what());
  } catch (const std::bad_alloc&) {
    raise("LimitExceeded", "out of memory");
  } catch (const std::filesystem::filesystem_error& e) {
    raise("FileFormatError", fmt::format("{}: {}", e.path1().string(), e.code().message()));
  }
}

}  // namespace

py::object text_of(std::string_view bytes) { return decoded(bytes, "surrogateescape"); }

py::object message_of(std::string_view message) {
  static const char* const kTerms = "in_terms_of_python";
  return py::module_::import("vdwmesh.errors").attr(kTerms)(decoded(message, "backslashreplace"));
}

void translate_errors() { py::register_exception_translator(&translate); }

}  // namespace vdwmesh::python
