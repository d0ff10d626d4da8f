// Which bricks each rank meshes, and which spheres it needs for them.
//
// The bricks of a surface are numbered in the order of their keys (extract/grid.hpp), and so are
// vertices and triangles. A rank therefore gets a run of keys. The runs are cut where about the
// same area of surface lies in each. The mesh does not depend on where they are cut; the time does.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "distributed/ranks.hpp"
#include "distributed/shares/chosen_spheres.hpp"
#include "extract/field.hpp"
#include "extract/grid.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// make_grid() and make_field_frame() of the whole set. Each rank looks at a block of the spheres.
// Collective.
GridSpec grid_together(const Ranks& ranks, const SphereSet& spheres, const GridOptions& options);
CellListFrame frame_together(const Ranks& ranks, const SphereSet& spheres, const FieldModel& model);

// Some surface in a brick: part of an estimate.
struct BrickArea {
  std::uint64_t key;  // brick_key()
  double area;        // Å², at least 0
};

// The first keys of `count` runs of about the same area. The first run begins at key 0, and a run
// ends where the next one begins, the last at kNoBrickKey. Runs may be empty.
std::vector<std::uint64_t> cut_bricks(std::vector<BrickArea> areas, std::size_t count);

// Joins bricks that follow each other in the order of keys to about `count` groups, of about the
// same area. A group has the key of its first brick. So cut_bricks() of the groups cuts where it
// cuts the bricks, but for the area of a group.
std::vector<BrickArea> join_bricks(std::vector<BrickArea> areas, std::size_t count);

// The first keys of the ranks' runs of bricks, cut_bricks() of what all ranks estimate. Collective.
std::vector<std::uint64_t> share_bricks(const Ranks& ranks, const SphereSet& spheres,
                                        const FieldModel& model);

// A run, and that of this rank, by the first keys of all runs.
KeyRange run_at(std::span<const std::uint64_t> begins, std::size_t run);
KeyRange run_of(const Ranks& ranks, std::span<const std::uint64_t> begins);

// Who counts the bricks behind a run to which its triangles refer, its halo: the rank itself, or
// the next ranks, which give it what they have counted.
enum class HaloCounts : std::uint8_t { own, given };

// The spheres that have an effect on the field in the bricks of a run, and of its halo if the rank
// counts that itself. spheres_near_runs() looks at one of as many blocks of the spheres as there
// are runs of bricks, and returns them by run of bricks, ascending. spheres_near() returns those of
// this rank's run, which all ranks find for it. Where there are none, the first sphere of the set
// stands for them, because many functions refuse an empty set. The second function is collective.
std::vector<std::vector<SphereRun>> spheres_near_runs(const SphereSet& spheres,
                                                      const FieldModel& model, std::size_t block,
                                                      std::span<const std::uint64_t> begins,
                                                      HaloCounts halo);
ChosenSpheres spheres_near(const Ranks& ranks, const SphereSet& spheres, const FieldModel& model,
                           std::span<const std::uint64_t> begins, HaloCounts halo);

}  // namespace vdwmesh
