// Counts are made by each rank for itself. A halo is sent by the ranks whose runs it consists of:
// they have counted its bricks as their own.
#include "distributed/together/part_together.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "analysis/survey/stage_bytes.hpp"
#include "core/errors.hpp"
#include "cuda/count_part.hpp"
#include "extract/brick_search.hpp"
#include "extract/part_without_halo.hpp"

namespace vdwmesh {
namespace {

// Throws LimitExceeded if the part that a rank has counted does not fit the memory that it is
// allowed.
void check_memory(const MeshSize& size, const ExtractOptions& options, std::size_t spheres) {
  const std::uint64_t mesh = indexed_mesh_bytes(size, {.normals = options.normals});
  // While the mesh is made, counts of bricks and the cell list take about as much as this.
  const std::uint64_t made = mesh / 4 + 128 * static_cast<std::uint64_t>(spheres);
  const std::uint64_t beside = std::max(made, measures_bytes(size));
  if (mesh + beside <= options.memory_limit) return;
  throw LimitExceeded(fmt::format(
      "{} triangles need {} MiB of memory, {} MiB are allowed to a rank: more ranks, a larger "
      "--spacing or --memory-limit {}M would do",
      size.triangles, (mesh + beside) >> 20, options.memory_limit >> 20,
      ((mesh + beside) >> 20) + 1));
}

// Gives every part its halo. The bricks of a halo may be of several ranks, whose runs follow each
// other. Collective.
void share_halos(const Ranks& ranks, std::span<const std::uint64_t> begins, PartWithoutHalo& part) {
  std::vector<std::vector<ActiveBrick>> for_each;
  ranks.together([&] {
    for (std::size_t run = 0; run < begins.size(); ++run) {
      const KeyRange own = run_at(begins, run);
      const std::span<const ActiveBrick> found =
          part.counted({own.end, with_halo(own, Connectivity::triangles).end});
      for_each.emplace_back(found.begin(), found.end());
    }
  });
  const std::vector<std::vector<ActiveBrick>> from_each = ranks.exchange(for_each);
  ranks.together([&] { part.set_halo(from_each); });
}

}  // namespace

HaloCounts halo_counts(const Ranks& ranks, Backend backend) {
  std::uint64_t on_device = 0;
  ranks.together([&] { on_device = resolve(backend) == Backend::cuda ? 1 : 0; });
  return ranks.sum(on_device) == 0 ? HaloCounts::given : HaloCounts::own;
}

std::unique_ptr<SurfacePart> count_together(const Ranks& ranks, const SphereSet& near,
                                            std::span<const SphereId> ids,
                                            std::span<const std::uint64_t> begins, HaloCounts halo,
                                            const ExtractOptions& options, Backend backend) {
  const KeyRange own = run_of(ranks, begins);
  std::unique_ptr<SurfacePart> part;
  std::unique_ptr<PartWithoutHalo> without_halo;
  ranks.together([&] {
    if (halo == HaloCounts::given) {
      without_halo = count_without_halo(near, ids, own, options);
    } else {
      part = count_part(backend, near, ids, own, options);
    }
    check_memory(halo == HaloCounts::given ? without_halo->size() : part->size(), options,
                 near.size());
  });
  if (!without_halo) return part;
  share_halos(ranks, begins, *without_halo);
  return without_halo;
}

}  // namespace vdwmesh
