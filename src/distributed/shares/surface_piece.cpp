// mesh_together(): all ranks estimate where the surface is, and the first one cuts it into shares.
// Each rank then counts its share with the spheres near it, in the grid of the whole set, and of a
// blended field in its frame, too, because the field is a sum of floats. Of a union no bit depends
// on the order in which the balls are visited (union_exit()), so there a rank's cell list has a
// frame of its own: that of the set has cells for all spheres, which every rank would fill. A
// prefix sum over the counts gives every rank its place in the mesh, where it emits its part.
#include "distributed/shares/surface_piece.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "distributed/shares/surface_shares.hpp"
#include "distributed/together/part_together.hpp"

namespace vdwmesh {
namespace {

// Throws LimitExceeded if the triangles of this rank may name more vertices than 32 bits tell
// apart.
void check_names(const SurfacePart& part) {
  const std::uint64_t named = part.size().vertices + part.halo().behind;
  if (named <= kMaxVertices) return;
  throw LimitExceeded(
      fmt::format("{} vertices of a rank and around it are more than the {} that its triangles "
                  "can name: more ranks or a larger --spacing would do",
                  named, kMaxVertices));
}

// Gives the corners of triangles the local numbers of a SurfacePiece. They come counted from the
// first own vertex: own ones have their local numbers already. The others are vertices of the halo,
// which stand behind them, and only the last triangles have some. The halo's vertices that have a
// name are marked and numbered in their order, which takes no sorting and no search.
void name_locally(const HaloVertices& halo, SurfacePiece& piece) {
  const auto [first, begin, own] = piece.numbers.runs().front();
  const auto is_own = [own = own](std::uint32_t corner) { return corner < own; };
  const std::span<Triangle> triangles = std::span(piece.mesh.triangles).last(halo.naming_triangles);
  const std::vector<std::size_t> at_border =
      collect<std::size_t>(triangles.size(), [&](std::size_t t, std::vector<std::size_t>& found) {
        const auto& [a, b, c] = triangles[t];
        if (!(is_own(a) && is_own(b) && is_own(c))) found.push_back(t);
      });
  // By vertex of the halo: at first whether a triangle has it, then its place in `elsewhere`.
  std::vector<std::uint32_t> place(halo.behind);
  const auto for_each_other = [&, own = own](const auto& use) {
    for_each_index(at_border.size(), [&](std::size_t i) {
      for (std::uint32_t& corner : triangles[at_border[i]]) {
        if (!is_own(corner)) use(corner, place[corner - own]);
      }
    });
  };
  for_each_other([](std::uint32_t, std::uint32_t& mark) {
    std::atomic_ref(mark).store(1, std::memory_order_relaxed);
  });
  piece.elsewhere.resize(place.size());
  const auto is_named = [&](std::size_t v) { return place[v] != 0; };
  piece.elsewhere.resize(number_all(
      place.size(), is_named, [&, first = first, own = own](std::size_t v, std::uint32_t number) {
        place[v] = number;
        piece.elsewhere[number] = first + own + v;
      }));
  piece.elsewhere.shrink_to_fit();  // few of the halo's vertices have a name
  for_each_other([own = own](std::uint32_t& corner, std::uint32_t number) {
    corner = static_cast<std::uint32_t>(own + number);
  });
}

// Makes room for the mesh of a part, and behind its arrays for what the border mesh will add to
// them: the vertices behind the range that its triangles name, the triangles of ranges before it
// that name own vertices, and the vertices of these. Room that is not used takes no memory.
void reserve_with_border(const SurfacePart& part, std::uint64_t naming_triangles,
                         IndexedMesh& mesh) {
  const MeshSize size = part.size();
  mesh.positions.reserve(size.vertices + part.halo().behind + naming_triangles);
  mesh.triangles.reserve(size.triangles + naming_triangles);
}

// Adds up the counts that are of the whole mesh. Collective.
void add_up(const Ranks& ranks, ExtractStats& stats) {
  stats.clamped_vertices = ranks.sum(stats.clamped_vertices);
  stats.grid_clipped = ranks.sum(stats.grid_clipped);
  stats.unmatched_faces = ranks.sum(stats.unmatched_faces);
}

}  // namespace

SurfacePiece mesh_together(const Ranks& ranks, const SphereSet& spheres, ExtractOptions options,
                           Backend backend, IndexedMesh memory) {
  ranks.together([&] {
    if (resolve(backend) == Backend::cuda) {
      share_devices(static_cast<std::size_t>(ranks.number_on_host()));
    }
  });
  options.grid.given = grid_together(ranks, spheres, options.grid);
  options.frame = nullptr;
  options.connectivity = Connectivity::triangles;
  FieldModel model;
  ranks.together([&] { model = make_field_model(options.field, *options.grid.given); });
  const bool is_alone = ranks.count() == 1;  // its cell list then makes a frame by itself
  CellListFrame frame;
  std::vector<std::uint64_t> begins{0};
  ChosenSpheres near;
  const HaloCounts halo = halo_counts(ranks, backend);
  if (!is_alone) {
    if (model.kind != FieldKind::vdw) {
      frame = frame_together(ranks, spheres, model);
      options.frame = &frame;
    }
    begins = share_bricks(ranks, spheres, model);
    near = spheres_near(ranks, spheres, model, begins, halo);
  }
  SphereSet chosen;
  ranks.together([&] { chosen = SphereSet::view(is_alone ? spheres.spheres() : near.spheres); });
  const std::unique_ptr<SurfacePart> part =
      count_together(ranks, chosen, near.ids, begins, halo, options, backend);
  ranks.together([&] { check_names(*part); });
  const MeshSize own = part->size();
  SurfacePiece piece;
  piece.mesh = std::move(memory);
  piece.numbers = VertexNumbers(static_cast<std::size_t>(ranks.number()));
  piece.numbers.append(ranks.of_all(own.vertices));
  piece.first_triangle = ranks.sum_before(own.triangles);
  piece.whole = {piece.numbers.whole(), ranks.sum(own.triangles)};
  const auto naming = ranks.of_all(part->halo().naming_triangles);
  ranks.together([&] {
    reserve_with_border(*part, std::ranges::max(naming), piece.mesh);
    piece.stats = part->emit({0, piece.first_triangle}, piece.mesh);
    name_locally(part->halo(), piece);
  });
  add_up(ranks, piece.stats);
  piece.fallback = ranks.first_text(part->fallback);
  if (piece.stats.unmatched_faces != 0) {
    ranks.together([] { throw InternalError("a rank left out a brick that holds surface"); });
  }
  return piece;
}

}  // namespace vdwmesh
