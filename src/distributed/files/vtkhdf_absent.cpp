// Stands in place of vtkhdf_layout.cpp in a build without HDF5.
#include "core/errors.hpp"
#include "distributed/files/vtkhdf_file.hpp"
#include "distributed/files/vtkhdf_layout.hpp"

namespace vdwmesh {

bool has_vtkhdf() { return false; }

VtkHdfLayout lay_out_vtkhdf(const MeshSize&) { throw BackendUnavailable("this build has no HDF5"); }

}  // namespace vdwmesh
