// The topics of the module, one source each. Functions of Python are thin: they take what the
// Python layer has brought into form, call the library by call(), and hand its results back.
#pragma once

#include <pybind11/pybind11.h>

namespace vdwmesh::python {

void bind_requests(pybind11::module_& module);    // requests.cpp: checks of arguments
void bind_structures(pybind11::module_& module);  // structures.cpp: files, radii
void bind_measures(pybind11::module_& module);    // measures.cpp: exact measures
void bind_gradients(pybind11::module_& module);   // gradients.cpp: rates, sparse derivatives
void bind_excluded(pybind11::module_& module);    // excluded.cpp: the solvent-excluded surface
void bind_interfaces(pybind11::module_& module);  // interfaces.cpp: buried areas, contacts
void bind_pockets(pybind11::module_& module);     // pockets.cpp: pockets, channels, voids
void bind_meshes(pybind11::module_& module);      // meshes.cpp: meshes of spheres, of arrays, files
void bind_cuda_arrays(pybind11::module_& module);  // cuda_array.cpp: arrays in device memory
void bind_volumes(pybind11::module_& module);      // volumes.cpp: marching cubes over a volume
void bind_batches(pybind11::module_& module);      // batches.cpp: many structures
void bind_checks(pybind11::module_& module);       // checks.cpp: quality, comparison, distances

}  // namespace vdwmesh::python
