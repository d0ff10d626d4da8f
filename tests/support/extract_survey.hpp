// Checks an extractor on random sets: that its mesh is sound, and that its shortcuts change
// nothing.
#pragma once

#include <cstdint>
#include <string>

#include "cuda/backend.hpp"
#include "support/extract_sets.hpp"

namespace vdwmesh::testing {

// How much of a survey could be asked which question.
struct SurveyCounts {
  std::uint64_t sets = 0, triangles = 0;
  std::uint64_t separated = 0;  // sets whose number of shells is known
  std::uint64_t plain = 0;      // sets that were meshed without any shortcut as well
};

// Meshes the set and says what is wrong with the mesh; empty where nothing is.
// - By reference::inspect, it is closed, 2-manifold and oriented, without degenerate triangles.
// - Balls that are apart make as many shells.
// - All arrays are those of extract_all_bricks(), and for small sets of extract_plainly().
// - On CUDA, they and the counts are those of the CPU, which is then not checked again.
std::string complaint(const ExtractSet& set, Backend backend, SurveyCounts& counts);

}  // namespace vdwmesh::testing
