#include "support/sphere_recipes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

using Balls = std::vector<Sphere>;

constexpr double kPi = std::numbers::pi;

Vec3d direction(Dice& dice) {
  const double z = dice.real(-1, 1), turn = dice.real(0, 2 * kPi), r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

// 0, or ± 10^-15 to 10^-6 of what it is added to.
double hair(Dice& dice) {
  if (dice.one_in(5)) return 0;
  return (dice.one_in(2) ? -1 : 1) * std::pow(10.0, dice.real(-15, -6));
}

// Every coordinate and every radius by a hair of one size, or not at all.
Balls shaken(Balls balls, Dice& dice) {
  const double size = std::abs(hair(dice));
  for (Sphere& s : balls) {
    for (int k = 0; k < 3; ++k) s.center[k] += size * dice.real(-1, 1);
    if (dice.one_in(2)) s.radius += size * dice.real(-1, 1) * s.radius;
  }
  return balls;
}

// `room` Å³ for each ball: 4 is denser than a protein with its hydrogens, 40 is sparse.
Balls gas(Dice& dice, double low_radius, double high_radius, double room) {
  const int count = dice.whole(5, 50);
  const double half = std::cbrt(room * count) / 2;
  Balls balls;
  for (int i = 0; i < count; ++i) {
    const double x = dice.real(-half, half), y = dice.real(-half, half);
    balls.push_back({{x, y, dice.real(-half, half)}, dice.real(low_radius, high_radius)});
  }
  return balls;
}

Balls dense(Dice& dice) { return gas(dice, 1.2, 1.9, 4); }
Balls like_a_protein(Dice& dice) { return gas(dice, 1.2, 1.9, 9); }
Balls sparse(Dice& dice) { return gas(dice, 1.0, 2.0, 40); }
Balls equal_radii(Dice& dice) { return gas(dice, 1.5, 1.5, 9); }
Balls many_sizes(Dice& dice) { return gas(dice, 0.1, 2.5, 9); }

Balls rounded(Balls balls, double step) {
  for (Sphere& s : balls) {
    for (int k = 0; k < 3; ++k) s.center[k] = step * std::round(s.center[k] / step);
    s.radius = std::max(0.05, 0.05 * std::round(20 * s.radius));
  }
  return balls;
}
Balls three_decimals(Dice& dice) { return rounded(like_a_protein(dice), 0.001); }
Balls half_steps(Dice& dice) { return rounded(like_a_protein(dice), 0.5); }

Balls one_huge_and_many_tiny(Dice& dice) {
  const double huge = dice.real(5, 20);
  Balls balls = {{{0, 0, 0}, huge}};
  for (int count = dice.whole(5, 30); count > 0; --count) {
    const Vec3d at = (huge + dice.real(-0.5, 0.5)) * direction(dice);
    balls.push_back({at, dice.real(0.3, 1.2)});
  }
  return balls;
}

Balls kilometres_apart(Dice& dice) {
  Balls balls;
  for (int groups = dice.whole(2, 4); groups > 0; --groups) {
    const Vec3d place = std::pow(10.0, dice.real(2, 6)) * direction(dice);
    for (int count = dice.whole(1, 8); count > 0; --count) {
      balls.push_back({place + dice.real(0, 3) * direction(dice), dice.real(1, 2)});
    }
  }
  return balls;
}

// On a grid of integers with few radii: duplicates, nested, tangent, collinear, co-spherical balls.
Balls integers(Dice& dice) {
  const int reach = dice.whole(1, 4), dimension = dice.whole(1, 3), largest = dice.whole(1, 6);
  Balls balls;
  for (int count = dice.whole(1, 14); count > 0; --count) {
    Sphere s{{0, 0, 0}, 0.5 * dice.whole(1, largest)};
    for (int k = 0; k < dimension; ++k) s.center[k] = dice.whole(-reach, reach);
    balls.push_back(s);
  }
  return balls;
}

// Cubic, face-centred or body-centred, with radii where two, three, four or more spheres meet.
Balls lattice(Dice& dice) {
  const int kind = dice.whole(0, 2), side = dice.whole(2, 3);
  constexpr std::array<double, 6> kRadii{0.5, 0.625, 0.70710678118654752, 0.75, 0.8660254037844386,
                                         1.0};
  const double radius = kRadii[static_cast<std::size_t>(dice.whole(0, 5))];
  Balls balls;
  for (int i = 0; i < 2 * side; ++i) {
    for (int j = 0; j < 2 * side; ++j) {
      for (int k = 0; k < 2 * side; ++k) {
        const bool simple = i % 2 == 0 && j % 2 == 0 && k % 2 == 0;
        const bool face = (i + j + k) % 2 == 0 && i < 4 && j < 4 && k < 4;
        const bool body = i % 2 == j % 2 && j % 2 == k % 2 && i < 4 && j < 4 && k < 4;
        if (!(kind == 0 ? simple : (kind == 1 ? face : body))) continue;
        balls.push_back({{0.5 * i, 0.5 * j, 0.5 * k}, radius});
      }
    }
  }
  return shaken(std::move(balls), dice);
}

// Spheres through one circle, of radius 1 about the z axis.
Balls pencil(Dice& dice) {
  Balls balls;
  const int count = dice.whole(3, 6);
  for (int i = 0; i < count; ++i) {
    const double z = dice.one_in(2) ? dice.real(-2, 2) : 0.25 * dice.whole(-6, 6);
    balls.push_back({{0, 0, z}, std::hypot(1, z)});
  }
  return shaken(std::move(balls), dice);
}

// Balls around an axis, which touch their neighbours, pass through one point of the axis, or
// overlap.
Balls ring(Dice& dice) {
  const int count = dice.whole(3, 9);
  const double chord = 2 * std::sin(kPi / count);
  const std::array<double, 3> radii{chord / 2, 1, dice.real(chord / 2, 1.2)};
  const double radius = radii[static_cast<std::size_t>(dice.whole(0, 2))];
  Balls balls;
  for (int i = 0; i < count; ++i) {
    const double turn = 2 * kPi * i / count;
    balls.push_back({{std::cos(turn), std::sin(turn), 0}, radius});
  }
  return shaken(std::move(balls), dice);
}

// A tree of balls, each touching one before it, from outside or from inside, to a hair.
Balls touching(Dice& dice) {
  Balls balls = {{{0, 0, 0}, 1}};
  for (int count = dice.whole(1, 12); count > 0; --count) {
    const auto last = static_cast<int>(balls.size()) - 1;
    const Sphere s = balls[static_cast<std::size_t>(dice.whole(0, last))];
    const double radius = dice.real(0.3, 2);
    const double reach = dice.one_in(5) ? std::abs(s.radius - radius) : s.radius + radius;
    balls.push_back({s.center + reach * (1 + hair(dice)) * direction(dice), radius});
  }
  return balls;
}

// Balls that touch the circle of the first two from outside or from inside, or pass through points
// of it, to a hair.
Balls on_a_crease(Dice& dice) {
  Balls balls = {{{-4, 0, 0}, 5}, {{4, 0, 0}, 5}};  // the circle x = 0 of radius 3
  for (int count = dice.whole(1, 4); count > 0; --count) {
    const double turn = dice.one_in(2) ? dice.real(0, 2 * kPi) : kPi / 4 * dice.whole(0, 7);
    const double radius = dice.real(0.3, 1.5), side = dice.one_in(2) ? 1 : -1;
    const double x = dice.one_in(2) ? 0 : dice.real(-0.5, 0.5);
    const double off = std::sqrt(std::max(0.0, radius * radius - x * x));
    const double reach = 3 + side * off + hair(dice);
    balls.push_back({{x, reach * std::cos(turn), reach * std::sin(turn)}, radius});
  }
  return balls;
}

// Balls that all but coincide with others.
Balls twins(Dice& dice) {
  Balls balls = gas(dice, 0.5, 2, 12);
  if (balls.size() > 12) balls.erase(balls.begin() + 12, balls.end());
  for (int count = dice.whole(1, 4); count > 0; --count) {
    const auto last = static_cast<int>(balls.size()) - 1;
    Sphere s = balls[static_cast<std::size_t>(dice.whole(0, last))];
    s.center = s.center + hair(dice) * direction(dice);
    s.radius *= 1 + hair(dice);
    balls.push_back(s);
  }
  return balls;
}

// Spheres through one or two common points.
Balls through_a_point(Dice& dice) {
  Balls balls;
  const bool twice = dice.one_in(2);
  const double radius = dice.real(1.1, 3);
  for (int count = dice.whole(4, 9); count > 0; --count) {
    if (twice) {  // (0, 0, ±1)
      const double reach = dice.one_in(2) ? std::sqrt(radius * radius - 1) : dice.real(0.2, 3);
      const double turn = dice.real(0, 2 * kPi);
      balls.push_back({{reach * std::cos(turn), reach * std::sin(turn), 0}, std::hypot(reach, 1)});
    } else {
      const double reach = dice.one_in(2) ? radius : dice.real(0.5, 2);
      balls.push_back({reach * direction(dice), reach});
    }
  }
  return shaken(std::move(balls), dice);
}

struct Maker {
  SphereRecipe recipe;
  Balls (*make)(Dice& dice);
};
constexpr auto kGeneral = Position::general;
constexpr auto kDegenerate = Position::nearly_degenerate;
constexpr std::array<Maker, 16> kMakers{{
    {{"dense", kGeneral}, dense},
    {{"lattices", kDegenerate}, lattice},
    {{"like a protein", kGeneral}, like_a_protein},
    {{"pencils", kDegenerate}, pencil},
    {{"sparse", kGeneral}, sparse},
    {{"rings", kDegenerate}, ring},
    {{"equal radii", kGeneral}, equal_radii},
    {{"touching", kDegenerate}, touching},
    {{"many sizes", kGeneral}, many_sizes},
    {{"on a crease", kDegenerate}, on_a_crease},
    {{"three decimals", kGeneral}, three_decimals},
    {{"twins", kDegenerate}, twins},
    {{"one huge, many tiny", kGeneral}, one_huge_and_many_tiny},
    {{"through a point", kDegenerate}, through_a_point},
    {{"kilometres apart", kGeneral}, kilometres_apart},
    {{"integers, half steps", kDegenerate},
     [](Dice& dice) { return dice.one_in(2) ? integers(dice) : half_steps(dice); }},
}};

}  // namespace

const std::vector<SphereRecipe>& sphere_recipes() {
  static const std::vector<SphereRecipe> all = [] {
    std::vector<SphereRecipe> recipes;
    for (const Maker& m : kMakers) recipes.push_back(m.recipe);
    return recipes;
  }();
  return all;
}

SeededSet seeded_set(unsigned seed) {
  Dice dice(seed);
  const std::size_t recipe = seed % kMakers.size();
  Balls balls = kMakers[recipe].make(dice);
  double largest = 0;
  for (const Sphere& s : balls) largest = std::max(largest, s.radius);
  const double edge_length = dice.real(0.3, 0.8) * std::min(largest, 2.0);
  return {recipe, SphereSet(std::move(balls)), edge_length};
}

}  // namespace vdwmesh::testing
