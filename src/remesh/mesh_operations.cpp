// Each operation asks first what costs least: features, then the link condition, then lengths, and
// the judge at last.
#include "remesh/mesh_operations.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "remesh/size_field.hpp"

namespace vdwmesh::remesh {
namespace {

// A shape that must rise does so by more than rounding.
constexpr double kBetter = 1.001;
// Å: by how much a flip of good triangles may take their middles farther from the surface.
constexpr double kAsNear = 1e-9;

}  // namespace

MeshOperations::MeshOperations(DynamicMesh mesh, VertexTable vertices,
                               std::span<const CreaseCircle> circles, const FootOracle& oracle,
                               std::span<const Box> zones, double edge_length, double farthest)
    : mesh_(std::move(mesh)),
      vertices_(std::move(vertices)),
      circles_(circles),
      oracle_(oracle),
      guard_(mesh_, vertices_.position, zones, edge_length),
      judge_(oracle, vertices_, guard_, farthest),
      edge_length_(edge_length) {}

double MeshOperations::share(HalfEdge h) const {
  const std::uint32_t u = mesh_.from(h), w = mesh_.to(h);
  return norm(vertices_.position[w] - vertices_.position[u]) /
         std::min(vertices_.edge_length[u], vertices_.edge_length[w]);
}

NewTriangle MeshOperations::placed(const Triangle& v) const {
  const std::vector<Vec3d>& p = vertices_.position;
  return {v, {p[v[0]], p[v[1]], p[v[2]]}};
}

double MeshOperations::shape(std::uint32_t triangle) const {
  return shape_of(placed(mesh_.triangle(triangle)));
}

double MeshOperations::replace_at(std::uint32_t at, std::uint32_t vertex, const Vec3d& to) {
  change_.removed.clear(), change_.made.clear();
  double worst = 1;
  mesh_.visit_spokes(at, [&](HalfEdge h) {
    const std::uint32_t t = h / 3;
    change_.removed.push_back(t);
    worst = std::min(worst, shape(t));
    NewTriangle made = placed(mesh_.triangle(t));
    if (at != vertex && std::ranges::count(made.vertex, vertex) > 0) return;
    const auto k =
        static_cast<std::size_t>(std::ranges::find(made.vertex, at) - made.vertex.begin());
    made.vertex[k] = vertex, made.corner[k] = to;
    change_.made.push_back(made);
  });
  return worst;
}

void MeshOperations::note_ring(std::uint32_t vertex) {
  mesh_.visit_spokes(vertex, [&](HalfEdge h) { guard_.note(h / 3); });
}

// Whether the features let the first vertex of h go to the second one.
bool MeshOperations::may_leave(HalfEdge h) const {
  const VertexHold from = vertices_.hold[mesh_.from(h)], to = vertices_.hold[mesh_.to(h)];
  if (from == VertexHold::none) return true;
  if (from == VertexHold::crease && mesh_.mark(h) != kNone) return true;
  if (to == VertexHold::none || (from == VertexHold::corner && to == VertexHold::crease)) {
    return false;
  }
  const Vec3d way = vertices_.position[mesh_.to(h)] - vertices_.position[mesh_.from(h)];
  return norm(way) < kJoining * edge_length_;
}

std::uint32_t MeshOperations::collapse_onto(HalfEdge h, double least_shape) {
  const std::uint32_t u = mesh_.from(h), w = mesh_.to(h);
  const std::uint32_t apexes[2] = {mesh_.apex(h), mesh_.apex(mesh_.opposite(h))};
  const double worst = replace_at(u, w, vertices_.position[w]);
  if (!judge_.allows(change_, std::min(worst * kBetter, least_shape))) return kNone;
  const bool joins = vertices_.hold[u] != VertexHold::none &&
                     (mesh_.mark(h) == kNone || vertices_.hold[u] == VertexHold::corner);
  mesh_.collapse(h);
  note_ring(w);
  if (!joins) return w;
  ++joined_;
  for (const std::uint32_t v : {w, apexes[0], apexes[1]}) {
    if (vertices_.hold[v] != VertexHold::corner) vertices_.hold[v] = hold_by_marks(mesh_, v);
  }
  return w;
}

// Of the two directions the one that leaves better triangles is tried first.
std::uint32_t MeshOperations::collapse(HalfEdge h, double least_shape) {
  if (!mesh_.may_collapse(h)) return kNone;
  struct Way {
    double worst;  // shape of the worst triangle made; -1: the way is closed
    HalfEdge h;
  };
  Way ways[2] = {{-1, h}, {-1, mesh_.opposite(h)}};
  for (Way& way : ways) {
    const std::uint32_t u = mesh_.from(way.h), w = mesh_.to(way.h);
    if (!may_leave(way.h)) continue;
    const Vec3d& to = vertices_.position[w];
    bool is_short = true;
    mesh_.visit_spokes(u, [&](HalfEdge spoke) {
      const std::uint32_t v = mesh_.to(spoke);
      const double wanted = std::min(vertices_.edge_length[v], vertices_.edge_length[w]);
      is_short = is_short && norm(vertices_.position[v] - to) <= kLongestShare * wanted;
    });
    if (!is_short) continue;
    replace_at(u, w, to);
    way.worst = 1;
    for (const NewTriangle& t : change_.made) way.worst = std::min(way.worst, shape_of(t));
  }
  if (ways[1].worst > ways[0].worst) std::swap(ways[0], ways[1]);
  for (const Way& way : ways) {
    if (way.worst < 0) continue;
    const std::uint32_t kept = collapse_onto(way.h, least_shape);
    if (kept != kNone) return kept;
  }
  return kNone;
}

std::optional<Foot> MeshOperations::place(const Vec3d& p, const Vec3d& hint,
                                          std::uint32_t circle) const {
  if (circle == kNone) return oracle_.project(p, hint);
  const CreaseCircle& crease = circles_[circle];
  const Vec3d at = crease.nearest(p);
  if (!oracle_.is_on_surface(at)) return std::nullopt;
  return Foot{at, hint, 0, crease.patches[0]};
}

bool MeshOperations::split(HalfEdge h) {
  const std::uint32_t u = mesh_.from(h), w = mesh_.to(h);
  const Vec3d between = 0.5 * (vertices_.position[u] + vertices_.position[w]);
  const Vec3d sum = vertices_.normal[u] + vertices_.normal[w];
  const double length = norm(sum);
  if (!(length > 0)) return false;
  const auto foot = place(between, (1 / length) * sum, mesh_.mark(h));
  if (!foot) return false;
  const std::uint32_t left = h / 3, right = mesh_.opposite(h) / 3, m = mesh_.vertex_count();
  vertices_.position.push_back(foot->point);
  vertices_.normal.push_back(foot->normal);
  vertices_.edge_length.push_back(0.5 * (vertices_.edge_length[u] + vertices_.edge_length[w]));
  vertices_.hold.push_back(mesh_.mark(h) == kNone ? VertexHold::none : VertexHold::crease);
  vertices_.patch.push_back(foot->patch);
  const std::uint32_t a = mesh_.apex(h), b = mesh_.apex(mesh_.opposite(h));
  change_.removed = {left, right};
  change_.made = {placed({u, m, a}), placed({m, w, a}), placed({m, u, b}), placed({w, m, b})};
  const double worst = std::min(shape(left), shape(right));
  if (judge_.allows(change_, std::min(worst, kLeastSplitShape))) {
    mesh_.split(h);
    note_ring(m);
    return true;
  }
  vertices_.position.pop_back(), vertices_.normal.pop_back(), vertices_.edge_length.pop_back();
  vertices_.hold.pop_back(), vertices_.patch.pop_back();
  return false;
}

// Triangles that are good already are flipped only if that takes their middles no farther from the
// surface.
bool MeshOperations::flip(HalfEdge h) {
  if (mesh_.mark(h) != kNone) return false;
  const HalfEdge g = mesh_.opposite(h);
  const std::uint32_t u = mesh_.from(h), w = mesh_.to(h), a = mesh_.apex(h), b = mesh_.apex(g);
  const double before = std::min(shape(h / 3), shape(g / 3));
  const NewTriangle left = placed({u, b, a}), right = placed({w, a, b});
  const double after = std::min(shape_of(left), shape_of(right));
  if (after <= kBetter * before || !mesh_.may_flip(h)) return false;
  if (before > kGoodShape) {
    const double was = std::max(judge_.height(placed(mesh_.triangle(h / 3))),
                                judge_.height(placed(mesh_.triangle(g / 3))));
    if (std::max(judge_.height(left), judge_.height(right)) > was + kAsNear) return false;
  }
  change_.removed = {h / 3, g / 3};
  change_.made = {left, right};
  if (!judge_.allows(change_, 0)) return false;
  mesh_.flip(h);
  for (const std::uint32_t t : change_.removed) guard_.note(t);
  return true;
}

// The mean of the middles of the triangles around a vertex, each by its area, in the tangent plane.
Vec3d MeshOperations::middle_of_ring(std::uint32_t vertex) const {
  Vec3d sum{0, 0, 0};
  double weights = 0;
  mesh_.visit_spokes(vertex, [&](HalfEdge h) {
    const NewTriangle t = placed(mesh_.triangle(h / 3));
    const double area = norm(cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]));
    sum = sum + (area / 3) * (t.corner[0] + t.corner[1] + t.corner[2]);
    weights += area;
  });
  const Vec3d& at = vertices_.position[vertex];
  if (!(weights > 0)) return at;
  const Vec3d way = (1 / weights) * sum - at, &n = vertices_.normal[vertex];
  return at + way - dot(way, n) * n;
}

// The middle of a vertex's neighbours on its crease.
Vec3d MeshOperations::middle_of_crease(std::uint32_t vertex, std::uint32_t& circle) const {
  Vec3d sum{0, 0, 0};
  mesh_.visit_spokes(vertex, [&](HalfEdge h) {
    if (mesh_.mark(h) == kNone) return;
    circle = mesh_.mark(h);
    sum = sum + 0.5 * vertices_.position[mesh_.to(h)];
  });
  return sum;
}

bool MeshOperations::smooth(std::uint32_t vertex, double good, double share_of_way) {
  if (vertices_.hold[vertex] == VertexHold::corner) return false;
  std::uint32_t circle = kNone;
  const Vec3d middle = vertices_.hold[vertex] == VertexHold::crease
                           ? middle_of_crease(vertex, circle)
                           : middle_of_ring(vertex);
  const Vec3d& at = vertices_.position[vertex];
  const auto foot = place(at + share_of_way * (middle - at), vertices_.normal[vertex], circle);
  if (!foot) return false;
  const double worst = replace_at(vertex, vertex, foot->point);
  const Vec3d normal = std::exchange(vertices_.normal[vertex], foot->normal);
  if (!judge_.allows(change_, std::min(worst * kBetter, good))) {
    vertices_.normal[vertex] = normal;
    return false;
  }
  vertices_.position[vertex] = foot->point;
  vertices_.patch[vertex] = foot->patch;
  note_ring(vertex);
  return true;
}

}  // namespace vdwmesh::remesh
