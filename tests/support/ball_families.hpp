// Random sets of balls unlike proteins, for what searches, prunes or stops early.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {

inline Vec3d random_direction(Dice& dice) {
  for (;;) {
    const double x = dice.real(-1, 1), y = dice.real(-1, 1), z = dice.real(-1, 1);
    const double length = std::sqrt(x * x + y * y + z * z);
    if (length > 0.1 && length < 1) return {x / length, y / length, z / length};
  }
}

inline Vec3d random_point(Dice& dice, double half) {
  const double x = dice.real(-half, half), y = dice.real(-half, half), z = dice.real(-half, half);
  return {x, y, z};
}

// Most balls meet no other.
inline std::vector<Sphere> sparse_gas(Dice& dice) {
  std::vector<Sphere> balls(static_cast<std::size_t>(dice.whole(1, 60)));
  for (Sphere& s : balls) s = {random_point(dice, 15), std::exp(dice.real(-2.3, 1.6))};
  return balls;
}

// Every ball meets nearly every other; most are buried.
inline std::vector<Sphere> dense_heap(Dice& dice) {
  std::vector<Sphere> balls(static_cast<std::size_t>(dice.whole(20, 120)));
  for (Sphere& s : balls) s = {random_point(dice, 1.5), dice.real(0.8, 2)};
  return balls;
}

// Cubic or body-centred, turned, of one radius, in place or shaken.
inline std::vector<Sphere> lattice(Dice& dice) {
  const double radius = dice.real(0.45, 1.2), shake = dice.one_in(2) ? 1e-3 : 0;
  const bool centred = dice.one_in(2);
  std::vector<Sphere> balls;
  for (int i = 0; i < 64; ++i) {
    const Vec3d p{static_cast<double>(i % 4), static_cast<double>(i / 4 % 4),
                  static_cast<double>(i / 16)};
    for (const double shift : {0.0, 0.5}) {
      if (shift > 0 && !centred) continue;
      const Vec3d c = p + Vec3d{shift, shift, shift};
      const Vec3d turned{(2 * c.x - 2 * c.y + c.z) / 3, (c.x + 2 * c.y + 2 * c.z) / 3,
                         (-2 * c.x - c.y + 2 * c.z) / 3};
      balls.push_back({turned + shake * random_point(dice, 1), radius});
    }
  }
  return balls;
}

inline std::vector<Sphere> chain(Dice& dice) {
  std::vector<Sphere> balls{{{0, 0, 0}, 1}};
  for (int i = dice.whole(1, 80); i > 0; --i) {
    const double step = dice.real(0.2, 1.9);
    balls.push_back({balls.back().center + step * random_direction(dice), dice.real(0.6, 1.4)});
  }
  return balls;
}

// Hundreds of small balls on a large one.
inline std::vector<Sphere> hub(Dice& dice) {
  const double radius = dice.real(5, 100);
  std::vector<Sphere> balls{{random_point(dice, 1), radius}};
  for (int i = dice.whole(10, 300); i > 0; --i) {
    const double distance = radius + dice.real(-1, 1);
    balls.push_back({balls[0].center + distance * random_direction(dice), dice.real(0.2, 3)});
  }
  return balls;
}

// Pairs of balls kilometres (10¹³ Å) apart: coordinates are whole multiples of 2⁻⁸ Å there.
inline std::vector<Sphere> distant_pairs(Dice& dice) {
  std::vector<Sphere> balls;
  for (int i = dice.whole(1, 6); i > 0; --i) {
    const Vec3d place = random_point(dice, 1e13);
    for (int k = dice.whole(2, 5); k > 0; --k) {
      balls.push_back({place + random_point(dice, 1), dice.real(0.5, 2)});
    }
  }
  return balls;
}

// Groups of balls that all but coincide, 10⁻¹⁵ to 10⁻⁶ Å apart.
inline std::vector<Sphere> near_twins(Dice& dice) {
  std::vector<Sphere> balls;
  for (int i = dice.whole(1, 8); i > 0; --i) {
    const Sphere ball{random_point(dice, 2), dice.real(0.8, 1.6)};
    for (int k = dice.whole(1, 4); k > 0; --k) {
      const double apart = std::pow(10, dice.real(-15, -6));
      balls.push_back({ball.center + apart * random_direction(dice), ball.radius});
    }
  }
  return balls;
}

struct BallFamily {
  const char* name;
  std::function<std::vector<Sphere>(Dice&)> make;
};

inline const BallFamily kBallFamilies[] = {{"sparse gas", sparse_gas},
                                           {"dense heap", dense_heap},
                                           {"lattice", lattice},
                                           {"chain", chain},
                                           {"hub", hub},
                                           {"distant pairs", distant_pairs},
                                           {"near twins", near_twins}};

}  // namespace vdwmesh::testing
