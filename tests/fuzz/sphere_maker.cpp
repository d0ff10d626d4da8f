#include "fuzz/sphere_maker.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

namespace vdwmesh::fuzz {
namespace {

constexpr double kReach = 4;      // Å, of free centres
constexpr double kLattice = 0.5;  // Å

// Unit vectors of which some are exact in binary and some are not.
constexpr std::array<Vec3d, 6> kDirections{{{1, 0, 0},
                                            {0, -1, 0},
                                            {0, 0, 1},
                                            {0.6, 0.8, 0},
                                            {2.0 / 3, 2.0 / 3, 1.0 / 3},
                                            {-2.0 / 7, 3.0 / 7, 6.0 / 7}}};

Sphere free_sphere(ByteSource& bytes) {
  const auto place = [&] { return bytes.real(-kReach, kReach); };
  const double x = place(), y = place(), z = place();
  return {{x, y, z}, bytes.real(0.1, 2.5) + 1e-3};
}

Sphere lattice_sphere(ByteSource& bytes) {
  const auto place = [&] { return kLattice * bytes.whole(-6, 6); };
  const double x = place(), y = place(), z = place();
  return {{x, y, z}, kLattice * bytes.whole(1, 5)};
}

// In the same place, with the same or another radius, or moved by next to nothing.
Sphere twin(ByteSource& bytes, const Sphere& of) {
  Sphere s = of;
  const int kind = bytes.whole(0, 2);
  if (kind == 1) s.radius = kLattice * bytes.whole(1, 5);
  if (kind == 2) s.center[bytes.whole(0, 2)] += std::ldexp(1.0, -bytes.whole(10, 56));
  return s;
}

Sphere touching(ByteSource& bytes, const Sphere& of) {
  const double radius = kLattice * bytes.whole(1, 5);
  const double distance = bytes.one_in(2) ? of.radius - radius : of.radius + radius;
  const Vec3d& direction = kDirections[static_cast<std::size_t>(bytes.whole(0, 5))];
  return {of.center + distance * direction, radius};
}

Sphere of_another_size(ByteSource& bytes, const Sphere& of) {
  const double radius = std::ldexp(1.0, bytes.whole(-14, 8));
  const Vec3d& direction = kDirections[static_cast<std::size_t>(bytes.whole(0, 5))];
  return {of.center + (radius > of.radius ? radius : of.radius) * direction, radius};
}

Sphere next_sphere(ByteSource& bytes, const std::vector<Sphere>& others) {
  const int kind = bytes.whole(0, others.empty() ? 1 : 7);
  if (kind == 0) return free_sphere(bytes);
  if (kind < 4) return lattice_sphere(bytes);
  const auto last = static_cast<int>(others.size()) - 1;
  const Sphere& other = others[static_cast<std::size_t>(bytes.whole(0, last))];
  if (kind == 4) return twin(bytes, other);
  if (kind < 7) return touching(bytes, other);
  return of_another_size(bytes, other);
}

void print(const std::vector<Sphere>& spheres) {
  for (const Sphere& s : spheres) {
    std::fprintf(stderr, "%.17g %.17g %.17g %.17g\n", s.center.x, s.center.y, s.center.z, s.radius);
  }
}

}  // namespace

SphereSet make_spheres(ByteSource& bytes, int most) {
  std::vector<Sphere> spheres;
  do {
    spheres.push_back(next_sphere(bytes, spheres));
  } while (!bytes.empty() && static_cast<int>(spheres.size()) < most);
  if (std::getenv("FUZZ_PRINT") != nullptr) print(spheres);
  return SphereSet(std::move(spheres));
}

}  // namespace vdwmesh::fuzz
