// The part of an arrangement that one of several processes needs: its own balls, and those that
// touch them.
//
// What a ball has of the boundary depends on nothing but the balls that touch it: a simplex is in
// the dual complex if its balls have a common point that no other ball covers more deeply, and such
// a ball touches them all. And the numbers follow from places (spheres/spatial_frame.hpp). So a
// process gets the arcs and corners at its own balls bit by bit, in the order of the whole set. At
// the other balls it arranges, some would be wrong; they are left out.
#pragma once

#include <optional>

#include "creases/arcs/arrangement.hpp"
#include "creases/arcs/boundary_arcs.hpp"
#include "creases/exact_mesher.hpp"
#include "creases/share/mesh_borders.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

struct ArrangedPart {
  Arrangement arrangement;  // ids are those of the whole set
  // Arcs and corners at own balls, for the usual feature sizes. If features became points, the
  // whole set has to be arranged: then an arc may end in a corner that is left out, kNoIndex.
  BoundaryArcs boundary;
  OwnedPart part;
  bool is_ordinary = true;  // no ball is of a size for which numbers would over- or underflow
};

// Cuts the set into as many parts as there are processes, of about equal work, each a run along the
// curve of the frame; arranges the one with this number. Every process has all
// spheres. Throws what arrange() throws.
ArrangedPart arrange_part(const SphereSet& spheres, std::size_t number, std::size_t parts,
                          const ExactMeshOptions& options);

}  // namespace vdwmesh
