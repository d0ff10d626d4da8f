// Ball ∩ power cell: the unit ball cut by one half-space after another (arc_cell_cut.hpp says how).
// It works in memory of the caller.
// The body is stored as flat faces and straight edges, without its arcs on the sphere. An edge is
// part of a chord: the segment in which the planes of two caps meet inside the ball. A chord end
// that was never cut off lies on the sphere: two exposed arcs meet there in a corner of the patch.
// "Disk a" is plane a ∩ ball. A face without edges is a whole disk. A point is "beyond" a plane if
// it is in the half-space that the plane's cap removes.
#pragma once

#include "arrangement/arcs/arc_cap.hpp"

namespace vdwmesh::arcs {

// Bits that say why the measures of a ball are not to be trusted.
enum Doubt : std::uint32_t {
  kOverflow = 1,        // the workspace is too small
  kParallelPlanes = 2,  // two planes nearly coincide, or a plane runs along an edge
  kIllConditioned = 4,  // circles nearly tangent: angles at a corner have lost their digits
  kThirdCircle = 8,     // a third circle passes within kTouching of a corner
  kTinyArc = 16,        // the exposed angle of a circle is nearly 0 or nearly a whole turn
  kGaussBonnet = 32,    // the patch fails the Gauss-Bonnet theorem
  kOpenSurface = 64,    // the vector areas of patch and faces do not add up to zero
  kVanishing = 128,     // a plane removed the rest of the body, or left it, by less than kTouching
  kVanished = 256,      // the same by less than kCertain, so that rounding decided it
  kNotFinite = 512,     // a cap or a measure is NaN or out of its range
};

enum EdgeEnd : std::uint8_t { kLowerEnd = 1, kUpperEnd = 2 };
struct Complex {
  double re, im;
};

inline Complex operator*(const Complex& a, const Complex& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

inline Complex conjugate(const Complex& a) { return {a.re, -a.im}; }

struct CellFace {
  Cap cap;
  double squared_sine;       // 1 - cosine²: squared radius of the disk
  std::uint32_t edge_count;  // edges of the body on this face
  bool crossed;              // false: a whole disk; true: another plane cuts it or removes it
  bool touched;              // during cut(): the new plane shortens or removes an edge of the face
  // measure_cell() fills the rest.
  Complex arc;           // its argument is the exposed angle of the circle, modulo 2 π
  double edge_moment;    // sum over edges of (signed distance from the disk's centre) × length
  std::int32_t balance;  // arc ends minus arc starts, counter-clockwise: 0 unless rounding lost one
  std::uint32_t ends;    // number of arc ends plus arc starts
};

// An edge: the part lower <= s <= upper of the chord x(s) = middle + s * half, -1 <= s <= 1.
struct CellEdge {
  Vec3d middle, half;  // at right angles; `half` runs along axis_a × axis_b
  double lower, upper;
  double cosine;  // of the angle between the axes
  double root;    // det(axis_a, axis_b, x(1)), always > 0: root of their Gram determinant
  double scale;   // root / squared sine of the angle between the axes
  double toward_b, toward_a;  // from disk a's centre to plane b, < 0 if beyond it; from b's to a
  std::uint32_t a, b;         // slots of the faces, a < b
  std::uint8_t exposed;       // EdgeEnd bits: which ends lie on the sphere
};

struct ArcWorkspace {
  CellFace* faces;
  std::uint32_t* active;  // slots (indices into `faces`) of the body's faces; face_capacity long
  std::uint32_t face_capacity;
  CellEdge* edges;  // a convex body of n faces has fewer than 3 n
  std::uint32_t edge_capacity;
  Cap* nudged;  // measure_ball() puts a copy of all caps here, with planes moved at random
};

// Ties within 45 machine epsilons go to the older planes. A new plane leaves an old edge alone that
// ends up to kSlack beyond it; an older plane clips a new chord that ends up to kSlack before it.
inline constexpr double kSlack = 1e-14;
// A corner this near to a third plane counts as doubtful: it may lie on that plane as well.
inline constexpr double kTouching = 1e-9;
// Bound of rounding errors: a point farther from a plane is certainly on the side computed for it.
inline constexpr double kCertain = 1e-13;
// Planes count as parallel below this squared sine of the angle between them (sine 1e-9).
inline constexpr double kParallel = 1e-18;
// Below this squared sine (sine 1e-5) planes are cut as usual, but with the doubt kParallelPlanes:
// rounding moves their common line by kSlack / sine = kTouching or more.
inline constexpr double kNearlyParallel = 1e-10;
// Planes at an angle of at most 1e-9 can cross in the unit ball only if their distances from the
// centre differ by at most about 1e-9. The factor 10 is margin.
inline constexpr double kParallelGap = 1e-8;
// A quick Gram determinant, with a rounding of some 1e-15, is surely negative below minus this.
inline constexpr double kCoarseRounding = 1e-12;

// How to compute the end of an edge at a third plane. direct: along the edge; exact to rounding
// unless plane and edge are nearly parallel. shared: as the common point of three planes, with the
// same bits for all three edges that end there: faces stay closed even if the point is inaccurate.
enum class EdgeEnding : std::uint8_t { direct, shared };

class BallCell {
 public:
  BallCell(const ArcWorkspace& workspace, EdgeEnding ending) : space_(workspace), ending_(ending) {}

  // Removes the half-space beyond the cap's plane. Caps must come in the order of cuts_deeper().
  void cut(const Cap& cap);

  bool empty() const { return empty_; }
  // Whether the body is a polytope inside the ball: nothing of the sphere is exposed.
  bool closed() const { return active_count_ > 0 && exposed_ends_ == 0 && whole_disks_ == 0; }
  // Whether the body is closed and no plane cuts it whose cap has at least this cosine.
  bool out_of_reach(double cosine);
  std::uint32_t doubts() const { return doubts_; }
  bool overflowed() const { return (doubts_ & kOverflow) != 0; }

  // face(i) with i < face_count(): the faces of the body. face_at(slot): as CellEdge names them.
  std::uint32_t face_count() const { return active_count_; }
  CellFace& face(std::uint32_t i) const { return space_.faces[space_.active[i]]; }
  CellFace& face_at(std::uint32_t slot) const { return space_.faces[slot]; }
  std::uint32_t edge_count() const { return edge_count_; }
  CellEdge& edge(std::uint32_t i) const { return space_.edges[i]; }
  bool has_corners() const { return exposed_ends_ > 0; }

 private:
  // How the new disk lies to an old one (arc_cell_chords.hpp). Numbers named fresh are its slot.
  enum class Relation : std::uint8_t { apart, crossing, new_hidden, old_hidden, nothing_left };

  bool clip_edges(std::uint32_t fresh);
  double end_at(const CellEdge& edge, std::uint32_t plane, double direct) const;
  Relation relate(const CellFace& old, const CellFace& fresh, CellEdge& edge);
  Relation relate_parallel(const CellFace& old, const CellFace& fresh, double cosine);
  static Relation relate_uncrossed(double toward_a, double toward_b);
  bool add_face(std::uint32_t fresh, bool was_closed);
  bool clip_chord(CellEdge& edge) const;
  bool keeps_whole_chord(const CellEdge& edge);
  void push_edge(const CellEdge& edge);
  void remove_edge(std::uint32_t i);
  void drop_faces(std::uint32_t fresh);
  void update_reach();

  ArcWorkspace space_;
  EdgeEnding ending_;
  std::uint32_t face_slots_ = 0, active_count_ = 0, edge_count_ = 0;  // slots: dropped faces too
  std::uint32_t exposed_ends_ = 0, whole_disks_ = 0;
  std::uint32_t doubts_ = 0;
  double reach_ = 1;  // no point of a closed body is farther from the centre
  bool empty_ = false;
  bool reach_is_stale_ = true;  // the body may have shrunk since reach_ was computed
};

}  // namespace vdwmesh::arcs

#include "arrangement/arcs/arc_cell_chords.hpp"
#include "arrangement/arcs/arc_cell_cut.hpp"
