// Writes a surface that all ranks made together into one PLY file.
#pragma once

#include <span>

#include "mesh/element_color.hpp"

namespace vdwmesh {

struct MeshSize;
class Ranks;
class SharedFile;
struct SurfacePiece;

// Throws LimitExceeded if a mesh of this size has more vertices than a PLY file can have.
void check_ply_size(const MeshSize& size);

// Writes the pieces of all ranks. The file has the same bytes as that of write_mesh() for the whole
// mesh after color_by_element(). `colors[i]` is the colour of sphere i of the whole set. The file
// still has to be given its name by commit(). Collective.
void write_ply(const Ranks& ranks, const SurfacePiece& piece, std::span<const RgbColor> colors,
               SharedFile& file);

}  // namespace vdwmesh
