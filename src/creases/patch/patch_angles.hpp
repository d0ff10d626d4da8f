// The bound on the angles of a patch's triangles (ExactMeshOptions::min_angle): which triangles are
// below it, and which pieces of the boundary are in the way of better ones. On the host alone.
//
// Circumcentres of bad triangles are inserted in any case (patch_triangulator.hpp), but where they
// would be too near to a piece; there triangles stay bad. With a bound, such a piece is split, as
// in Chew's algorithm ("Guaranteed-quality mesh generation for curved surfaces", 1993).
//
// Where two arcs enclose less than 60° this alone would not end: the halves of a piece of one arc
// are in the way of triangles at the other arc, and so on towards the corner. Ruppert ("A Delaunay
// refinement algorithm for quality 2-dimensional mesh generation", 1995) protects such corners by
// concentric shells. Here the first shell is as wide as the two pieces at the corner, whose lengths
// differ by at most a factor of two (kCornerRatio), and the second one as wide again. Triangles in
// the two are excused. The first one always has small angles if the arcs enclose one, and in the
// second one the pieces may become shorter with the distance from the corner, as far as the patch
// is narrow there.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "creases/arcs/patch_boundary.hpp"
#include "creases/arcs/patch_vector.hpp"
#include "creases/plane/patch_triangles.hpp"
#include "creases/plane/plane_triangulation.hpp"
#include "creases/plane/row_lists.hpp"
#include "creases/plane/stereographic.hpp"

namespace vdwmesh {

// A corner of a patch is sharp if the angle between the two arcs there is less than this. From 60°
// on, two arcs are not in the way of each other's triangles for ever (Ruppert).
inline constexpr double kSharpCorner = 60;  // degrees
// The triangles of the patch are excused whose vertices are at most so far from a sharp corner, as
// a multiple of the longer one of the patch's two pieces there.
inline constexpr double kShells = 2;

// Pieces shorter than this fraction of the edge length are not split for angles. Along a strip of
// the patch, as many are needed as it is longer than wide.
inline constexpr double kShortestForAngles = 1e-5;

// How many triangles are below the bound: those excused, and all others.
struct SmallAngles {
  std::uint64_t at_corners = 0, elsewhere = 0;
};

// The argument of a complex number, in [0, 2 pi), with the same bits on every version of the C
// library; NaN for 0.
double argument(double re, double im);
// The angle by which direction a must be turned counter-clockwise to come to b, as seen from
// outside at the point `apex` of the unit sphere; from 0 to a whole turn.
double turn(const Vec3d& apex, const Vec3d& a, const Vec3d& b);

// The lengths of a boundary's pieces, on the unit sphere, and the longest of some. Keeps a view.
class PieceChords {
 public:
  explicit PieceChords(const PatchBoundaryView& boundary) : boundary_(boundary) {}
  double of(std::uint32_t piece) const {
    const BoundaryPiece& p = boundary_.pieces[piece];
    return norm(boundary_.points[p.to] - boundary_.points[p.from]);
  }
  // The longer one of two pieces, the first one if they are equal. kNoPiece is none.
  std::uint32_t longer(std::uint32_t one, std::uint32_t other) const {
    if (other == kNoPiece) return one;
    return one == kNoPiece || of(other) > of(one) ? other : one;
  }
  // Of all pieces but one that end in a vertex of the triangle, the longest; of equal ones the
  // first of the boundary. The pieces at each point are listed when they are first asked for.
  std::uint32_t longest_at_vertices(const LinkedTriangle& t, std::uint32_t but = kNoPiece) const;

 private:
  PatchBoundaryView boundary_;
  mutable RowLists at_points_;
};

class AngleBound {
 public:
  // `angle`: the least one that triangles shall have, rad. `edge_length` is that of the patch, on
  // the unit sphere; pieces up to kShortestForAngles of it are not asked to be split. Keeps a view
  // of the boundary.
  AngleBound(const PatchBoundaryView& boundary, double angle, double edge_length);

  // The sine of the angle below which circumcentres are inserted. It is somewhat larger than the
  // bound, because smoothing and flips enlarge the least angles only as a rule.
  double sine_before_smoothing() const { return sine_before_smoothing_; }

  // Appends a request to split a piece for each triangle inside the patch that is below the bound
  // and not excused, if one is in the way of its circumcentre. `points` are those of the plane's
  // vertices on the unit sphere.
  void find_in_plane(PlaneTriangulation& plane, std::span<const Vec3d> points,
                     const Stereographic& projection, PatchVector<PieceSplit>& found) const;
  // The same for triangles after smoothing: the longest piece that the triangle has, or else that
  // ends in one of its vertices.
  void find_in_patch(const PatchTriangles& patch, PatchVector<PieceSplit>& found) const;

  SmallAngles count(const PatchTriangles& patch) const;

 private:
  struct SharpCorner {
    Vec3d position;
    double squared_reach;
  };
  enum class Verdict : std::uint8_t { fine, excused, small };

  void find_sharp_corners();
  Verdict judge(const std::array<Vec3d, 3>& p) const;
  void take(std::uint32_t piece, PatchVector<PieceSplit>& found) const;
  std::uint32_t piece_in_the_way(PlaneTriangulation& plane, std::span<const Vec3d> points,
                                 const Stereographic& projection, std::uint32_t t) const;
  // Of the triangle's own pieces, or else of those that end in one of its vertices.
  std::uint32_t longest_piece_at(const LinkedTriangle& t) const;

  PatchBoundaryView boundary_;
  PieceChords chords_;
  double sine_, sine_before_smoothing_, shortest_;
  std::vector<SharpCorner> sharp_;
};

}  // namespace vdwmesh
