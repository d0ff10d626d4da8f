// Finds and takes back bad moves on the device: those that turn a triangle over or make triangles
// cross (refine/crossings/bad_moves.hpp defines them). The results are those of the CPU, bit for
// bit.
#pragma once

#include "cuda/refine/refine_levels.cuh"
#include "refine/refiner.hpp"

namespace vdwmesh {

// The arguments that all passes over a level share.
struct LevelPasses {
  SurfaceView surface;
  MoveStatesView move_states;
  DeviceStats* stats;           // in device memory
  Crossings crossings;          // whether crossing triangles are left alone
  Monitor* monitor;             // before each pass it is asked whether to stop; may be null
  std::uint64_t pairs_at_once;  // how many pairs the search for crossings lists at a time
};

// Takes back all bad moves of level 0 and returns their number.
std::uint64_t take_back_bad_moves(const GivenLevel& level, const LevelPasses& passes,
                                  const Stream& stream);

// The same for the midpoints of a later level. Precondition: make_children_on_device() has marked
// the moves that turn a triangle, and has counted the turned triangles in `stats`. Taking moves
// back changes that count, so it is corrected.
std::uint64_t take_back_bad_moves(const MidpointLevel& level, const LevelPasses& passes,
                                  const Stream& stream);

// Writes the corners, labels and half-edges of all child triangles. Then counts the children that
// do not face outward, and marks the moves that have turned them. If no vertex can have moved,
// passes.move_states.move_states is null, and nothing is marked.
void make_children_on_device(const MidpointLevel& level, const LevelPasses& passes,
                             const Stream& stream);

// Adds to `stats` the number of triangles that do not face outward. Writes to `safe`, unless it is
// null, whether each triangle is safe: bit t % 4 of byte t / 4, see PatchMarks.
void count_turned_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                            std::uint8_t* safe, DeviceStats* stats, const Stream& stream);

}  // namespace vdwmesh
