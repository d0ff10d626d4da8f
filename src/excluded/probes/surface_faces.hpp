// The faces of the excluded surface beside its contact patches, as numbers of a union-find: the two
// halves of each saddle and the pieces of concave patches, joined where they meet.
#pragma once

#include <cstdint>
#include <span>

#include "core/disjoint_sets.hpp"
#include "excluded/patches/patch_records.hpp"
#include "excluded/probes/accessible_surface.hpp"

namespace vdwmesh::excluded {

// Owns nothing. Numbers run from `first`: two halves for each arc, then the concave pieces.
struct SurfaceFaces {
  const AccessibleSurface& surface;
  const PatchRecords& records;
  std::span<const std::uint8_t> included;  // components of the accessible surface that count
  std::size_t first;

  std::uint32_t half(std::size_t arc, std::size_t side) const {
    return static_cast<std::uint32_t>(first + 2 * arc + side);
  }
  std::uint32_t piece(std::uint32_t i) const {
    return static_cast<std::uint32_t>(first + 2 * surface.arcs.size() + i);
  }
  std::size_t end() const { return first + 2 * surface.arcs.size() + records.pieces.size(); }

  // Joins the halves of saddles with each other, unless the saddle is a spindle, and with the
  // concave pieces along the sides of probes.
  void join_saddles(DisjointSets& faces) const;
  // Joins the two pieces along each crease. Returns the number of patches with a crease that the
  // other probe does not have.
  std::uint64_t join_creases(DisjointSets& faces) const;
};

}  // namespace vdwmesh::excluded
