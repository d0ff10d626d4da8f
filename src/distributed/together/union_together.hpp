// The exact union of balls, measured by all ranks together: each measures a share of the spheres,
// in the presence of all others, by the arcs on them or on a device.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/errors.hpp"
#include "cuda/backend_choice.hpp"
#include "distributed/ranks.hpp"
#include "measures/exact_union.hpp"
#include "measures/frame_measures.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct UnionTogetherOptions {
  TopologyRequest topology = TopologyRequest::counts;  // or none
  std::optional<std::span<const SphereId>> measured;   // as in UnionOptions
  PerSphere per_sphere = PerSphere::drop;              // whether ExactUnion::per_sphere is wanted
  std::uint64_t memory_limit = kNoMemoryLimit;         // bytes, of one rank
  // Devices measure if this allows it and all ranks have one; the ranks of a host take its devices
  // in turn. Precondition: the CPU if topology or `measured` is given.
  Backend backend = Backend::cpu;
  Monitor* monitor = nullptr;
};

struct UnionTogether : ExactUnion {
  Backend backend = Backend::cpu;  // that measured the spheres, of all ranks
  std::string fallback;            // why it was the CPU if devices were to; else empty
};

// Measures the spheres, of which every rank has all. The options must be the same on all ranks, but
// for the monitor. On the first rank the result of the CPU is that of exact_union() with method
// arcs, bit for bit; that of devices has the same bits for any number of ranks. `per_sphere` is
// empty unless it is asked for. On the others it means nothing. Throws, on all ranks, what
// exact_union() throws, BackendUnavailable, and LimitExceeded. Collective.
UnionTogether union_together(const Ranks& ranks, const SphereSet& spheres,
                             const UnionTogetherOptions& options);

}  // namespace vdwmesh
