// Moves that turn a triangle over or make triangles cross, found and taken back on the device.
// refine/bad_moves.hpp says which moves are bad; the results are the same, bit for bit.
#pragma once

#include "cuda/refine/refine_levels.cuh"
#include "refine/refiner.hpp"

namespace vdwmesh {

// The arguments that all passes over a level share.
struct LevelPasses {
  SurfaceView surface;
  MoveStatesView move_states;
  DeviceStats* stats;   // in device memory
  Crossings crossings;  // whether crossing triangles are left alone
  Monitor* monitor;     // asked before each pass whether the run is cancelled; may be null
};

// Takes back all bad moves of level 0 and returns their number.
std::uint64_t take_back_bad_moves(const GivenLevel& level, const LevelPasses& passes,
                                  const Stream& stream);

// The same for midpoints. Precondition: make_children_on_device() has marked the moves that turn a
// triangle and has counted the turned triangles. The count is kept up to date.
std::uint64_t take_back_bad_moves(const MidpointLevel& level, const LevelPasses& passes,
                                  const Stream& stream);

// Writes the corners, labels and half-edges of all child triangles. Then counts the children that
// do not face outward, and marks the moves that turned them. passes.move_states.move_states is null
// if no vertex can have moved; nothing is marked then.
void make_children_on_device(const MidpointLevel& level, const LevelPasses& passes,
                             const Stream& stream);

// Adds to `stats` the number of triangles that do not face outward. Writes to `safe`, unless it is
// null, whether each triangle is safe: bit t % 4 of byte t / 4, see PatchMarks.
void count_turned_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                            std::uint8_t* safe, DeviceStats* stats, const Stream& stream);

}  // namespace vdwmesh
