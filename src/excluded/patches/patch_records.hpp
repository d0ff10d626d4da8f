// The concave patches of a surface as flat arrays: pieces, what they share with saddles and with
// each other, and sums over them.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "excluded/patches/concave_patch.hpp"
#include "excluded/probes/accessible_surface.hpp"

namespace vdwmesh::excluded {

// A point in which creases end, by what it is: the point common to three probes on one side of
// their plane, or the cusp of a circle near one of its atoms.
struct CreaseEnd {
  std::array<std::uint32_t, 3> name;  // probes, ascending; or edge, 0 or 1, kNoIndex
  bool positive;                      // orientation of the probes, in this order, and the point
  bool is_cusp() const { return name[2] == kNoIndex; }
  auto operator<=>(const CreaseEnd&) const = default;
};

// The cusp of an arc's circle near its ball a (0) or b (1).
inline CreaseEnd cusp_of(const RolledArc& arc, std::uint32_t near) {
  return {{arc.edge, near, kNoIndex}, true};
}
// The point in which the boundary of a cut patch goes over from circle i to circle j, of which one
// at least is a cap's.
CreaseEnd crease_end(const AccessibleSurface& surface, const ConcavePatch& patch, std::uint32_t i,
                     std::uint32_t j);

// A crease seen from one of its two probes; from the other one it runs back. A whole circle has
// equal ends.
struct Crease {
  std::uint32_t probe, other, piece;
  CreaseEnd from, to;
};

struct ConcavePiece {
  std::uint32_t probe, loops;
  double solid_angle;
  Vec3d vector;  // ∫ w dω
  double bend;   // integral of the Gaussian curvature, with its share of creases and of their ends
  // Sums over its creases of h ∫ dψ and of h ∫ w dψ, with the angle ψ about the cap's axis and the
  // cosine h of the cap: how the areas on both sides change if the probe grows and moves.
  double crease_turn = 0;
  Vec3d crease_vector = {0, 0, 0};
};

// The concave patches of the probes of some components of the accessible surface.
struct PatchRecords {
  PatchRecords(const AccessibleSurface& surface, std::span<const std::uint8_t> included,
               Monitor* monitor);

  std::vector<ConcavePiece> pieces;                      // by probe, ascending
  std::vector<std::array<std::uint32_t, 2>> side_piece;  // by entry of AccessibleSurface::sides:
                                                         // the pieces near its balls a and b
  std::vector<Crease> creases;                           // by probe, ascending
  std::vector<std::uint32_t> first_crease;               // by probe, one more
  // By component: the point about which the flux of the position is taken, in the coordinates of
  // the triangulation. It is the same for components whose patches meet in creases: together these
  // are closed, so that the volume does not depend on it.
  std::vector<Vec3d> home;
  double layer = 0;  // scaled volume between the probes and the patches, flat parts included
  std::uint64_t extended_decisions = 0, ties = 0, uncertified = 0;

 private:
  void add_whole(const AccessibleSurface& surface, std::uint32_t probe);
  void add_cut(const AccessibleSurface& surface, const ConcavePatch& patch);
  void find_homes(const AccessibleSurface& surface);
};

}  // namespace vdwmesh::excluded
