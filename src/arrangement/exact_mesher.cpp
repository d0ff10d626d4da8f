#include "arrangement/exact_mesher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "arrangement/complex/measures.hpp"
#include "arrangement/complex/topology.hpp"
#include "arrangement/mesher/union_mesher.hpp"
#include "core/disjoint_sets.hpp"
#include "core/errors.hpp"

namespace vdwmesh {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// The sizes of features that are tried in turn. The first are right wherever nothing is smaller. If
// features were reduced to points and the topology changed, finer ones keep what coordinates can
// still tell apart; if curves lie too close, coarser ones merge the places where they do.
constexpr FeatureSizes kUsual{};
constexpr FeatureSizes kFiner{1e-11, 1e-9};
constexpr std::array<FeatureSizes, 3> kCoarser{{{1e-7, 1e-6}, {1e-6, 1e-5}, {1e-5, 1e-4}}};

Arrangement arrange(const SphereSet& spheres, Monitor* monitor) {
  Arrangement a{triangulate(spheres, monitor), {}, {}};
  a.complex = dual_complex(a.triangulation);
  a.measures = gauss_bonnet(a.triangulation, a.complex);
  return a;
}

// The Euler characteristic of a closed surface and the number of its pieces.
struct Shape {
  std::int64_t euler_characteristic, shells;
};

Shape shape_of(const IndexedMesh& mesh) {
  DisjointSets shells(mesh.vertex_count());
  for (const Triangle& t : mesh.triangles) {
    shells.join(t[0], t[1]);
    shells.join(t[0], t[2]);
  }
  return {static_cast<std::int64_t>(mesh.vertex_count()) -
              static_cast<std::int64_t>(mesh.triangle_count() / 2),
          static_cast<std::int64_t>(shells.count())};
}

// Of a surface around the union on which each point of contact is doubled.
Shape shape_of(const Arrangement& a) {
  const UnionTopology topology = union_topology(a.triangulation, a.complex, a.measures);
  DisjointSets components(a.complex.in_complex.size());
  for (const DualEdge& e : a.complex.edges) {
    const bool contact = e.singular && e.contact == Contact::touching;
    if (!contact) components.join(e.vertices[0], e.vertices[1]);
  }
  std::int64_t shells = static_cast<std::int64_t>(topology.voids);
  // Balls that are hidden but for a point of contact are no surface.
  std::vector<std::uint8_t> counted(a.complex.exposed.size(), 0);
  for (std::uint32_t v = 0; v < counted.size(); ++v) {
    std::uint8_t& of_component = counted[components.find(v)];
    shells += a.complex.exposed[v] && !of_component;
    of_component = of_component || a.complex.exposed[v];
  }
  return {topology.euler_characteristic + 2 * static_cast<std::int64_t>(topology.point_contacts),
          shells};
}

// What of a boundary depends on the sizes of its features: with other sizes that leave these as
// they are, its curves lie where they lay.
struct BoundaryFeatures {
  std::vector<std::array<std::uint32_t, 4>> arcs;  // balls and ends
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

// Meshes an arrangement with one choice of feature sizes after the other, and keeps the first mesh
// until there is one of the union's topology.
class Chooser {
 public:
  Chooser(const Arrangement& arrangement, const ExactMeshOptions& options)
      : arrangement_(arrangement), options_(options) {}

  ExactMesh run() && {
    if (try_sizes(kUsual)) return std::move(*best_);
    if (best_) {
      try_sizes(kFiner);
    } else {
      for (const FeatureSizes& sizes : kCoarser) {
        if (try_sizes(sizes)) break;
      }
    }
    if (!best_) throw LimitExceeded(refusal_);
    return std::move(*best_);
  }

 private:
  // Whether that gave a mesh of the union's topology.
  bool try_sizes(const FeatureSizes& sizes) {
    BoundaryArcs boundary = boundary_arcs(arrangement_.triangulation, arrangement_.complex, sizes);
    BoundaryFeatures features = features_of(boundary);
    if (features == refused_) return false;
    try {
      ExactMesh mesh = mesh_boundary(arrangement_, std::move(boundary), options_beside_best());
      compare(mesh);
      const bool right = mesh.stats.euler_difference == 0 && mesh.stats.shell_difference == 0;
      if (right || !best_) best_ = std::move(mesh);
      return right;
    } catch (const CurvesTooClose& error) {
      if (refusal_.empty()) refusal_ = error.what();
      refused_ = std::move(features);
      return false;
    } catch (const LimitExceeded&) {
      if (!best_) throw;
      return false;  // the mesh there is is given, which says how it differs
    }
  }

  // A mesh that is kept takes its part of the memory.
  ExactMeshOptions options_beside_best() const {
    ExactMeshOptions options = options_;
    if (best_ && options.memory_limit != kNoMemoryLimit) {
      options.memory_limit -= std::min(options.memory_limit, indexed_mesh_bytes(best_->mesh));
    }
    return options;
  }

  // The arcs and corners of the complex are exact: only features made points change the topology.
  void compare(ExactMesh& mesh) {
    if (mesh.stats.points + mesh.stats.contacts + mesh.stats.joins == 0) return;
    if (!exact_) exact_ = shape_of(arrangement_);
    const Shape found = shape_of(mesh.mesh);
    mesh.stats.euler_difference = found.euler_characteristic - exact_->euler_characteristic;
    mesh.stats.shell_difference = found.shells - exact_->shells;
  }

  const Arrangement& arrangement_;
  const ExactMeshOptions& options_;
  std::optional<ExactMesh> best_;
  std::optional<Shape> exact_;
  std::optional<BoundaryFeatures> refused_;  // the last one
  std::string refusal_;
};

}  // namespace

ExactMesh mesh_union(const SphereSet& spheres, const ExactMeshOptions& options) {
  if (spheres.empty()) throw InvalidInput("an empty set of spheres has no surface");
  if (!(options.edge_length > 0) || !std::isfinite(options.edge_length)) {
    throw InvalidInput(
        fmt::format("the edge length must be positive and finite, not {} Å", options.edge_length));
  }
  const Clock::time_point begin = Clock::now();
  const Arrangement arrangement = arrange(spheres, options.monitor);
  const double arrangement_seconds = seconds_since(begin);
  ExactMesh out = Chooser(arrangement, options).run();
  out.stats.arrangement_seconds = arrangement_seconds;
  out.stats.seconds = seconds_since(begin);
  return out;
}

}  // namespace vdwmesh
