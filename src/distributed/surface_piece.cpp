// mesh_together(): all ranks estimate where the surface is, and the first one cuts it into shares.
// Each rank then counts its share with the spheres near it, in the grid and the frame of the whole
// set. A prefix sum over the counts gives every rank its place in the mesh, where it emits its
// part.
#include "distributed/surface_piece.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "analysis/stage_bytes.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "distributed/sorted_numbers.hpp"
#include "distributed/surface_shares.hpp"

namespace vdwmesh {
namespace {

// The run of bricks of this rank.
KeyRange own_share(const Ranks& ranks, const SphereSet& spheres, const FieldModel& model) {
  const auto rank = static_cast<std::size_t>(ranks.number());
  const auto count = static_cast<std::size_t>(ranks.count());
  std::vector<BrickArea> areas;
  ranks.together([&] { areas = estimate_bricks(spheres, model, rank, count); });
  std::vector<BrickArea> all = ranks.collect(std::span<const BrickArea>(areas));
  std::vector<std::uint64_t> begins;
  ranks.together([&] {
    if (ranks.is_first()) begins = cut_bricks(std::move(all), count);
  });
  ranks.share(begins);
  return {begins[rank], rank + 1 < count ? begins[rank + 1] : kNoBrickKey};
}

// Throws LimitExceeded if the part that a rank has counted does not fit the memory that it is
// allowed.
void check_memory(const MeshSize& size, const ExtractOptions& options, std::size_t spheres) {
  const std::uint64_t mesh = indexed_mesh_bytes(size, {.normals = options.normals});
  // While the mesh is made, counts of bricks and the cell list take about as much as these; while
  // it is measured, a copy of positions and triangles is there.
  const std::uint64_t made = mesh / 4 + 128 * static_cast<std::uint64_t>(spheres),
                      measured = sizeof(Vec3d) * size.vertices + sizeof(Triangle) * size.triangles +
                                 measures_bytes(size);
  const std::uint64_t beside = std::max(made, measured);
  if (mesh + beside <= options.memory_limit) return;
  throw LimitExceeded(fmt::format(
      "{} triangles need {} MiB of memory, {} MiB are allowed to a rank: more ranks, a larger "
      "--spacing or --memory-limit {}M would do",
      size.triangles, (mesh + beside) >> 20, options.memory_limit >> 20,
      ((mesh + beside) >> 20) + 1));
}

// The corners of triangles come as the last 32 bits of vertex numbers of the whole mesh. Returns
// the lowest number that the triangles of this rank may name. If they name no more than 2^32
// numbers from there on, the last bits tell the number.
std::uint64_t lowest_named(const SurfacePart& part, std::uint64_t first_vertex) {
  const HaloVertices halo = part.halo();
  const std::uint64_t named = halo.before + part.size().vertices + halo.behind;
  if (named > kMaxVertices) {
    throw LimitExceeded(
        fmt::format("{} vertices of a rank and around it are more than the {} that its triangles "
                    "can name: more ranks or a larger --spacing would do",
                    named, kMaxVertices));
  }
  return first_vertex - halo.before;
}

// Gives the corners of triangles the local numbers of a SurfacePiece. The own vertices are one run
// of numbers.
void name_locally(std::uint64_t lowest, SurfacePiece& piece) {
  const auto [first, begin, own] = piece.numbers.runs().front();
  const auto number_of = [=](std::uint32_t corner) { return number_from_name(corner, lowest); };
  const auto is_own = [first = first, own = own](std::uint64_t number) {
    return number - first < own;  // a lower number wraps around to a large difference
  };
  Buffer<Triangle>& triangles = piece.mesh.triangles;
  piece.elsewhere =
      collect<std::uint64_t>(triangles.size(), [&](std::size_t t, std::vector<std::uint64_t>& all) {
        for (const std::uint32_t corner : triangles[t]) {
          if (!is_own(number_of(corner))) all.push_back(number_of(corner));
        }
      });
  sort_without_repeats(piece.elsewhere);
  for_each_index(triangles.size(), [&](std::size_t t) {
    for (std::uint32_t& corner : triangles[t]) {
      const std::uint64_t number = number_of(corner);
      const std::uint64_t local =
          is_own(number) ? number - first : own + place_in(piece.elsewhere, number);
      corner = static_cast<std::uint32_t>(local);
    }
  });
}

void use_numbers_of_whole(const std::vector<SphereId>& ids, IndexedMesh& mesh) {
  Buffer<SphereId>& atoms = mesh.vertex_spheres.atoms;
  for_each_index(atoms.size(), [&](std::size_t v) {
    if (atoms[v] != kNoSphere) atoms[v] = ids[atoms[v]];
  });
}

// Adds up the counts that are of the whole mesh. Collective.
void add_up(const Ranks& ranks, ExtractStats& stats) {
  stats.clamped_vertices = ranks.sum(stats.clamped_vertices);
  stats.grid_clipped = ranks.sum(stats.grid_clipped);
  stats.unmatched_faces = ranks.sum(stats.unmatched_faces);
}

}  // namespace

SurfacePiece mesh_together(const Ranks& ranks, const SphereSet& spheres, ExtractOptions options,
                           Backend backend) {
  FieldModel model;
  ranks.together([&] {
    if (resolve(backend) == Backend::cuda) {
      share_devices(static_cast<std::size_t>(ranks.number_on_host()));
    }
    model = make_field_model(options.field, make_grid(spheres, options.grid));
  });
  const CellListFrame frame = frame_together(ranks, spheres, model);
  const KeyRange share = own_share(ranks, spheres, model);
  options.grid.given = model.grid;
  options.frame = &frame;
  options.connectivity = Connectivity::triangles;
  ChosenSpheres near;
  std::unique_ptr<SurfacePart> part;
  ranks.together([&] {
    near = spheres_near(spheres, model, share);
    part = make_extractor(backend)->count(SphereSet::view(near.spheres), share, options);
    check_memory(part->size(), options, near.spheres.size());
  });
  const MeshSize own = part->size();
  SurfacePiece piece;
  piece.numbers = VertexNumbers(static_cast<std::size_t>(ranks.number()));
  piece.numbers.append(ranks.of_all(own.vertices));
  piece.first_triangle = ranks.sum_before(own.triangles);
  piece.whole = {piece.numbers.whole(), ranks.sum(own.triangles)};
  ranks.together([&] {
    const MeshSize first{piece.numbers.runs().front().first, piece.first_triangle};
    const std::uint64_t lowest = lowest_named(*part, first.vertices);
    piece.stats = part->emit(first, piece.mesh);
    name_locally(lowest, piece);
    use_numbers_of_whole(near.ids, piece.mesh);
  });
  add_up(ranks, piece.stats);
  piece.fallback = ranks.first_text(part->fallback);
  if (piece.stats.unmatched_faces != 0) {
    ranks.together([] { throw InternalError("a rank left out a brick that holds surface"); });
  }
  return piece;
}

}  // namespace vdwmesh
