// survey_divided(): a divided mesh is surveyed by the mesh that was divided, which has a quarter of
// its triangles.
//
// Every four consecutive triangles must be a patch (surface/divided_patches.hpp), and all corners
// must come before all midpoints. The triangles of corners are the coarse mesh. Two passes over its
// sides, which run from one corner of a patch to the next, see which midpoint they have:
//  1. Each side that runs from the smaller vertex to the larger one writes both at its midpoint.
//  2. Each side must find its own two vertices at its midpoint.
// Then the coarse mesh must be a closed, oriented manifold, which survey_edges() finds out, without
// a shell of two triangles.
// In the first pass two sides may write at one midpoint, against the rule of core/blocks.hpp:
// whichever of them is the last, the second pass finds that the other one's ends are not there.
//
// Claim: then each edge of the coarse mesh has one midpoint, and no two edges have the same one.
// Proof: an edge has two sides that run in opposite directions, so exactly one that writes. The
// other one found the edge at its midpoint, which only the writing side can have written, at its
// own midpoint; so both have the same. Two vertices stand at a midpoint in the second pass, so it
// has one edge. ∎ It follows that the mesh is the coarse one with a vertex in the middle of each
// edge and each triangle cut into four: the same surface with other triangles, which run around as
// theirs. Its edges are two halves of each coarse edge and three in each patch. These three run
// between midpoints, so only another patch with the same two coarse edges could have one of them:
// it has the same three corners, the third edge is that of both, too, and the two are a shell of
// their own, which was excluded. So the mesh is a closed, oriented manifold too. Its vertices are
// the coarse ones and one for each coarse edge. Its shells are the coarse ones, in the same order,
// because the triangles of a patch stand together.
//
// A mesh that was divided twice is surveyed by way of the one between, and so on.
#include "analysis/survey/divided_survey.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <utility>

#include "core/blocks.hpp"
#include "core/fixed_blocks.hpp"
#include "core/lanes/multiversion.hpp"
#include "core/large_pages.hpp"
#include "surface/divided_patches.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint64_t kNoEnds = ~std::uint64_t{0};

// The vertices of an edge, the smaller one in the upper half.
std::uint64_t ends_of(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

// Passes 1 and 2. `corners` has the corners of each patch; all midpoints are at least `first`.
bool have_own_midpoints(const IndexedMesh& mesh, const Buffer<Triangle>& corners,
                        std::size_t first) {
  Buffer<std::uint64_t> ends(mesh.vertex_count() - first, kNoEnds);
  const auto visit_sides = [&](std::size_t t, const auto& visit) {
    const Triangle& corner = corners[t];
    const Triangle& middle = midpoints_of_patch(mesh, t);
    for (std::size_t k = 0; k < 3; ++k) {
      visit(corner[k], corner[k == 2 ? 0 : k + 1], std::atomic_ref(ends[middle[k] - first]));
    }
  };
  for_all(corners.size(), [&](std::size_t t) {
    visit_sides(t, [](std::uint32_t from, std::uint32_t to, auto place) {
      if (from < to) place.store(ends_of(from, to), std::memory_order_relaxed);
    });
  });
  const auto judge = [&](std::size_t t, bool& all) {
    visit_sides(t, [&](std::uint32_t from, std::uint32_t to, auto place) {
      all &= place.load(std::memory_order_relaxed) == ends_of(from, to);
    });
  };
  return reduce_all(corners.size(), true, judge, std::logical_and<>());
}

// The coarse mesh, or one without triangles if the mesh is not divided, or if the sides do not pass
// the two passes. It has no coordinates: the array only says how many vertices there are.
IndexedMesh coarse_mesh(const IndexedMesh& mesh) {
  IndexedMesh coarse;
  const PatchVertices found = survey_patches(mesh);
  if (!found.are_in_order() || found.last_midpoint >= mesh.vertex_count()) return coarse;
  coarse.triangles.resize(mesh.triangle_count() / 4);
  for_all(coarse.triangles.size(),
          [&](std::size_t t) { coarse.triangles[t] = corners_of_patch(mesh, t); });
  coarse.positions.resize(std::size_t{found.last_corner} + 1);
  if (!have_own_midpoints(mesh, coarse.triangles, coarse.vertex_count())) coarse.triangles.clear();
  return coarse;
}

// Whether one of the shells has two triangles. Nobody counts beyond three.
bool has_shell_of_two(const EdgeSurvey& survey) {
  Buffer<std::uint32_t> triangles(survey.shells, 0);
  for_all(survey.shell_of.size(), [&](std::size_t t) {
    const std::atomic_ref count(triangles[survey.shell_of[t]]);
    if (count.load(std::memory_order_relaxed) < 3) count.fetch_add(1, std::memory_order_relaxed);
  });
  return std::ranges::find(triangles, 2u) != triangles.end();
}

// At most so many edges are taken at a patch: those of its middle child and the halves of three.
constexpr std::size_t kMostEdges = 9;

// Writes the lengths of the edges of patches, each edge once: the halves of a coarse edge at the
// side that runs from its smaller vertex to the larger one. Returns their number. Of a side that
// runs the other way the halves are written, too, and then overwritten.
VDWMESH_MULTIVERSION std::size_t fill_patch_lengths(const IndexedMesh& mesh, std::size_t first,
                                                    std::size_t end, double* lengths) {
  std::size_t count = 0;
  for (std::size_t t = first; t < end; ++t) {
    const Triangle corner = corners_of_patch(mesh, t);
    const Triangle& middle = midpoints_of_patch(mesh, t);
    Vec3d c[4], m[4];
    for (std::size_t k = 0; k < 4; ++k) {
      c[k] = mesh.positions[corner[k % 3]];
      m[k] = mesh.positions[middle[k % 3]];
    }
    for (std::size_t k = 0; k < 3; ++k) lengths[count++] = norm(m[k + 1] - m[k]);
    for (std::size_t k = 0; k < 3; ++k) {
      lengths[count] = norm(m[k] - c[k]);
      lengths[count + 1] = norm(c[k + 1] - m[k]);
      count += corner[k] < corner[k == 2 ? 0 : k + 1] ? 2 : 0;
    }
  }
  return count;
}

void add_lengths(const IndexedMesh& mesh, BracketedValues& lengths) {
  constexpr std::size_t kPatches = 256;
  for_each_block(mesh.triangle_count() / 4, kPatches,
                 [&](std::size_t, std::size_t first, std::size_t end) {
                   std::array<double, kMostEdges * kPatches> of_block;
                   const std::size_t count = fill_patch_lengths(mesh, first, end, of_block.data());
                   lengths.add(std::span(of_block).first(count));
                 });
}

// A look at a few patches, so that other meshes cost no pass.
bool seems_divided(const IndexedMesh& mesh) {
  constexpr std::size_t kFew = 64;
  const std::size_t patches = mesh.triangle_count() / 4;
  if (patches == 0 || mesh.triangle_count() % 8 != 0) return false;
  for (std::size_t t = 0; t < std::min(kFew, patches); ++t) {
    if (!is_patch(mesh, t)) return false;
  }
  return true;
}

}  // namespace

std::optional<EdgeSurvey> survey_divided(const IndexedMesh& mesh, BracketedValues* edge_lengths) {
  if (!seems_divided(mesh)) return std::nullopt;
  EdgeSurvey survey;
  {
    const IndexedMesh coarse = coarse_mesh(mesh);
    if (coarse.triangles.empty()) return std::nullopt;
    survey = survey_edges(coarse);
  }
  if (!survey.closed || !survey.manifold || !survey.oriented) return std::nullopt;
  if (has_shell_of_two(survey)) return std::nullopt;
  const Buffer<std::uint32_t> of_patch = std::move(survey.shell_of);
  survey.used_vertices += survey.edges;
  survey.edges = 2 * survey.edges + 3 * of_patch.size();
  survey.shell_of = {};
  resize_untouched(survey.shell_of, mesh.triangle_count());
  for_all(mesh.triangle_count(), [&](std::size_t t) { survey.shell_of[t] = of_patch[t / 4]; });
  if (edge_lengths != nullptr) add_lengths(mesh, *edge_lengths);
  return survey;
}

}  // namespace vdwmesh
