// What the contact patches of a small probe have beyond those of a large one: on each atom's sphere
// the regions that a loop of either bounds.
//
// A large probe that touches an atom in a point contains a small one that touches it there, and
// nothing else. So the large probe's contact patches lie strictly inside the small probe's, and the
// loops around both cross nowhere.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/disjoint_sets.hpp"
#include "excluded/probes/kept_surface.hpp"

namespace vdwmesh::excluded {

// A boundary loop of a contact patch, seen from the unit sphere of its atom.
struct SphereLoop {
  std::uint32_t ball, piece;  // of the triangulation; ContactPiece
  bool counts;                // has an arc with a length, of a component that is included
  double bend = 0;  // Σ φ cos β - Σ ε, with the angles φ of its arcs and ε of its corners
  Vec3d vector = {0, 0, 0};  // ½ ∮ w × dw
};

// The loops of one surface, with their arcs.
struct SphereLoops {
  explicit SphereLoops(const KeptSurface& kept);

  Buffer<std::uint32_t> of_element;  // the loop of an element, 2 × arc + side
  std::vector<SphereLoop> loops;
  std::vector<std::uint32_t> elements;  // that count, by loop
  std::vector<std::uint32_t> first;     // of a loop's elements; one more
};

// Parts of the regions. Those of one region are joined in the union-find; their solid angles and
// vectors, ∫ w dω, sum to the region's.
struct WallPart {
  std::uint32_t node;
  SphereId atom;
  double solid_angle;
  Vec3d vector;
};

// Nodes of the union-find: loops of the small probe, loops of the large one, contact pieces of the
// small one, of which only whole spheres are used.
struct ContactWalls {
  // `atoms` is the number of spheres in the set.
  ContactWalls(const KeptSurface& small, const KeptSurface& large, std::size_t atoms);

  std::uint32_t node(std::size_t surface, std::uint32_t element) const {
    return (surface == 0 ? 0 : static_cast<std::uint32_t>(loops[0].loops.size())) +
           loops[surface].of_element[element];
  }
  std::size_t node_count() const { return whole_ + pieces_; }

  // Joins the loops of each region, and returns the parts. `unsettled` becomes the number of atoms
  // whose regions could not be told.
  std::vector<WallPart> join(DisjointSets& nodes, std::uint64_t& unsettled) const;

  std::array<SphereLoops, 2> loops;

 private:
  using LoopsOfAtom = std::array<std::span<const std::uint32_t>, 2>;
  std::optional<std::vector<std::uint32_t>> regions_of(
      const LoopsOfAtom& rims, const std::array<std::size_t, 2>& pieces) const;
  void add_parts(SphereId atom, const LoopsOfAtom& rims, const std::vector<std::uint32_t>& region,
                 DisjointSets& nodes, std::vector<WallPart>& parts) const;

  const KeptSurface &small_, &large_;
  std::size_t atoms_, whole_, pieces_;  // whole_: the node of piece 0
};

}  // namespace vdwmesh::excluded
