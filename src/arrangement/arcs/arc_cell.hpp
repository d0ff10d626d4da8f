// The unit ball cut by half-spaces, one at a time: ball ∩ power cell. Runs on host and device, in
// memory of the caller.
//
// Of the cut body only the straight edges are kept, each a piece of the chord in which the planes
// of two caps meet inside the ball. A chord end that is still there is a corner of the exposed
// patch, where two exposed arcs meet; a face without any edge is a whole disk.
#pragma once

#include "arrangement/arcs/arc_cap.hpp"

namespace vdwmesh::arcs {

// Why a ball's measures are not to be trusted, as bits.
enum Doubt : std::uint32_t {
  kOverflow = 1,        // the workspace is too small
  kParallelPlanes = 2,  // two planes all but coincide
  kIllConditioned = 4,  // circles all but tangent, planes all but parallel
  kThirdCircle = 8,     // more than two circles through one exposed point
  kTinyArc = 16,        // the exposed part of a circle is all but nothing, or all but all
  kGaussBonnet = 32,    // the patch fails the Gauss-Bonnet theorem
  kOpenSurface = 64,    // the vector areas of patch and faces do not add up to zero
  kVanishing = 128,     // a plane all but took the last of the body, or only just did
  kVanished = 256,      // the same, within rounding
  kNotFinite = 512,     // a cap or a measure is not a number of its range
};

enum EdgeEnd : std::uint8_t { kLowerEnd = 1, kUpperEnd = 2 };

struct Complex {
  double re, im;
};

VDWMESH_HD inline Complex operator*(const Complex& a, const Complex& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

VDWMESH_HD inline Complex conjugate(const Complex& a) { return {a.re, -a.im}; }

struct CellFace {
  Cap cap;
  double squared_sine;       // of the cap's angle: squared radius of the disk
  std::uint32_t edge_count;  // edges on this face
  bool crossed;              // no longer a whole disk
  bool touched;              // by the cap being added
  // Filled by measure_cell.
  Complex arc;           // unit; its argument is the exposed angle
  double edge_moment;    // sum over edges of distance from the disk's centre × length
  std::int32_t balance;  // arcs ending less arcs starting, counter-clockwise about the axis
  std::uint32_t ends;
};

// x(s) = middle + s * half, lower <= s <= upper, on the line of planes a and b.
struct CellEdge {
  Vec3d middle, half;
  double lower, upper;
  double cosine;              // of the angle between the axes
  double root;                // square root of the Gram determinant, > 0: det(axis_a, axis_b, x(1))
  double scale;               // root / squared sine of the angle between the axes
  double toward_b, toward_a;  // sine × signed distance of the line from the centre of disk a, b
  std::uint32_t a, b;
  std::uint8_t exposed;  // EdgeEnd bits
};

struct ArcWorkspace {
  CellFace* faces;
  std::uint32_t* active;  // as many as faces
  std::uint32_t face_capacity;
  CellEdge* edges;  // a convex body of n faces has less than 3 n
  std::uint32_t edge_capacity;
  Cap* nudged;  // as many as there are caps
};

// Ties within this are decided for the older plane; some 50 roundings.
inline constexpr double kSlack = 1e-14;
// A corner this near to a third plane may be its corner too.
inline constexpr double kTouching = 1e-9;
// The same for rounding alone: what is farther away is surely on its side.
inline constexpr double kCertain = 1e-13;
// Squared sine of the angle below which two planes count as parallel.
inline constexpr double kParallel = 1e-18;
// And that below which it is not certain where they meet, to kSlack / sine: one may lie within the
// slack of the other in one place and far from it in the next.
inline constexpr double kNearlyParallel = 1e-10;
// Parallel planes nearer than this may cross after all.
inline constexpr double kParallelGap = 1e-8;
// Far above the rounding of a Gram determinant, far below 1.
inline constexpr double kRoughly = 1e-12;

// Where an edge ends at a third plane. direct: along the edge, exact to rounding unless the plane
// is all but parallel to it. shared: one point for the three edges that end there, so that faces
// stay closed however badly it is determined.
enum class EdgeEnding : std::uint8_t { direct, shared };

class BallCell {
 public:
  VDWMESH_HD BallCell(const ArcWorkspace& workspace, EdgeEnding ending)
      : space_(workspace), ending_(ending) {}

  // Removes the half-space beyond the cap's plane.
  VDWMESH_HD void cut(const Cap& cap);

  VDWMESH_HD bool empty() const { return empty_; }
  // A polytope inside the ball: nothing of the sphere is exposed.
  VDWMESH_HD bool closed() const {
    return active_count_ > 0 && exposed_ends_ == 0 && whole_disks_ == 0;
  }
  // Whether no plane at this distance from the centre, or farther, can cut.
  VDWMESH_HD bool out_of_reach(double cosine);
  VDWMESH_HD std::uint32_t doubts() const { return doubts_; }
  VDWMESH_HD bool overflowed() const { return (doubts_ & kOverflow) != 0; }

  VDWMESH_HD std::uint32_t face_count() const { return active_count_; }
  VDWMESH_HD CellFace& face(std::uint32_t i) const { return space_.faces[space_.active[i]]; }
  VDWMESH_HD CellFace& face_at(std::uint32_t index) const { return space_.faces[index]; }
  VDWMESH_HD std::uint32_t edge_count() const { return edge_count_; }
  VDWMESH_HD CellEdge& edge(std::uint32_t i) const { return space_.edges[i]; }
  VDWMESH_HD bool has_corners() const { return exposed_ends_ > 0; }

 private:
  enum class Relation : std::uint8_t { apart, crossing, new_hidden, old_hidden, nothing_left };

  VDWMESH_HD bool clip_edges(std::uint32_t fresh);
  VDWMESH_HD double end_at(const CellEdge& edge, std::uint32_t plane, double direct) const;
  VDWMESH_HD Relation relate(const CellFace& old, const CellFace& fresh, CellEdge& edge);
  VDWMESH_HD Relation relate_parallel(const CellFace& old, const CellFace& fresh, double cosine);
  VDWMESH_HD static Relation relate_uncrossed(double toward_a, double toward_b);
  VDWMESH_HD bool add_face(std::uint32_t fresh, bool was_closed);
  VDWMESH_HD bool clip_chord(CellEdge& edge) const;
  VDWMESH_HD bool keeps_whole(const CellEdge& edge);
  VDWMESH_HD void push_edge(const CellEdge& edge);
  VDWMESH_HD void remove_edge(std::uint32_t i);
  VDWMESH_HD void drop_faces(std::uint32_t fresh);
  VDWMESH_HD void update_reach();

  ArcWorkspace space_;
  EdgeEnding ending_;
  std::uint32_t face_slots_ = 0, active_count_ = 0, edge_count_ = 0;
  std::uint32_t exposed_ends_ = 0, whole_disks_ = 0;
  std::uint32_t doubts_ = 0;
  double reach_ = 1;
  bool empty_ = false;
  bool reach_is_stale_ = true;
};

}  // namespace vdwmesh::arcs

#include "arrangement/arcs/arc_cell_chords.hpp"
#include "arrangement/arcs/arc_cell_cut.hpp"
