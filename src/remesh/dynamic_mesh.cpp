// The operations of DynamicMesh. Each is a few assignments in the corner table: which vertex a
// half-edge leaves, and which half-edge is its opposite.
#include "remesh/dynamic_mesh.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/errors.hpp"

namespace vdwmesh::remesh {
namespace {

constexpr const char* kNoManifold = "the mesh to be remeshed is no closed oriented manifold";

}  // namespace

DynamicMesh::DynamicMesh(const IndexedMesh& mesh)
    : corners_(3 * mesh.triangle_count()),
      opposite_(corners_.size(), kNone),
      marks_(corners_.size(), kNone),
      out_(mesh.vertex_count(), kNone) {
  for (std::size_t h = 0; h < corners_.size(); ++h) {
    corners_[h] = mesh.triangles[h / 3][h % 3];
    if (out_[corners_[h]] == kNone) out_[corners_[h]] = static_cast<HalfEdge>(h);
  }
  pair_edges();
}

// Half-edges are sorted by their ends; the two of an edge are beside each other. All triangles at a
// vertex must be in one ring.
void DynamicMesh::pair_edges() {
  if (corners_.size() % 2 != 0) throw InvalidInput(kNoManifold);
  std::vector<std::pair<std::uint64_t, HalfEdge>> order(corners_.size());
  for (HalfEdge h = 0; h < order.size(); ++h) {
    const std::uint32_t low = std::min(from(h), to(h)), high = std::max(from(h), to(h));
    order[h] = {std::uint64_t{low} << 32 | high, h};
  }
  std::ranges::sort(order);
  for (std::size_t i = 0; i < order.size(); i += 2) {
    const auto [edge, a] = order[i];
    const auto [same, b] = order[i + 1];
    const bool more = i + 2 < order.size() && order[i + 2].first == edge;
    if (same != edge || more || from(a) != to(b)) throw InvalidInput(kNoManifold);
    opposite_[a] = b, opposite_[b] = a;
  }
  std::size_t in_rings = 0;
  for (std::uint32_t v = 0; v < vertex_count(); ++v) in_rings += is_vertex(v) ? valence(v) : 0;
  if (in_rings != corners_.size()) throw InvalidInput(kNoManifold);
}

std::uint32_t DynamicMesh::valence(std::uint32_t v) const {
  std::uint32_t count = 0;
  visit_spokes(v, [&](HalfEdge) { ++count; });
  return count;
}

HalfEdge DynamicMesh::find(std::uint32_t from, std::uint32_t to) const {
  HalfEdge found = kNone;
  if (!is_vertex(from)) return found;
  visit_spokes(from, [&](HalfEdge h) {
    if (this->to(h) == to) found = h;
  });
  return found;
}

// The two ends have just the two apexes as common neighbours, and no apex is left with two edges.
bool DynamicMesh::may_collapse(HalfEdge h) const {
  const std::uint32_t u = from(h), w = to(h);
  int common = 0;
  visit_spokes(u, [&](HalfEdge spoke) {
    const std::uint32_t neighbor = to(spoke);
    visit_spokes(w, [&](HalfEdge other) { common += to(other) == neighbor; });
  });
  return common == 2 && valence(apex(h)) > 3 && valence(apex(opposite_[h])) > 3;
}

void DynamicMesh::pair(HalfEdge a, HalfEdge b) {
  opposite_[a] = b, opposite_[b] = a;
  if (marks_[a] == kNone) marks_[a] = marks_[b];
  marks_[b] = marks_[a];
}

void DynamicMesh::collapse(HalfEdge h) {
  const HalfEdge g = opposite_[h];
  const std::uint32_t u = from(h), w = to(h), a = apex(h), b = apex(g);
  std::vector<HalfEdge> spokes;
  visit_spokes(u, [&](HalfEdge spoke) { spokes.push_back(spoke); });
  for (const HalfEdge spoke : spokes) corners_[spoke] = w;
  // The edges beside the two triangles that vanish: from w to a and back, from b to w and back.
  const HalfEdge from_a = opposite_[next(h)], to_a = opposite_[previous(h)];
  const HalfEdge from_w = opposite_[previous(g)], to_w = opposite_[next(g)];
  pair(from_a, to_a);
  pair(from_w, to_w);
  for (const HalfEdge dead : {h, next(h), previous(h), g, next(g), previous(g)}) {
    corners_[dead] = kNone;
  }
  out_[u] = kNone, out_[w] = from_w, out_[a] = from_a, out_[b] = to_w;
}

bool DynamicMesh::may_flip(HalfEdge h) const {
  return find(apex(h), apex(opposite_[h])) == kNone && valence(from(h)) > 3 && valence(to(h)) > 3;
}

// Writes a triangle whose edges have these half-edges across, and their marks; kNone: the caller
// pairs that edge.
void DynamicMesh::set_triangle(std::uint32_t t, const Triangle& vertices,
                               const std::array<HalfEdge, 3>& across) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    const HalfEdge h = 3 * t + k;
    corners_[h] = vertices[k], out_[vertices[k]] = h;
    if (across[k] == kNone) continue;
    opposite_[h] = across[k], opposite_[across[k]] = h;
    marks_[h] = marks_[across[k]];
  }
}

void DynamicMesh::flip(HalfEdge h) {
  const HalfEdge g = opposite_[h];
  const std::uint32_t u = from(h), w = to(h), a = apex(h), b = apex(g);
  const HalfEdge wa = opposite_[next(h)], au = opposite_[previous(h)];
  const HalfEdge ub = opposite_[next(g)], bw = opposite_[previous(g)];
  const std::uint32_t left = h / 3, right = g / 3;
  set_triangle(left, {u, b, a}, {ub, kNone, au});
  set_triangle(right, {w, a, b}, {wa, kNone, bw});
  opposite_[3 * left + 1] = 3 * right + 1, opposite_[3 * right + 1] = 3 * left + 1;
  marks_[3 * left + 1] = marks_[3 * right + 1] = kNone;
}

std::uint32_t DynamicMesh::split(HalfEdge h) {
  const HalfEdge g = opposite_[h];
  const std::uint32_t u = from(h), w = to(h), a = apex(h), b = apex(g), mark = marks_[h];
  const HalfEdge wa = opposite_[next(h)], au = opposite_[previous(h)];
  const HalfEdge ub = opposite_[next(g)], bw = opposite_[previous(g)];
  const std::uint32_t m = vertex_count(), first = triangle_count();
  out_.push_back(kNone);
  for (auto* all : {&corners_, &opposite_, &marks_}) all->resize(all->size() + 6, kNone);
  const std::uint32_t ts[4] = {h / 3, first, g / 3, first + 1};
  set_triangle(ts[0], {u, m, a}, {kNone, kNone, au});
  set_triangle(ts[1], {m, w, a}, {kNone, wa, kNone});
  set_triangle(ts[2], {m, u, b}, {kNone, ub, kNone});
  set_triangle(ts[3], {w, m, b}, {kNone, kNone, bw});
  const auto join = [&](HalfEdge x, HalfEdge y, std::uint32_t its_mark) {
    opposite_[x] = y, opposite_[y] = x;
    marks_[x] = marks_[y] = its_mark;
  };
  join(3 * ts[0], 3 * ts[2], mark);
  join(3 * ts[1], 3 * ts[3], mark);
  join(3 * ts[0] + 1, 3 * ts[1] + 2, kNone);
  join(3 * ts[2] + 2, 3 * ts[3] + 1, kNone);
  return m;
}

}  // namespace vdwmesh::remesh
