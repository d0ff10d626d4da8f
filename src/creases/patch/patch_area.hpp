// The area of a patch's mesh beside that of the patch: which pieces of the boundary have to be
// split so that they agree. A narrow patch between long arcs would lose or gain a noticeable part
// of its area by the chords that replace its arcs.
#pragma once

#include "creases/arcs/patch_boundary.hpp"

namespace vdwmesh {

// The error of the area of one patch's mesh may be kLargestAreaError of the patch's area, or of
// kCountedArea squares of the edge length for a smaller patch, which has too few triangles; or
// kFlatTriangleErrors times what flat triangles lose inside the patch in any case, if that is more.
inline constexpr double kLargestAreaError = 0.009;
inline constexpr double kCountedArea = 25;
inline constexpr double kFlatTriangleErrors = 2;

// What the flat triangles of a patch lack, about; `area` and `edge_length` are those of the patch,
// on the unit sphere.
double flat_triangle_error(double area, double edge_length);

// The area between a piece and its arc, about, on the unit sphere: positive if the arc leaves its
// chord towards the inside of the patch, so that the mesh has the area too much.
double lens_area(const PatchBoundary& boundary, const BoundaryPiece& piece);

// Appends requests to halve pieces, until the area of the mesh is as near to that of the patch as
// above: the pieces with the largest lenses, and all with equal ones. None if it is so near
// already.
void split_for_area(const PatchBoundary& boundary, double area, double edge_length,
                    PatchVector<PieceSplit>& splits);

}  // namespace vdwmesh
