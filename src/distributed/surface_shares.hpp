// Which bricks each rank meshes, and which spheres it needs for them.
//
// The bricks of a surface are numbered in the order of their keys (extract/grid.hpp), and so are
// vertices and triangles. A rank therefore gets a run of keys. The runs are cut where about the
// same area of surface lies in each. The mesh does not depend on where they are cut; the time does.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "distributed/chosen_spheres.hpp"
#include "distributed/ranks.hpp"
#include "extract/field.hpp"
#include "extract/grid.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Some surface in a brick: part of an estimate.
struct BrickArea {
  std::uint64_t key;  // brick_key()
  double area;        // Å², at least 0
};

// Where the surface is, estimated from a sample of one of so many parts of the spheres. The parts
// together are all spheres. Empty parts have no surface.
std::vector<BrickArea> estimate_bricks(const SphereSet& spheres, const FieldModel& model,
                                       std::size_t part, std::size_t parts);

// The first keys of `count` runs of about the same area. The first run begins at key 0, and a run
// ends where the next one begins, the last at kNoBrickKey. Runs may be empty.
std::vector<std::uint64_t> cut_bricks(std::vector<BrickArea> areas, std::size_t count);

// The spheres that have an effect on the field in the bricks of the range and of its halo. Where
// there are none, the first sphere of the set stands for them, because many functions refuse an
// empty set.
ChosenSpheres spheres_near(const SphereSet& spheres, const FieldModel& model,
                           const KeyRange& range);

// make_field_frame() of the whole set, which the first rank makes for all: it takes an array over
// all spheres. Collective.
CellListFrame frame_together(const Ranks& ranks, const SphereSet& spheres, const FieldModel& model);

}  // namespace vdwmesh
