// The part of a surface that each rank counts: its run of bricks.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "cuda/backend_choice.hpp"
#include "distributed/ranks.hpp"
#include "distributed/shares/surface_shares.hpp"
#include "extract/extractor.hpp"

namespace vdwmesh {

// What a rank does about the bricks behind its run, its halo, to which its triangles refer.
// Counting them again takes a rank a layer of bricks, as long as it takes the rank that owns them.
// On devices that is less than the way of the counts to the host, so only CPUs give halos to each
// other: if one rank meshes on a device, none does. The same for all ranks. Collective.
HaloCounts halo_counts(const Ranks& ranks, Backend backend);

// Counts the run of this rank with the spheres near it, which labels call by their `ids` in the
// whole set; without ids they are all spheres. `begins` are the first keys of all runs. The options
// are those of Extractor::count(). Throws, on all ranks, what that function throws, and
// LimitExceeded if a part does not fit the memory limit of its rank. Collective.
std::unique_ptr<SurfacePart> count_together(const Ranks& ranks, const SphereSet& near,
                                            std::span<const SphereId> ids,
                                            std::span<const std::uint64_t> begins, HaloCounts halo,
                                            const ExtractOptions& options, Backend backend);

}  // namespace vdwmesh
