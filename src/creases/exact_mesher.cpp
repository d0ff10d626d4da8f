// The outer loop of the crease-exact mesher: it chooses feature sizes and checks the topology.
// Feature sizes are thresholds: arcs and circles up to these sizes are reduced to points.
//
// 1. arrange() takes the arcs and corners of the boundary and the areas of the patches from the
//    regular triangulation.
// 2. FeatureSizeSearch tries several sets of feature sizes. For each set, boundary_arcs() places
//    arcs and corners in space, and mesh_boundary() meshes the patches between them (see mesher/).
// 3. If features were reduced to points, compare() holds the Euler characteristic and the number of
//    closed surfaces of the mesh against those of the dual complex.
// The first mesh of the right topology is the result. If there is none, it is the first mesh made.
// Several processes first try with an arrangement of parts (mesh_in_parts()).
#include "creases/exact_mesher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "complex/dual_complex.hpp"
#include "core/disjoint_sets.hpp"
#include "core/errors.hpp"
#include "creases/arcs/arrangement.hpp"
#include "creases/arcs/part_arrangement.hpp"
#include "creases/share/mesh_team.hpp"
#include "creases/share/patch_device.hpp"
#include "creases/share/split_fans.hpp"
#include "creases/union_mesher.hpp"
#include "measures/measures.hpp"
#include "measures/topology.hpp"

namespace vdwmesh {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// The sets of feature sizes. FeatureSizes holds the length of an arc and the radius of a circle, as
// fractions of a ball's radius.
// - kUsual is tried first. It gives the right topology if no feature is smaller than its sizes.
// - kFiner is tried next if kUsual gave a mesh, but of another topology, because features became
//   points. It keeps features that double coordinates can still distinguish: in a circle of radius
//   c = 1e-7, in units of the balls' radius, each sphere rises c² / 2 = 5e-15 above the circle's
//   plane, which is some tens of roundings.
// - kCoarser are tried next instead, in this order, if kUsual gave no mesh, because curves were too
//   close. They merge curves where they are close.
constexpr FeatureSizes kUsual{};
constexpr FeatureSizes kFiner{1e-11, 1e-7};
constexpr std::array<FeatureSizes, 3> kCoarser{{{1e-7, 1e-6}, {1e-6, 1e-5}, {1e-5, 1e-4}}};

// The exact topology of the boundary, on which each point of contact counts twice, because the mesh
// has a vertex on either ball there. Two balls that only touch are separate components here.
SurfaceTopology surface_topology(const PlacedBalls& balls, const ExactMeshOptions& options) {
  const PowerTriangulation t = triangulate_for_mesh(balls, options.monitor, options.memory_limit);
  const DualComplex complex = dual_complex(t, options.monitor);
  const UnionTopology topology = union_topology(t, complex, inclusion_exclusion(t, complex));
  DisjointSets components(complex.in_complex.size());
  for (const DualEdge& e : complex.edges) {
    const bool contact = e.singular && e.contact == Contact::touching;
    if (!contact) components.join(e.vertices[0], e.vertices[1]);
  }
  std::int64_t shells = static_cast<std::int64_t>(topology.voids);
  // A component counts if it has exposed area. A ball that is hidden except for a point of
  // contact has no surface to mesh.
  std::vector<std::uint8_t> counted(complex.exposed.size(), 0);
  for (std::uint32_t v = 0; v < counted.size(); ++v) {
    std::uint8_t& of_component = counted[components.find(v)];
    shells += complex.exposed[v] && !of_component;
    of_component = of_component || complex.exposed[v];
  }
  return {topology.euler_characteristic + 2 * static_cast<std::int64_t>(topology.point_contacts),
          shells};
}

// What depends on the feature sizes in a boundary. Two sets of sizes with equal BoundaryFeatures
// give the same curves.
struct BoundaryFeatures {
  std::vector<std::array<std::uint32_t, 4>> arcs;  // two balls, two corners (see BoundaryArc)
  std::uint64_t corners, points, contacts, joins;
  bool operator==(const BoundaryFeatures&) const = default;
};

BoundaryFeatures features_of(const BoundaryArcs& boundary) {
  BoundaryFeatures features{
      {}, boundary.corners.size(), boundary.points, boundary.contacts, boundary.joins};
  for (const BoundaryArc& a : boundary.arcs) {
    features.arcs.push_back({a.balls[0], a.balls[1], a.ends[0], a.ends[1]});
  }
  return features;
}

// Meshes an arrangement with one set of feature sizes after the other, until a mesh has the
// topology of the union. If none has, the first mesh that could be made is the result.
class FeatureSizeSearch {
 public:
  FeatureSizeSearch(const Arrangement& arrangement, const ExactMeshOptions& options,
                    PatchDevice* device, MeshTeam& team)
      : arrangement_(arrangement), options_(options), device_(device), team_(team) {}

  // The mesh is the one that the team has kept. Throws LimitExceeded if no set of sizes led to one.
  ExactMeshStats run() && {
    if (try_sizes(kUsual)) return *best_;
    if (best_) {
      try_sizes(kFiner);
    } else {
      for (const FeatureSizes& sizes : kCoarser) {
        if (try_sizes(sizes)) break;
      }
    }
    // Together, so that all members know that all of them fail.
    team_.together([&] {
      if (!best_) throw LimitExceeded(refusal_);
    });
    return *best_;
  }

 private:
  // Returns whether these sizes gave a mesh with the topology of the union.
  bool try_sizes(const FeatureSizes& sizes) {
    BoundaryArcs boundary;
    team_.together([&] { boundary = place(sizes); });
    // The mesher refused the same curves in the last attempt, and would refuse them again.
    if (is_refused(boundary)) return false;
    try {
      ExactMeshStats stats = mesh_boundary(arrangement_, std::move(boundary),
                                           options_with_memory_left(), device_, team_);
      compare(stats);
      const bool right = stats.euler_difference == 0 && stats.shell_difference == 0;
      if (right || !best_) {
        best_ = stats;
        team_.keep();
      }
      return right;
    } catch (const CurvesTooClose& error) {
      if (refusal_.empty()) refusal_ = error.what();
      // Placed once more, since the mesher took them.
      team_.together([&] { refused_ = features_of(place(sizes)); });
      return false;
    }
    // Other limits end the search, though there may be a mesh by then: with more memory the result
    // could be another one.
  }

  BoundaryArcs place(const FeatureSizes& sizes) const {
    return boundary_arcs(arrangement_.balls, arrangement_.boundary, sizes, options_.monitor);
  }

  bool is_refused(const BoundaryArcs& boundary) const {
    return refused_ && features_of(boundary) == *refused_;
  }

  // The options, with the memory limit reduced by the bytes of the mesh that is kept so far.
  ExactMeshOptions options_with_memory_left() const {
    ExactMeshOptions options = options_;
    if (best_ && options.memory_limit != kNoMemoryLimit) {
      options.memory_limit -= std::min(options.memory_limit, team_.kept_bytes());
    }
    return options;
  }

  // Fills the differences of topology in the stats; they are 0 at first and stay 0 if no feature
  // became a point. Then the topology is right, because the arcs and corners of the complex are
  // exact.
  void compare(ExactMeshStats& stats) {
    if (stats.points + stats.contacts + stats.joins == 0) return;
    if (!exact_) {
      team_.together([&] { exact_ = surface_topology(arrangement_.balls, options_); });
    }
    const SurfaceTopology found = team_.topology();
    stats.euler_difference = found.euler_characteristic - exact_->euler_characteristic;
    stats.shell_difference = found.shells - exact_->shells;
  }

  const Arrangement& arrangement_;
  const ExactMeshOptions& options_;
  PatchDevice* device_;
  MeshTeam& team_;
  std::optional<ExactMeshStats> best_;       // of the first mesh, or the one of the right topology
  std::optional<SurfaceTopology> exact_;     // computed when it is first needed
  std::optional<BoundaryFeatures> refused_;  // curves that the mesher refused last
  std::string refusal_;                      // message of the first refusal, for the caller
};

void check_edge_length(double length) {
  if (length > 0 && std::isfinite(length)) return;
  throw InvalidInput(fmt::format("the edge length must be positive and finite, not {} Å", length));
}

void check(const MeshTeam& team, const SphereSet& spheres, const ExactMeshOptions& options) {
  if (spheres.empty()) throw InvalidInput("an empty set of spheres has no surface");
  if (options.edge_lengths.empty()) check_edge_length(options.edge_length);
  if (!options.edge_lengths.empty() && options.edge_lengths.size() != spheres.size()) {
    throw InvalidInput(fmt::format("there are {} edge lengths for {} spheres",
                                   options.edge_lengths.size(), spheres.size()));
  }
  for (const double length : options.edge_lengths) check_edge_length(length);
  if (!(options.min_angle >= 0 && options.min_angle <= kLargestMinAngle)) {
    throw InvalidInput(fmt::format("the least angle must be from 0 to {} degrees, not {}",
                                   kLargestMinAngle, options.min_angle));
  }
  if (options.min_angle > 0 && team.count() > 1) {
    throw InvalidInput("several processes do not bound the angles: leave out the least angle");
  }
}

// A process that makes the whole mesh.
class OneProcess final : public MeshTeam {
 public:
  std::size_t count() const override { return 1; }
  std::size_t number() const override { return 0; }
  void together(const std::function<void()>& work) const override { work(); }
  void merge(std::vector<PieceSplit>&) const override {}
  std::uint32_t least(std::uint32_t mine) const override { return mine; }
  std::uint64_t sum(std::uint64_t mine) const override { return mine; }
  std::uint64_t sum_before(std::uint64_t) const override { return 0; }
  std::vector<std::vector<std::uint64_t>> exchange(
      const std::vector<std::vector<std::uint64_t>>& to_each) const override {
    return to_each;
  }
  void take(UnnumberedPiece&& piece, std::uint64_t joined_corners) override {
    taken_ = std::move(piece.mesh);
    if (joined_corners > 0) split_fans(joined_corners, taken_);
  }
  SurfaceTopology topology() override { return surface_topology(taken_); }
  void keep() override { kept_ = std::move(taken_); }
  std::uint64_t kept_bytes() const override { return indexed_mesh_bytes(kept_); }

  IndexedMesh result() && { return std::move(kept_); }

 private:
  IndexedMesh taken_, kept_;
};

// Meshes a set of which each process arranges its part. Returns nothing, in all of them, if
// features had to be reduced to points or curves are too close: corners that were joined and other
// feature sizes concern the whole set. So do balls of no ordinary size (ArrangedPart::is_ordinary).
// It also returns nothing if a part does not fit the memory: parts are cut by an estimate of their
// triangles, and shares of a whole arrangement by the areas of the patches.
std::optional<ExactMeshStats> mesh_in_parts(MeshTeam& team, const SphereSet& spheres,
                                            const ExactMeshOptions& options) {
  const Clock::time_point begin = Clock::now();
  std::optional<ArrangedPart> part;
  team.together([&] { part = arrange_part(spheres, team.number(), team.count(), options); });
  const BoundaryArcs& boundary = part->boundary;
  const bool concerns_whole =
      boundary.points + boundary.contacts + boundary.joins > 0 || !part->is_ordinary;
  if (team.sum(std::uint64_t{concerns_whole}) > 0) return std::nullopt;
  const double arrangement_seconds = seconds_since(begin);
  try {
    ExactMeshStats stats = mesh_boundary(part->arrangement, std::move(part->boundary), options,
                                         nullptr, team, &part->part);
    team.keep();
    stats.triangulated_balls = spheres.size();
    stats.arrangement_seconds = arrangement_seconds;
    stats.seconds = seconds_since(begin);
    return stats;
  } catch (const LimitExceeded&) {  // and CurvesTooClose, which is one
    return std::nullopt;
  }
}

class CpuExactMesher final : public ExactMesher {
 public:
  ExactMesh mesh(const SphereSet& spheres, const ExactMeshOptions& options) const override {
    return mesh_union(spheres, options);
  }
};

}  // namespace

// A closed triangle mesh has E = 3 F / 2 edges, so its Euler characteristic is V - F / 2.
SurfaceTopology surface_topology(const IndexedMesh& mesh) {
  DisjointSets shells(mesh.vertex_count());
  for (const Triangle& t : mesh.triangles) {
    shells.join(t[0], t[1]);
    shells.join(t[0], t[2]);
  }
  return {static_cast<std::int64_t>(mesh.vertex_count()) -
              static_cast<std::int64_t>(mesh.triangle_count() / 2),
          static_cast<std::int64_t>(shells.count())};
}

std::unique_ptr<ExactMesher> make_cpu_exact_mesher() { return std::make_unique<CpuExactMesher>(); }

ExactMesh mesh_union(const SphereSet& spheres, const ExactMeshOptions& options) {
  return mesh_union_with(nullptr, spheres, options);
}

ExactMesh mesh_union_with(PatchDevice* device, const SphereSet& spheres,
                          const ExactMeshOptions& options) {
  OneProcess team;
  const bool is_left_to_host = device && options.min_angle > 0;
  const ExactMeshStats stats =
      mesh_union_by(team, is_left_to_host ? nullptr : device, spheres, options);
  return {std::move(team).result(), stats,
          is_left_to_host ? "the CPU made the mesh: devices do not bound its angles" : ""};
}

ExactMeshStats mesh_union_by(MeshTeam& team, PatchDevice* device, const SphereSet& spheres,
                             const ExactMeshOptions& options) {
  const Clock::time_point begin = Clock::now();
  team.together([&] { check(team, spheres, options); });
  if (team.count() > 1) {
    if (const auto stats = mesh_in_parts(team, spheres, options)) return *stats;
  }
  std::optional<Arrangement> arrangement;
  team.together([&] { arrangement = arrange(spheres, options.monitor, options.memory_limit); });
  const double arrangement_seconds = seconds_since(begin);
  ExactMeshStats stats = FeatureSizeSearch(*arrangement, options, device, team).run();
  stats.triangulated_balls = spheres.size();
  stats.arrangement_seconds = arrangement_seconds;
  stats.seconds = seconds_since(begin);
  return stats;
}

}  // namespace vdwmesh
