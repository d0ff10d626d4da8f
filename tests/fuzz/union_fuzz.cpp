// The exact union of any balls, by both methods.
#include <cmath>

#include "fuzz/fuzz_target.hpp"
#include "fuzz/sphere_maker.hpp"
#include "measures/exact_union.hpp"
#include "support/gauss_bonnet.hpp"

namespace vdwmesh::fuzz {
namespace {

constexpr int kMostSpheres = 24;
// Of the total. The two formula sets share the triangulation, arcs share nothing.
constexpr double kFormulas = 1e-11, kMethods = 1e-9;

bool close(double a, double b, double tolerance) {
  if (std::abs(a - b) <= tolerance * std::abs(b)) return true;
  std::fprintf(stderr, "%.17g is not %.17g to %g\n", a, b, tolerance);
  return false;
}

void check_measures(const ExactUnion& u, const SphereMeasures& check, double tolerance) {
  require(std::isfinite(u.area) && u.area > 0, "the area is finite and positive");
  require(std::isfinite(u.volume) && u.volume > 0, "the volume is finite and positive");
  require(close(check.area, u.area, tolerance), "both ways give one area");
  require(close(check.volume, u.volume, tolerance), "both ways give one volume");
  for (const SphereMeasures& m : u.per_sphere) {
    require(m.area >= -tolerance * u.area, "no sphere has a negative area");
    require(m.volume >= -tolerance * u.volume, "no sphere has a negative volume");
  }
}

void check_topology(const ExactUnion& u, double tolerance) {
  const UnionTopology& t = *u.topology;
  const auto betti =
      static_cast<std::int64_t>(t.components + t.voids) - static_cast<std::int64_t>(t.tunnels);
  require(t.components >= 1, "a union has a component");
  require(t.euler_characteristic == 2 * betti, "Betti numbers give the Euler characteristic");
  require(t.hidden_spheres < u.per_sphere.size(), "some sphere is exposed");
  double area = 0, volume = 0;
  for (const Shell& shell : t.shells) {
    area += shell.area;
    volume += shell.volume;
  }
  require(close(area, u.area, tolerance), "the shells have the area");
  require(close(volume, u.volume, tolerance), "the shells have the volume");
}

}  // namespace

void run_input(const std::uint8_t* data, std::size_t size) {
  ByteSource bytes(data, size);
  const SphereSet spheres = make_spheres(bytes, kMostSpheres);
  const ExactUnion exact = exact_union(spheres, {UnionMethod::cgal, nullptr});
  check_measures(exact, testing::by_gauss_bonnet(spheres), kFormulas);
  check_topology(exact, kFormulas);
  const ExactUnion both = exact_union(spheres, {UnionMethod::both, nullptr});
  check_measures(both, {*both.check_area, *both.check_volume}, kMethods);
}

}  // namespace vdwmesh::fuzz
