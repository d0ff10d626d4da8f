// vdwmesh._core: the library for the package vdwmesh, whose Python layer checks arguments, names
// results and is what users see.
#include <pybind11/pybind11.h>

#include "arrays.hpp"
#include "errors.hpp"
#include "topics.hpp"

PYBIND11_MODULE(_core, module) {
  using namespace vdwmesh::python;
  module.doc() = "The C++ side of vdwmesh; use the package vdwmesh.";
  module.attr("version") = VDWMESH_VERSION;
  translate_errors();
  bind_arrays(module);
  bind_cuda_arrays(module);
  bind_requests(module);
  bind_structures(module);
  bind_measures(module);
  bind_excluded(module);
  bind_gradients(module);
  bind_interfaces(module);
  bind_pockets(module);
  bind_meshes(module);
  bind_volumes(module);
  bind_checks(module);
  bind_batches(module);
}
