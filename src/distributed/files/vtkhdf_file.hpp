// Writes a surface that all ranks made together into one VTKHDF file: HDF5 with the names that VTK
// gives an unstructured grid (version 1.0), of any size.
#pragma once

#include <span>

#include "mesh/element_color.hpp"

namespace vdwmesh {

class Ranks;
class SharedFile;
struct SurfacePiece;

// Whether this build has HDF5, without which the function below throws BackendUnavailable.
bool has_vtkhdf();

// Writes the pieces of all ranks. The file is one part of triangles: "Points" (double),
// "Connectivity" and "Offsets" (64 bits), "Types", and for the points "Normals" (float), "RGB"
// (bytes) and "atom" (int, -1 for none), in the order of the whole mesh and so the same for any
// number of ranks. `colors[i]` is the colour of sphere i of the whole set. The file still has to be
// given its name by commit(). Throws FileFormatError, on all ranks, if it cannot be written.
// Collective.
void write_vtkhdf(const Ranks& ranks, const SurfacePiece& piece, std::span<const RgbColor> colors,
                  SharedFile& file);

}  // namespace vdwmesh
