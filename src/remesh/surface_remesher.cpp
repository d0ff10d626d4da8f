// remesh_excluded(): the exact mesh, its features, the sizes, and the schedule of operations.
//
// The share of an edge is its length, divided by the length that is wanted there. The shape of a
// triangle is the squared sine of its least angle (shape_of()).
//
// 1. Edges are collapsed, by rising share. This does nearly all of the work.
// 2. In rounds, long edges are split, short ones collapsed, edges flipped and vertices moved.
// 3. The triangles with the least angles are made better one by one.
// 4. The finished mesh is searched for crossings. Where there are some, all is done again with a
//    zone there, in which no operation may make a crossing (crossing_guard.hpp).
// Any state between two operations is a sound mesh but for crossings, so it does not matter for
// soundness when the rounds end.
#include "remesh/surface_remesher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

#include "analysis/mesh_measures.hpp"
#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "remesh/mesh_operations.hpp"
#include "remesh/size_field.hpp"
#include "spheres/box.hpp"

namespace vdwmesh {
namespace {

using namespace remesh;
using RemeshClock = std::chrono::steady_clock;

// The exact mesh has this share of the edge length, but at most 0.7 Å: with longer edges it gets
// next to no fewer triangles. Where its curves are too close to be told apart, it is tried again
// with half of that, so many times in all.
constexpr double kExactShare = 0.9, kLongestExact = 0.7;
constexpr int kMostExactTries = 3;
// Edges below these shares of the wanted length are collapsed, first and in rounds.
constexpr double kShortFirst = 0.8, kShortInRounds = 0.7;
// Rounds of the whole mesh, flips and moves in each, and rounds of its worst triangles.
constexpr int kRounds = 3, kFlips = 2, kMoves = 2, kWorstRounds = 3;
// A vertex of a bad triangle tries to go these shares of the way to the middle of its neighbours,
// the last one away from it.
constexpr double kAllTheWay = 1, kSteps[] = {kAllTheWay, 0.5, 0.2, -0.2};
// The middle of an equilateral triangle of edges L is L² / (6 r) from its sphere of radius r.
// Triangles may be kFarther times as far from the surface.
constexpr double kFarther = 1.6;
// Å: replaces a smaller r, so that thin parts of the surface are meshed as they come.
constexpr double kLeastRadius = 0.7;
constexpr double kFarthest = 1;      // Å: no triangle is farther, whatever the length
constexpr double kLeastReach = 0.3;  // Å: FootOracle finds points at least up to this distance
// Of the exact mesh: its corner table and vertices, and a copy of both that is changed; and queues.
constexpr std::uint64_t kBytesPerTriangle = 240;
// The first runs have zones where those before them made crossings; the last run is one zone.
constexpr int kRunsWithZones = 4, kMostRuns = kRunsWithZones + 1;
constexpr std::uint64_t kStep = 4096;  // operations between two questions to the monitor
constexpr double kShapeOf20Degrees = 0.11697777844051098;  // sin² 20°
constexpr double kOnlyIfBetter = 1;  // no triangle has this shape, so the worst one must improve

double elapsed_since(RemeshClock::time_point begin) {
  return std::chrono::duration<double>(RemeshClock::now() - begin).count();
}

// Calls the monitor every kStep operations.
class OperationCounter {
 public:
  explicit OperationCounter(Monitor* monitor) : monitor_(monitor) {}
  void count() {
    if (++count_ % kStep == 0) advance(monitor_, 0);
  }

 private:
  Monitor* monitor_;
  std::uint64_t count_ = 0;
};

class Schedule {
 public:
  Schedule(MeshOperations& operations, Monitor* monitor)
      : operations_(operations), mesh_(operations.mesh()), counter_(monitor), monitor_(monitor) {}

  void run() {
    begin_stage(monitor_, "coarsen", 2 + kRounds);
    collapse_below(kShortFirst);
    advance(monitor_, 1);
    for (int round = 0; round < kRounds; ++round) {
      split_long_edges();
      collapse_below(kShortInRounds);
      for (int i = 0; i < kFlips; ++i) flip_all();
      for (int i = 0; i < kMoves; ++i) smooth_all();
      advance(monitor_, 1);
    }
    flip_all();
    for (int i = 0; i < kWorstRounds; ++i) mend_worst();
    advance(monitor_, 1);
  }

 private:
  // An edge of a queue, with its share when it was put there.
  using Entry = std::tuple<double, std::uint32_t, std::uint32_t>;

  void collapse_below(double limit) {
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    const auto offer = [&](HalfEdge h) {
      const double share = operations_.share(h);
      if (!(share < limit)) return;
      const std::uint32_t u = mesh_.from(h), w = mesh_.to(h);
      queue.emplace(share, std::min(u, w), std::max(u, w));
    };
    mesh_.visit_edges(offer);
    while (!queue.empty()) {
      const auto [share, u, w] = queue.top();
      queue.pop();
      counter_.count();
      const HalfEdge h = mesh_.find(u, w);
      if (h == kNone || operations_.share(h) != share) continue;
      const std::uint32_t kept = operations_.collapse(h, kLeastCollapsedShape);
      if (kept != kNone) mesh_.visit_spokes(kept, offer);
    }
  }

  // The longest first. What a split makes is looked at in the next round.
  void split_long_edges() {
    std::vector<Entry> found;
    mesh_.visit_edges([&](HalfEdge h) {
      const double share = operations_.share(h);
      if (share > kLongestShare) found.emplace_back(-share, mesh_.from(h), mesh_.to(h));
    });
    std::ranges::sort(found);
    for (const auto& [share, u, w] : found) {
      counter_.count();
      const HalfEdge h = mesh_.find(u, w);
      if (h != kNone) operations_.split(h);
    }
  }

  void flip_all() {
    mesh_.visit_edges([&](HalfEdge h) {
      counter_.count();
      operations_.flip(h);
    });
  }

  void smooth_all() {
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v) {
      counter_.count();
      if (mesh_.is_vertex(v)) operations_.smooth(v, kGoodShape, kAllTheWay);
    }
  }

  // The worst triangles first: a flip, moves of the vertices, a collapse near by, until one helps.
  void mend_worst() {
    std::vector<std::pair<double, std::uint32_t>> found;
    for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
      if (!mesh_.is_triangle(t)) continue;
      const double shape = operations_.shape(t);
      if (shape < kGoodShape) found.emplace_back(shape, t);
    }
    std::ranges::sort(found);
    for (const auto& [shape, t] : found) {
      counter_.count();
      if (mesh_.is_triangle(t) && operations_.shape(t) < kGoodShape) mend(t);
    }
  }

  void mend(std::uint32_t t) {
    for (HalfEdge h = 3 * t; h < 3 * t + 3; ++h) {
      if (operations_.flip(h)) return;
    }
    for (const double step : kSteps) {
      for (const std::uint32_t v : mesh_.triangle(t)) operations_.smooth(v, kOnlyIfBetter, step);
      if (operations_.shape(t) >= kGoodShape) return;
    }
    std::vector<HalfEdge> spokes;
    for (const std::uint32_t v : mesh_.triangle(t)) {
      mesh_.visit_spokes(v, [&](HalfEdge h) { spokes.push_back(h); });
    }
    for (const HalfEdge h : spokes) {
      if (operations_.collapse(h, kOnlyIfBetter) != kNone) return;
    }
  }

  MeshOperations& operations_;
  const DynamicMesh& mesh_;
  OperationCounter counter_;
  Monitor* monitor_;
};

VertexTable vertex_table(const PatchedMesh& surface, const DynamicMesh& mesh,
                         const FeatureGraph& features, double edge_length) {
  VertexTable table;
  const std::size_t count = surface.mesh.vertex_count();
  table.position.assign(surface.mesh.positions.begin(), surface.mesh.positions.end());
  table.edge_length = edge_lengths(surface, mesh, features, edge_length);
  table.hold = features.hold;
  table.patch.resize(count);  // at a feature, any of its patches
  for (std::size_t t = 0; t < surface.mesh.triangle_count(); ++t) {
    for (const std::uint32_t v : surface.mesh.triangles[t]) {
      table.patch[v] = surface.triangle_patch[t];
    }
  }
  table.normal.resize(count);
  for (std::size_t v = 0; v < count; ++v) {
    table.normal[v] = table.hold[v] == VertexHold::none
                          ? patch_normal(surface.patches[table.patch[v]], table.position[v])
                          : cast<double>(surface.mesh.normals[v]);
  }
  return table;
}

SphereId nearest_atom(const SurfacePatch& patch, const SphereSet& atoms, const Vec3d& at) {
  const auto height = [&](SphereId id) {
    return id == kNoSphere ? std::numeric_limits<double>::infinity()
                           : norm(at - atoms[id].center) - atoms[id].radius;
  };
  return *std::ranges::min_element(patch.atoms, {}, height);
}

void place_vertices(const VertexTable& table, const DynamicMesh& mesh, const SphereSet& atoms,
                    std::vector<std::uint32_t>& numbers, RemeshedSurface& out) {
  numbers.assign(mesh.vertex_count(), kNone);
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (!mesh.is_vertex(v)) continue;
    numbers[v] = static_cast<std::uint32_t>(out.mesh.vertex_count());
    out.mesh.positions.push_back(table.position[v]);
    out.mesh.normals.push_back(cast<float>(table.normal[v]));
    const std::uint32_t patch = table.patch[v];
    out.mesh.vertex_spheres.push_back(
        on_sphere(nearest_atom(out.patches[patch], atoms, table.position[v])));
    out.vertex_patch.push_back(patch);
  }
}

// Triangles with their patches, and the counts of those with small angles.
void place_triangles(const MeshOperations& operations, const FootOracle& oracle,
                     const std::vector<std::uint32_t>& numbers, RemeshedSurface& out) {
  const DynamicMesh& mesh = operations.mesh();
  const VertexTable& table = operations.vertices();
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (!mesh.is_triangle(t)) continue;
    const Triangle v = mesh.triangle(t);
    const Vec3d &a = table.position[v[0]], &b = table.position[v[1]], &c = table.position[v[2]];
    const Vec3d normal = cross(b - a, c - a);
    const auto foot = oracle.nearest((1.0 / 3) * (a + b + c), &normal);
    out.mesh.triangles.push_back({numbers[v[0]], numbers[v[1]], numbers[v[2]]});
    out.triangle_patch.push_back(foot ? foot->patch : table.patch[v[0]]);
    if (shape_of(a, b, c) >= kShapeOf20Degrees) continue;
    ++out.stats.below_20_degrees;
    out.stats.below_20_at_features +=
        std::ranges::any_of(v, [&](std::uint32_t i) { return table.hold[i] != VertexHold::none; });
  }
}

// Boxes around triangles that cross, grown by two edge lengths.
void add_zones(const IndexedMesh& mesh, const TrianglePairs& pairs, double edge_length,
               std::vector<Box>& zones) {
  const Vec3d margin = 2 * edge_length * Vec3d{1, 1, 1};
  for (const auto& [first, second] : pairs) {
    Box box = empty_box();
    for (const std::uint32_t t : {first, second}) {
      for (const std::uint32_t v : mesh.triangles[t]) include(box, mesh.positions[v]);
    }
    zones.push_back({box.lower - margin, box.upper + margin});
  }
}

Box box_around(const IndexedMesh& mesh) {
  Box box = empty_box();
  for (const Vec3d& p : mesh.positions) include(box, p);
  return box;
}

class Remesher {
 public:
  Remesher(const SphereSet& atoms, const RemeshOptions& options)
      : atoms_(atoms), options_(options) {}

  RemeshedSurface run() {
    const RemeshClock::time_point begin = RemeshClock::now();
    const double length = options_.edge_length;
    const ExcludedMesh exact = exact_mesh(std::min(kExactShare * length, kLongestExact));
    const double exact_seconds = elapsed_since(begin);
    check_memory(exact.mesh);
    begin_stage(options_.monitor, "find features", 1);
    double radius = options_.probe;
    for (const Sphere& atom : atoms_.spheres()) radius = std::min(radius, atom.radius);
    farthest_ =
        std::min(kFarther * length * length / (6 * std::max(radius, kLeastRadius)), kFarthest);
    const FootOracle oracle(exact, atoms_, options_.probe, std::max(kLeastReach, farthest_));
    DynamicMesh mesh(exact.mesh);
    const FeatureGraph features(exact, mesh);
    const VertexTable table = vertex_table(exact, mesh, features, length);
    RemeshedSurface out = without_crossings(exact, mesh, features, table, oracle);
    out.stats.exact_triangles = exact.mesh.triangle_count();
    out.stats.crease_edges = features.crease_edges, out.stats.corners = features.corners;
    out.stats.edge_length = length;
    out.stats.exact_seconds = exact_seconds, out.stats.seconds = elapsed_since(begin);
    return out;
  }

 private:
  ExcludedMesh exact_mesh(double edge_length) const {
    for (int tries = 1;; ++tries, edge_length /= 2) {
      try {
        return mesh_excluded(atoms_, {.probe = options_.probe,
                                      .edge_length = edge_length,
                                      .exterior = options_.exterior,
                                      .memory_limit = options_.memory_limit,
                                      .monitor = options_.monitor});
      } catch (const CurvesTooClose&) {
        if (tries == kMostExactTries) throw;
      }
    }
  }

  void check_memory(const IndexedMesh& exact) const {
    const std::uint64_t need =
        indexed_mesh_bytes(exact) + kBytesPerTriangle * exact.triangle_count();
    if (need <= options_.memory_limit) return;
    throw LimitExceeded(
        fmt::format("remeshing {} triangles needs {} bytes, {} are allowed: choose a higher memory "
                    "limit",
                    exact.triangle_count(), need, options_.memory_limit));
  }

  RemeshedSurface without_crossings(const PatchedMesh& exact, const DynamicMesh& mesh,
                                    const FeatureGraph& features, const VertexTable& table,
                                    const FootOracle& oracle) {
    std::vector<Box> zones;
    for (int run = 1; run <= kMostRuns; ++run) {
      MeshOperations operations(mesh, table, features.circles, oracle, zones, options_.edge_length,
                                farthest_);
      Schedule(operations, options_.monitor).run();
      RemeshedSurface out = finished(exact, operations, oracle);
      const TrianglePairs pairs = intersecting_pairs(out.mesh, options_.monitor, MeshEdges::paired);
      out.stats.runs = run;
      if (pairs.empty()) return out;
      add_zones(out.mesh, pairs, options_.edge_length, zones);
      if (run >= kRunsWithZones) zones = {box_around(exact.mesh)};
    }
    throw LimitExceeded(fmt::format(
        "the excluded surface has no mesh of edges of {} Å: triangles of the mesh along "
        "its curves cross; choose another edge length",
        options_.edge_length));
  }

  RemeshedSurface finished(const PatchedMesh& exact, const MeshOperations& operations,
                           const FootOracle& oracle) const {
    RemeshedSurface out;
    out.patches = exact.patches;
    std::vector<std::uint32_t> numbers;
    place_vertices(operations.vertices(), operations.mesh(), atoms_, numbers, out);
    place_triangles(operations, oracle, numbers, out);
    out.stats.joined = operations.joined();
    return out;
  }

  const SphereSet& atoms_;
  const RemeshOptions& options_;
  double farthest_ = 0;  // Å
};

}  // namespace

double edge_length_of_density(double triangles_per_area) {
  return std::sqrt(4 / (std::sqrt(3.0) * triangles_per_area));
}

RemeshedSurface remesh_excluded(const SphereSet& atoms, const RemeshOptions& options) {
  if (!(options.edge_length > 0) || !std::isfinite(options.edge_length)) {
    throw InvalidInput(
        fmt::format("the edge length must be positive and finite, not {} Å", options.edge_length));
  }
  return Remesher(atoms, options).run();
}

}  // namespace vdwmesh
