// The generations and their runs, and the rank that a number belongs to. Searches go through the
// generations from the latest one on.
#include "distributed/together/vertex_numbers.hpp"

#include <algorithm>

namespace vdwmesh {

void VertexNumbers::append(std::span<const std::uint64_t> counts) {
  std::vector<std::uint64_t> firsts;
  for (const std::uint64_t count : counts) {
    firsts.push_back(whole_);
    whole_ += count;
  }
  runs_.push_back({firsts[rank_], own(), own() + counts[rank_]});
  firsts_.push_back(std::move(firsts));
}

// If the number is below the run, the difference wraps around to a number beyond the end of every
// run.
std::optional<std::size_t> VertexNumbers::own_vertex(std::uint64_t number) const {
  for (std::size_t g = runs_.size(); g-- > 0;) {
    const std::uint64_t place = number - runs_[g].first;
    if (place < runs_[g].end - runs_[g].begin) return runs_[g].begin + place;
  }
  return std::nullopt;
}

std::size_t VertexNumbers::owner_of(std::uint64_t number) const {
  std::size_t g = firsts_.size() - 1;
  while (number < firsts_[g].front()) --g;
  const std::vector<std::uint64_t>& firsts = firsts_[g];
  return static_cast<std::size_t>(std::ranges::upper_bound(firsts, number) - firsts.begin()) - 1;
}

}  // namespace vdwmesh
