// The exact union of balls, measured by all ranks together: each measures a share of the spheres,
// in the presence of all others, by the arcs on them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "arrangement/exact_union.hpp"
#include "arrangement/frame_measures.hpp"
#include "distributed/ranks.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct UnionTogetherOptions {
  TopologyRequest topology = TopologyRequest::counts;  // or none
  std::optional<std::span<const SphereId>> measured;   // as in UnionOptions
  PerSphere per_sphere = PerSphere::drop;              // whether ExactUnion::per_sphere is wanted
  std::uint64_t memory_limit = kNoMemoryLimit;         // bytes, of one rank
  Monitor* monitor = nullptr;
};

// Measures the spheres, of which every rank has all. The options must be the same on all ranks, but
// for the monitor. On the first rank the result is that of exact_union() with method arcs, bit for
// bit; `per_sphere` is empty unless it is asked for. On the others it means nothing. Throws, on all
// ranks, what exact_union() throws, and LimitExceeded. Collective.
ExactUnion union_together(const Ranks& ranks, const SphereSet& spheres,
                          const UnionTogetherOptions& options);

}  // namespace vdwmesh
