// Search for crossing triangles of a level in device memory. It takes the steps of the CPU
// (refine/crossings/bad_moves.cpp): a uniform grid lists patches; of two patches near each other,
// those that share a star are left out; then quarters of the two are compared by their boxes, parts
// (on level 1 patches, before their quarters) by walls, and what is left triangle by triangle. The
// grid has other cells than the CPU's, and boxes are in single precision. The triangles found are
// the same all the same, because all of this only has to let all pairs pass that cross;
// refine/crossings/crossing_formulas.hpp decides about each in double.
#pragma once

#include <array>
#include <cstdint>

#include "cuda/refine/patch_survey.cuh"

namespace vdwmesh {

// The patch in the list of a cell.
struct alignas(8) CellEntry {
  std::uint32_t patch, cell;
};

// A uniform grid, as kernels see it, with at most as many cells as patches, or 64 if that is more.
// Each patch is listed in every cell that its box touches. The lists are in compressed sparse row
// form: cell c lists entries[start[c]] .. entries[start[c + 1] - 1].
struct CrossingGrid {
  std::array<double, 3> origin;        // lower corner of cell 0, Å
  double per_length;                   // 1 / width of a cell, 1/Å
  std::array<std::uint32_t, 3> cells;  // along x, y, z
  unsigned long long* start;
  CellEntry* entries;
};

// The edges whose midpoints a pass puts back, in device memory. Their order depends on the
// scheduling of threads; the results do not.
struct EdgeList {
  const std::uint32_t* edges = nullptr;  // edge numbers of the parent
  std::uint64_t count = 0;
};

// Two patches, two parts or two triangles, by number.
struct alignas(8) NumberPair {
  std::uint32_t a, b;
};
// This number is no patch, part or triangle.
inline constexpr std::uint32_t kNoNumber = 0xffffffffu;

// `Patches` is one of GivenPatches, MidpointPatches and DividedPatches.
template <class Patches>
class CrossingFinder {
 public:
  // Surveys the patches where their vertices are now, before any move was taken back, and builds
  // the grid. Throws DeviceMemoryExceeded if it does not fit into device memory.
  CrossingFinder(const Patches& level, const MoveStatesView& move_states,
                 std::uint64_t pairs_at_once, const Stream& stream);

  // Marks the moved vertices of all pairs of triangles that cross. `pass` counts from 0. Pairs
  // without a moved vertex are not tested: if they cross, they did so before the moves. After pass
  // 0 only pairs of patches are tested of which one has a vertex that the pass before has put back;
  // no other pair has changed. From level 1 on `changed` has the edges with these vertices.
  void mark(const MoveStatesView& move_states, int pass, const EdgeList& changed);

 private:
  void judge_fans(const MoveStatesView& move_states);
  void shape();
  void fill(std::uint64_t pairs_at_once);
  void want(const MoveStatesView& move_states, int pass, const EdgeList& changed);
  std::uint64_t find(std::uint64_t first, const FanState* fans);
  void test(const MoveStatesView& move_states);

  Patches level_;
  const Stream& stream_;
  DeviceArray<SurveyedPatch> patches_;
  DeviceArray<FloatBox> quarters_;  // Patches::kQuarters for each patch
  DeviceArray<FanState> fans_;      // by corner vertex, if patches have fans
  DeviceArray<Vec3f> directions_;   // of the fans, the same in all passes
  DeviceArray<unsigned long long> start_;
  DeviceArray<CellEntry> entries_;
  DeviceArray<std::uint8_t> dirty_;        // by cell: 1 if a patch in it must be tested
  DeviceArray<NumberPair> pairs_;          // pairs of patches, found by find()
  DeviceArray<unsigned long long> found_;  // their number, also in listed_
  std::uint64_t listed_ = 0;
  DeviceArray<NumberPair> near_;                // pairs of quarters whose boxes overlap
  DeviceArray<unsigned long long> near_count_;  // their number
  std::uint64_t at_once_ = 1;                   // entries whose pairs find() lists at a time
  CrossingGrid grid_{
      .origin = {}, .per_length = 1, .cells = {1, 1, 1}, .start = nullptr, .entries = nullptr};
};

extern template class CrossingFinder<GivenPatches>;
extern template class CrossingFinder<MidpointPatches>;
extern template class CrossingFinder<DividedPatches>;

// An estimate of the bytes that a search takes.
std::uint64_t crossing_search_bytes(std::uint64_t patches, bool has_quarters,
                                    std::uint64_t pairs_at_once);

}  // namespace vdwmesh
