// Options of the library from keyword arguments of Python, which several topics take.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "measures/exact_union.hpp"
#include "structure/reader.hpp"

namespace vdwmesh::python {

// The keyword arguments of vdwmesh.read.
ReadOptions read_options_of(const pybind11::kwargs& given);

// "auto", "cgal", "arcs" or "both"; throws InvalidInput.
UnionMethod method_of(const std::string& name);
const std::string& name_of(UnionMethod method);

// "none", "counts" or "full": the Python layer knows these names alone.
TopologyRequest topology_of(const std::string& name);

}  // namespace vdwmesh::python
