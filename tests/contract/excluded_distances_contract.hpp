// What tests of distances to the solvent-excluded surface share.
#pragma once

#include <cstddef>
#include <vector>

#include "spheres/sphere_set.hpp"
#include "support/ball_families.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::testing {

// Å, of coordinates up to some 100 Å and angles that are not flat: rounding.
inline constexpr double kRounding = 1e-11;
// Å: bounds of the oracle are so far apart, and may be off by its own slack of 1e-10 besides.
inline constexpr double kBounds = 2e-3, kSlack = 1e-8;

// Points of all depths in and around a set.
inline std::vector<Vec3d> places_around(const SphereSet& atoms, double reach, Dice& dice,
                                        int count) {
  std::vector<Vec3d> places;
  for (int i = 0; i < count; ++i) {
    const Sphere& s =
        atoms[static_cast<std::size_t>(dice.whole(0, static_cast<int>(atoms.size()) - 1))];
    places.push_back(s.center + dice.real(0, s.radius + reach) * random_direction(dice));
  }
  return places;
}

// A small triangle far from the surface, whose distance from a point is nearly the distance from
// its middle.
inline IndexedMesh speck_at(const Vec3d& at) {
  IndexedMesh mesh;
  mesh.positions.resize(3);
  mesh.positions[0] = at;
  mesh.positions[1] = at + Vec3d{1e-3, 0, 0};
  mesh.positions[2] = at + Vec3d{0, 1e-3, 0};
  mesh.triangles.resize(1);
  mesh.triangles[0] = {0, 1, 2};
  return mesh;
}

}  // namespace vdwmesh::testing
