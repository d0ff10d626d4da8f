// A VTKHDF file before there is anything in its arrays: its groups and attributes, and where the
// arrays are to be written.
#pragma once

#include <cstdint>
#include <vector>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Places in the file, in bytes. The elements of an array stand there in their order, without gaps,
// in this machine's order of bytes.
struct VtkHdfPlaces {
  std::uint64_t points;        // 3 doubles for each vertex
  std::uint64_t normals;       // 3 floats for each vertex
  std::uint64_t colors;        // 3 bytes for each vertex
  std::uint64_t atoms;         // an int of 32 bits for each vertex
  std::uint64_t connectivity;  // 3 ints of 64 bits for each triangle
  std::uint64_t offsets;       // an int of 64 bits for each triangle, and one more
  std::uint64_t types;         // a byte for each triangle
};

// Bytes of the file, from `place` on.
struct VtkHdfBytes {
  std::uint64_t place;
  std::vector<char> bytes;
};

struct VtkHdfLayout {
  VtkHdfPlaces places;
  std::vector<VtkHdfBytes> around;  // all of the file that is in no array
};

// The VTKHDF file of a mesh of this size, which is not empty. It is laid out in a scratch file of
// the folder for temporary files. Throws FileFormatError, which names that file, if it cannot be
// written or be that long, and BackendUnavailable if this build has no HDF5.
VtkHdfLayout lay_out_vtkhdf(const MeshSize& size);

}  // namespace vdwmesh
