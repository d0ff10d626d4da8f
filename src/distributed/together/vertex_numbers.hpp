// Which vertices of the whole mesh belong to which rank.
//
// Vertices are numbered generation by generation: those of marching cubes come first, then the
// midpoints of each subdivision. In a generation every rank owns a run of numbers, and the runs
// stand behind each other in the order of the ranks. On its rank an own vertex has a local number
// too: the own vertices are counted from 0 in the order of their numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace vdwmesh {

class VertexNumbers {
 public:
  // The numbers of this rank, which has no vertices yet.
  explicit VertexNumbers(std::size_t rank = 0) : rank_(rank) {}

  // Adds a generation, of which rank r owns counts[r] vertices.
  void append(std::span<const std::uint64_t> counts);

  // The own vertices with local numbers [begin, end). Their numbers in the whole mesh begin at
  // `first`.
  struct Run {
    std::uint64_t first;
    std::size_t begin, end;
  };
  // One run for each generation.
  const std::vector<Run>& runs() const { return runs_; }

  std::uint64_t whole() const { return whole_; }  // the vertices of all ranks
  std::size_t own() const { return runs_.empty() ? 0 : runs_.back().end; }

  // There are few generations, at most one for each level of refinement, so they are searched one
  // by one; the latest is the largest and comes first.
  std::uint64_t number_of(std::size_t own_vertex) const {
    const Run* run = &runs_.back();
    while (own_vertex < run->begin) --run;
    return run->first + (own_vertex - run->begin);
  }
  // The local number of a vertex; empty if another rank owns it.
  std::optional<std::size_t> own_vertex(std::uint64_t number) const;
  std::size_t owner_of(std::uint64_t number) const;

 private:
  std::size_t rank_;
  std::uint64_t whole_ = 0;
  std::vector<Run> runs_;
  // [generation][rank]: the first number of the rank's run. A rank without vertices begins where
  // the next one does.
  std::vector<std::vector<std::uint64_t>> firsts_;
};

}  // namespace vdwmesh
