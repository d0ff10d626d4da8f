// Some spheres of a set: what a rank keeps of the whole.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/buffer.hpp"
#include "core/fixed_blocks.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Spheres of a set, in their order there.
struct ChosenSpheres {
  Buffer<Sphere> spheres;
  std::vector<SphereId> ids;  // [i]: of spheres[i] in the whole set
};

// The spheres of a set with the ids [begin, end). Ids of a structure mostly follow each other in
// space, so a few runs say which spheres are near something.
struct SphereRun {
  SphereId begin, end;
};

// Adds an id above all that the runs have.
inline void add_id(SphereId id, std::vector<SphereRun>& runs) {
  if (!runs.empty() && runs.back().end == id) {
    ++runs.back().end;
  } else {
    runs.push_back({id, id + 1});
  }
}

// The ids of runs, one run behind the other.
inline std::vector<SphereId> ids_of(std::span<const SphereRun> runs) {
  std::vector<std::size_t> ends;  // [r]: of run r, in the result
  std::size_t size = 0;
  for (const auto& [begin, end] : runs) ends.push_back(size += end - begin);
  std::vector<SphereId> ids(size);
  for_each_block(size, kIndicesPerBlock, [&](std::size_t, std::size_t first, std::size_t end) {
    auto run = static_cast<std::size_t>(std::ranges::upper_bound(ends, first) - ends.begin());
    for (std::size_t i = first; i < end; ++i) {
      while (i >= ends[run]) ++run;
      ids[i] = runs[run].end - static_cast<SphereId>(ends[run] - i);
    }
  });
  return ids;
}

// Fills `spheres` with the spheres of the set that have the ids.
inline void copy_spheres(const SphereSet& set, ChosenSpheres& chosen) {
  chosen.spheres.resize(chosen.ids.size());
  for_each_index(chosen.ids.size(), [&](std::size_t i) { chosen.spheres[i] = set[chosen.ids[i]]; });
}

// Chooses the spheres for which is_chosen(id, sphere) is true, which all cores ask in no particular
// order.
template <class IsChosen>
ChosenSpheres choose(const SphereSet& spheres, const IsChosen& is_chosen) {
  ChosenSpheres chosen;
  chosen.ids = collect<SphereId>(spheres.size(), [&](std::size_t i, std::vector<SphereId>& found) {
    const auto id = static_cast<SphereId>(i);
    if (is_chosen(id, spheres[i])) found.push_back(id);
  });
  copy_spheres(spheres, chosen);
  return chosen;
}

}  // namespace vdwmesh
