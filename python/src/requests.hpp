// Requests of the library from keyword arguments of Python. What was not said is None.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>

#include "request/mesh_request.hpp"
#include "request/names.hpp"

namespace vdwmesh::python {

template <class T>
std::optional<T> value_of(const pybind11::kwargs& given, const char* key) {
  if (!given.contains(key)) return std::nullopt;
  return given[key].cast<std::optional<T>>();
}

// Throws InvalidInput that lists the names, for another one.
template <class T>
std::optional<T> named(const pybind11::kwargs& given, const char* key) {
  const auto name = value_of<std::string>(given, key);
  if (!name) return std::nullopt;
  return value_named<T>(std::string(key) + ":", *name);
}

// Throws InvalidInput for other names than "auto", "cpu" and "cuda", and BackendUnavailable for
// "cuda" where no device is present.
Backend backend_of(const std::string& device);

// The keyword arguments of vdwmesh.read.
ReadOptions read_options_of(const pybind11::kwargs& given);

// surface, probe, topology and method; a topology that is not asked for is none.
ExactOptions exact_options_of(const pybind11::kwargs& given);

// The names are those of vdwmesh.mesh.
SurfaceOptions surface_options_of(const pybind11::kwargs& given);

// Of the surface "vdw", "sas" or "ses"; nothing stands for the usual radius. Å.
double probe_of(const std::string& surface, std::optional<double> probe);
bool is_excluded(const std::string& surface);

}  // namespace vdwmesh::python
