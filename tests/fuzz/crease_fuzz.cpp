// The crease-exact mesh of any balls.
#include <algorithm>
#include <cstdio>

#include "creases/exact_mesher.hpp"
#include "fuzz/mesh_promises.hpp"
#include "fuzz/sphere_maker.hpp"
#include "measures/exact_union.hpp"
#include "support/crease_survey.hpp"
#include "support/crease_tolerance.hpp"
#include "support/union_verdict.hpp"

namespace vdwmesh::fuzz {
namespace {

constexpr int kMostSpheres = 12;
constexpr std::uint64_t kMemory = std::uint64_t{4} << 20;  // bytes, so that inputs stay small

double largest_radius(const SphereSet& spheres) {
  double largest = 0;
  for (const Sphere& s : spheres.spheres()) largest = std::max(largest, s.radius);
  return largest;
}

// Labels, orientation and places, triangle by triangle; and the topology of the union of the balls,
// or another by as much as the mesher says.
void check_geometry(const SphereSet& spheres, const ExactMesh& made) {
  const testing::CreaseSurvey survey = testing::survey_creases(spheres, made.mesh);
  if (!survey.sound()) std::fprintf(stderr, "%s\n", survey.text().c_str());
  require(survey.sound(), "triangles face outwards, and labels are those of the triangles around");
  const double allowed = testing::allowed_distance(spheres, made.stats);
  require(survey.off_sphere <= allowed, "vertices lie on their spheres");
  require(survey.depth <= allowed, "no vertex lies inside a ball");
  const UnionTopology exact = *exact_union(spheres).topology;
  const testing::TopologyDifference difference =
      testing::topology_difference(spheres, survey.facts, exact);
  require(difference.euler_characteristic == made.stats.euler_difference,
          "the Euler characteristic is that of the union, or differs as announced");
  // Which balls are apart beside points of contact is a question of exact arithmetic, which this
  // check has not.
  if (exact.point_contacts > 0) return;
  require(difference.components + difference.voids == made.stats.shell_difference,
          "the shells are those of the union, or differ as announced");
}

}  // namespace

void run_input(const std::uint8_t* data, std::size_t size) {
  ByteSource bytes(data, size);
  const double share = bytes.real(0.3, 1.2);
  const SphereSet spheres = make_spheres(bytes, kMostSpheres);
  ExactMeshOptions options;
  options.edge_length = share * largest_radius(spheres);
  options.memory_limit = kMemory;
  allow_refusal([&] {
    const ExactMesh made = mesh_union(spheres, options);
    check_mesh(made.mesh, spheres.size());
    check_geometry(spheres, made);
  });
}

}  // namespace vdwmesh::fuzz
