#include "support/crease_survey.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <sstream>

#include "support/reference_mesh.hpp"
#include "support/worst.hpp"

namespace vdwmesh::testing {
namespace {

double gap(const Sphere& s, const Vec3d& p) { return norm(p - s.center) - s.radius; }

// The balls by cubes as wide as the largest radius: a ball that holds a point is centred in the
// point's cube or one beside it.
class NearBalls {
 public:
  explicit NearBalls(const SphereSet& spheres) : spheres_(spheres) {
    for (const Sphere& s : spheres.spheres()) side_ = std::max(side_, 1.01 * s.radius);
    for (SphereId i = 0; i < spheres.size(); ++i) cubes_[key(spheres[i].center)].push_back(i);
  }
  double depth(const Vec3d& p) const {
    double deepest = 0;
    const Key at = key(p);
    for (int n = 0; n < 27; ++n) {
      const auto cube = cubes_.find({at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1});
      if (cube == cubes_.end()) continue;
      for (const SphereId i : cube->second) deepest = worst(deepest, -gap(spheres_[i], p));
    }
    return deepest;
  }

 private:
  using Key = std::array<std::int64_t, 3>;
  Key key(const Vec3d& p) const {
    const auto cell = [&](double x) { return static_cast<std::int64_t>(std::floor(x / side_)); };
    return {cell(p.x), cell(p.y), cell(p.z)};
  }
  const SphereSet& spheres_;
  double side_ = 0;
  std::map<Key, std::vector<SphereId>> cubes_;
};

bool holds(const VertexSpheres& label, SphereId id) {
  return std::find(label.begin(), label.end(), id) != label.end();
}

bool is_label(const VertexSpheres& label, std::size_t count) {
  if (label[0] >= count) return false;
  for (std::size_t i = 1; i < 3; ++i) {
    const bool unused = label[i] == kNoSphere;
    if (!unused && (label[i] >= count || label[i] <= label[i - 1])) return false;
  }
  return label[1] != kNoSphere || label[2] == kNoSphere;
}

// The spheres of the triangles around each vertex, sorted; four or more are cut to three.
struct Around {
  std::vector<VertexSpheres> spheres;
  std::vector<char> crowded;
};

void insert(VertexSpheres& set, char& crowded, SphereId id) {
  if (holds(set, id)) return;
  if (set[2] != kNoSphere) {
    crowded = 1;
    return;
  }
  *std::find(set.begin(), set.end(), kNoSphere) = id;
  std::sort(set.begin(), set.end());
}

Around spheres_around(const IndexedMesh& mesh) {
  Around around{std::vector<VertexSpheres>(mesh.vertex_count(), {kNoSphere, kNoSphere, kNoSphere}),
                std::vector<char>(mesh.vertex_count(), 0)};
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      insert(around.spheres[v], around.crowded[v], mesh.triangle_spheres[t]);
    }
  }
  return around;
}

void survey_vertices(const SphereSet& spheres, const IndexedMesh& mesh, const Around& around,
                     CreaseSurvey& survey) {
  const NearBalls near(spheres);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3d& p = mesh.positions[v];
    const double length = norm(cast<double>(mesh.normals[v]));
    if (!std::isfinite(p.x + p.y + p.z) || !(std::abs(length - 1) < 1e-5)) ++survey.bad_numbers;
    const VertexSpheres label = mesh.vertex_spheres[v];
    if (!is_label(label, spheres.size())) {
      ++survey.bad_labels;
      continue;
    }
    for (const SphereId id : label) {
      if (id == kNoSphere) continue;
      survey.off_sphere = worst(survey.off_sphere, std::abs(gap(spheres[id], p)));
    }
    survey.crowded_vertices += around.crowded[v] ? 1 : 0;
    if (!around.crowded[v] && label != around.spheres[v]) ++survey.strange_labels;
    survey.depth = worst(survey.depth, near.depth(p));
  }
}

void survey_triangles(const SphereSet& spheres, const IndexedMesh& mesh, CreaseSurvey& survey) {
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& v = mesh.triangles[t];
    const Sphere& s = spheres[mesh.triangle_spheres[t]];
    const Vec3d a = mesh.positions[v[0]], b = mesh.positions[v[1]], c = mesh.positions[v[2]];
    const Vec3d out = (1.0 / 3) * ((a - s.center) + (b - s.center) + (c - s.center));
    if (!(dot(cross(b - a, c - a), out) > 0)) ++survey.inward;
    for (const Vec3d& p : {a, b, c}) {
      survey.off_sphere = worst(survey.off_sphere, std::abs(gap(s, p)));
    }
  }
}

struct HalfEdge {
  std::uint32_t low, high;
  SphereId sphere;
};

void survey_arc_edges(const IndexedMesh& mesh, const Around& around, CreaseSurvey& survey) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangle_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      // Between vertices of one sphere there is no arc.
      if (around.spheres[a][1] == kNoSphere || around.spheres[b][1] == kNoSphere) continue;
      edges.push_back({std::min(a, b), std::max(a, b), mesh.triangle_spheres[t]});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::pair(a.low, a.high) < std::pair(b.low, b.high);
  });
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const HalfEdge &e = edges[i], &f = edges[i + 1];
    if (e.low != f.low || e.high != f.high || e.sphere == f.sphere) continue;
    for (const std::uint32_t v : {e.low, e.high}) {
      const VertexSpheres label = mesh.vertex_spheres[v];
      const bool named = holds(label, e.sphere) && holds(label, f.sphere);
      if (!named && !around.crowded[v]) ++survey.bad_arc_edges;
    }
  }
}

}  // namespace

bool CreaseSurvey::sound() const {
  return facts.closed_oriented_manifold() && facts.degenerate_triangles == 0 && bad_numbers == 0 &&
         inward == 0 && bad_labels == 0 && bad_arc_edges == 0;
}

std::string CreaseSurvey::text() const {
  std::ostringstream out;
  out << facts.summary() << ", bad numbers " << bad_numbers << ", inward " << inward
      << ", bad labels " << bad_labels << ", strange labels " << strange_labels << ", crowded "
      << crowded_vertices << ", bad arc edges " << bad_arc_edges << ", off spheres " << off_sphere
      << " A, depth " << depth << " A";
  return out.str();
}

CreaseSurvey survey_creases(const SphereSet& spheres, const IndexedMesh& mesh) {
  CreaseSurvey survey;
  survey.facts = reference::inspect(to_reference(mesh));
  const Around around = spheres_around(mesh);
  survey_vertices(spheres, mesh, around, survey);
  survey_triangles(spheres, mesh, survey);
  survey_arc_edges(mesh, around, survey);
  return survey;
}

std::uint64_t open_components(const SphereSet& spheres) {
  std::vector<std::size_t> group(spheres.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double reach = spheres[i].radius + spheres[j].radius;
      if (!(norm(spheres[i].center - spheres[j].center) < reach)) continue;
      const std::size_t from = group[i], to = group[j];
      std::replace(group.begin(), group.end(), from, to);
    }
  }
  std::sort(group.begin(), group.end());
  return static_cast<std::uint64_t>(std::unique(group.begin(), group.end()) - group.begin());
}

}  // namespace vdwmesh::testing
