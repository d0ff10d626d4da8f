// Meshes a saddle, or half of a spindle, between the sample points on the curves around it. The
// saddle is mapped to the plane (saddle_chart.hpp) and meshed there as patches of spheres are
// (creases/patch/patch_mesher.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "creases/patch/patch_mesher.hpp"
#include "excluded/mesher/curve_complex.hpp"

namespace vdwmesh::excluded {

// A sample point of a curve.
struct CurvePoint {
  std::uint32_t curve, index;
};

// The outcome: either triangles, or requests to split pieces of curves. Vertices of triangles are
// numbered: first the points of the boundary, then the interior ones. Positions are those of the
// accessible surface: scaled, and relative to AccessibleSurface::origin. Normals have length 1.
struct SaddleMesh {
  std::vector<CurvePoint> boundary;
  PatchVector<Vec3d> interior, normals;                 // relative to the origin, scaled
  PatchVector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside
  PatchVector<PieceSplit> splits;                       // requests, in no order
};

// `edge_length` of the options is scaled. `plane` is working memory, for use again and again.
// Throws CoincidentPoints, Cancelled.
SaddleMesh mesh_saddle(const CurveComplex& complex, const ArcSampling& sampling,
                       const SaddleFace& face, const PatchOptions& options,
                       PlaneTriangulation& plane);

}  // namespace vdwmesh::excluded
