// Moves that spoil the mesh, taken back: refine/bad_moves.hpp on the device.
#pragma once

#include "cuda/refine/refine_levels.cuh"
#include "refine/refiner.hpp"

namespace vdwmesh {

// What the passes over a level share.
struct LevelPasses {
  SurfaceView surface;
  FatesView fates;
  DeviceStats* stats;
  Crossings crossings;
  Monitor* monitor;
};

// Takes back the bad moves of given vertices; returns how many.
std::uint64_t take_back_bad_moves(const GivenLevel& level, const LevelPasses& passes,
                                  const Stream& stream);

// The same for midpoints. The moves that turn a triangle are marked already, and the triangles that
// are turned counted: see make_children_on_device().
std::uint64_t take_back_bad_moves(const MidpointLevel& level, const LevelPasses& passes,
                                  const Stream& stream);

// Writes the children's corners, spheres and half-edges, counts those that are turned and marks the
// moves that did it. `fates.fates` is null where nothing moved.
void make_children_on_device(const MidpointLevel& level, const LevelPasses& passes,
                             const Stream& stream);

// Counts the triangles of a mesh that are turned. `safe`: null, or room for a bit of each.
void count_turned_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                            std::uint8_t* safe, DeviceStats* stats, const Stream& stream);

}  // namespace vdwmesh
