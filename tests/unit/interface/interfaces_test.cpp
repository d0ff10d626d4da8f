// Interfaces: closed forms of two and three balls; three separate unions of every pair of chains;
// contacts against a quadrature in their planes, and against volumes by the triangulation.
#include "interface/interfaces.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "batch/molecule_spheres.hpp"
#include "core/errors.hpp"
#include "measures/exact_union.hpp"
#include "structure/reader.hpp"
#include "support/shared_files.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kPi = std::numbers::pi;
// Relative, of measures against three separate unions: their balls' areas are rounded to some
// 1e-14 of the whole sphere, of which there are thousands in a sum.
constexpr double kSame = 1e-12;
// Å² of unit-sized balls: a few roundings of numbers of about 10.
constexpr double kRounding = 1e-13;

using Groups = std::vector<std::int32_t>;

// Passes for equal numbers within the tolerance, and not for NaN.
#define EXPECT_WITHIN(actual, expected, tolerance)            \
  EXPECT_TRUE(std::abs((actual) - (expected)) <= (tolerance)) \
      << #actual " = " << (actual) << ", expected " << (expected)

// The cap of a sphere of radius r beyond the plane at signed distance t from its centre.
double cap_area(double r, double t) { return 2 * kPi * r * (r - t); }

TEST(Interfaces, TwoBallsBuryTheirCaps) {
  const double r = 2, R = 1.5, d = 2.25;
  const double t = (d * d + r * r - R * R) / (2 * d);
  const Interfaces found =
      interfaces(SphereSet({{{1, 2, 3}, r}, {{1, 2, 3 + d}, R}}), Groups{0, 1});
  ASSERT_EQ(found.pairs.size(), 1u);
  const Interface& pair = found.pairs[0];
  EXPECT_EQ(pair.a, 0);
  EXPECT_EQ(pair.b, 1);
  EXPECT_WITHIN(pair.area_a, 4 * kPi * r * r, kRounding);
  EXPECT_WITHIN(pair.area_b, 4 * kPi * R * R, kRounding);
  EXPECT_WITHIN(pair.buried_a, cap_area(r, t), kRounding);
  EXPECT_WITHIN(pair.buried_b, cap_area(R, d - t), kRounding);
  EXPECT_WITHIN(pair.contact_area, kPi * (r * r - t * t), kRounding);
  ASSERT_EQ(pair.contacts.size(), 1u);
  EXPECT_EQ(pair.contacts[0].a, 0u);
  EXPECT_EQ(pair.contacts[0].b, 1u);
  ASSERT_EQ(pair.atoms.size(), 2u);
  EXPECT_WITHIN(pair.overlap, r + R - d, kRounding);
}

// Three unit balls in a row, of which the middle one is in no group, in another one, or in one of
// the two: caps of height h on either side.
TEST(Interfaces, AThirdBallCountsWhereItBelongs) {
  const double d = 1.5, h = 1 - d / 2, far = 2 * kPi * h, whole = 4 * kPi;
  const SphereSet row({{{0, 0, 0}, 1}, {{d, 0, 0}, 1}, {{2 * d, 0, 0}, 1}});
  const Interfaces apart = interfaces(row, Groups{0, -1, 1});
  EXPECT_TRUE(apart.pairs.empty());
  EXPECT_WITHIN(apart.groups[0].alone, whole, kRounding);
  EXPECT_WITHIN(apart.groups[0].in_whole, whole - far, kRounding);
  EXPECT_TRUE(std::isnan(apart.alone[1]) && std::isnan(apart.in_whole[1]));

  const Interfaces three = interfaces(row, Groups{0, 1, 2});
  ASSERT_EQ(three.pairs.size(), 2u);
  for (const Interface& pair : three.pairs) {
    EXPECT_WITHIN(pair.buried_area(), 2 * far, kRounding);
    EXPECT_WITHIN(pair.contact_area, kPi * (1 - d * d / 4), kRounding);
  }
  EXPECT_WITHIN(three.groups[1].in_whole, whole - 2 * far, kRounding);
  EXPECT_WITHIN(three.in_whole[1], whole - 2 * far, kRounding);

  const Interfaces two = interfaces(row, Groups{1, 1, 0});
  ASSERT_EQ(two.pairs.size(), 1u);
  EXPECT_WITHIN(two.pairs[0].area_b, 2 * (whole - far), kRounding);
  EXPECT_WITHIN(two.pairs[0].buried_a, far, kRounding);
  EXPECT_WITHIN(two.pairs[0].buried_b, far, kRounding);
}

// Balls around one point meet in three half planes: each face is a third of the way to a disk.
TEST(Interfaces, FacesOfThreeBallsEndWhereTheyMeet) {
  // Unit balls at the corners of an equilateral triangle with side 1. The face of two lies in the
  // disk of radius rho about their middle, on the side of the plane's line x >= -s away from the
  // third, s = 1 / (2 sqrt(3)) being the distance from the middle to the axis of the triangle.
  const double s = 0.5 / std::sqrt(3.0), rho = std::sqrt(0.75);
  const double segment = rho * rho * std::acos(s / rho) - s * std::sqrt(rho * rho - s * s);
  const SphereSet balls({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{0.5, std::sqrt(0.75), 0}, 1}});
  const Interfaces found = interfaces(balls, Groups{0, 1, 1});
  ASSERT_EQ(found.pairs.size(), 1u);
  ASSERT_EQ(found.pairs[0].contacts.size(), 2u);
  for (const AtomContact& contact : found.pairs[0].contacts)
    EXPECT_WITHIN(contact.area, kPi * rho * rho - segment, kRounding);
}

TEST(Interfaces, ABallInsideAnotherLosesAll) {
  const SphereSet balls({{{0, 0, 0}, 2}, {{0.25, 0, 0}, 1}, {{0.25, 0, 0}, 1}});
  const Interfaces found = interfaces(balls, Groups{0, 1, 2});
  ASSERT_EQ(found.pairs.size(), 3u);
  EXPECT_WITHIN(found.pairs[0].buried_b, 4 * kPi, kRounding);  // 0 and 1
  EXPECT_WITHIN(found.pairs[0].buried_a, 0.0, kRounding);
  EXPECT_WITHIN(found.pairs[1].buried_b, 4 * kPi, kRounding);  // 0 and 2
  // Of equal balls the first owns the area.
  EXPECT_WITHIN(found.pairs[2].buried_a, 0.0, kRounding);
  EXPECT_WITHIN(found.pairs[2].buried_b, 4 * kPi, kRounding);
  EXPECT_EQ(found.groups[1].in_whole, 0);
  EXPECT_WITHIN(found.groups[1].alone, 4 * kPi, kRounding);
}

TEST(Interfaces, BadInputIsRefused) {
  EXPECT_THROW(interfaces(SphereSet(), Groups{}), InvalidInput);
  const SphereSet one({{{0, 0, 0}, 1}});
  EXPECT_THROW(interfaces(one, Groups{}), InvalidInput);
  EXPECT_THROW(interfaces(one, Groups{1}), InvalidInput);
  EXPECT_THROW(interfaces(SphereSet({{{0, 0, 0}, 1e200}}), Groups{0}), InvalidInput);
  EXPECT_TRUE(interfaces(one, Groups{-1}).groups.empty());
}

// A structure by chains.
struct Complex {
  SphereSet spheres;
  Groups group;
  std::int32_t groups = 0;
};

Complex complex_of(const std::string& file, double probe, const std::string& radii = "bondi") {
  ReadOptions options;
  options.radii = radii;
  const Molecule molecule = read_structure(shared_path("molecules/" + file), options);
  Complex result{to_spheres(molecule, probe), {}, 0};
  std::map<std::string_view, std::int32_t> known;
  for (const Atom& atom : molecule.atoms) {
    const auto next = static_cast<std::int32_t>(known.size());
    result.group.push_back(known.try_emplace(atom.chain.view(), next).first->second);
  }
  result.groups = static_cast<std::int32_t>(known.size());
  return result;
}

// The area of the balls of some groups alone, by a union of its own.
double area_of(const Complex& c, const Groups& wanted, UnionMethod method) {
  std::vector<Sphere> some;
  for (std::size_t i = 0; i < c.group.size(); ++i)
    if (std::ranges::count(wanted, c.group[i]) > 0) some.push_back(c.spheres[i]);
  return exact_union(SphereSet(std::move(some)),
                     {.method = method, .topology = TopologyRequest::none})
      .area;
}

constexpr const char* kComplexes[] = {"thesis/4HHB.pdb",  "thesis/4INS.pdb", "thesis/1CKB.pdb",
                                      "thesis/133D.pdb",  "thesis/1F4K.pdb", "thesis/1IZH.pdb",
                                      "special/19HC.pdb", "special/1F2N.pdb"};

// Compares all pairs of groups, touching or not, with three unions by the method without arcs,
// which shares no code with what is tested. Returns how many touch.
std::size_t compare_with_unions(const Complex& c, const std::string& name) {
  const Interfaces found = interfaces(c.spheres, c.group);
  const auto area = [&](const Groups& wanted) { return area_of(c, wanted, UnionMethod::cgal); };
  Groups all;
  std::vector<double> alone;
  double in_whole = 0;
  for (std::int32_t g = 0; g < c.groups; ++g) {
    const GroupAreas& of_group = found.groups[static_cast<std::size_t>(g)];
    all.push_back(g);
    alone.push_back(area({g}));
    in_whole += of_group.in_whole;
    EXPECT_WITHIN(of_group.alone, alone.back(), kSame * alone.back()) << name;
  }
  EXPECT_WITHIN(in_whole, area(all), kSame * in_whole) << name;
  for (std::size_t a = 0; a < all.size(); ++a) {
    for (std::size_t b = a + 1; b < all.size(); ++b) {
      const double both = area({all[a], all[b]});
      const auto pair = std::ranges::find_if(
          found.pairs, [&](const Interface& p) { return p.a == all[a] && p.b == all[b]; });
      const double buried = pair != found.pairs.end() ? pair->buried_area() : 0;
      EXPECT_WITHIN(buried, alone[a] + alone[b] - both, kSame * both) << name << ' ' << a << b;
    }
  }
  return found.pairs.size();
}

// 24 sets of balls: eight complexes with three sets of radii.
TEST(Interfaces, EqualThreeSeparateUnions) {
  std::size_t touching = 0;
  for (const char* file : kComplexes) {
    VDWMESH_NEEDS_SHARED(std::string("molecules/") + file);
    for (const char* radii : {"bondi", "alvarez", "protor"}) {
      const Complex c = complex_of(file, 1.4, radii);
      ASSERT_GT(c.groups, 1) << file;
      touching += compare_with_unions(c, std::string(file) + ' ' + radii);
    }
  }
  EXPECT_GT(touching, 24u);
}

// Ball by ball: the same bits as the arcs have in a union of the group alone.
TEST(Interfaces, HaveTheBitsOfTheArcs) {
  VDWMESH_NEEDS_SHARED("molecules/thesis/4HHB.pdb");
  const Complex c = complex_of("thesis/4HHB.pdb", 1.4);
  const Interfaces found = interfaces(c.spheres, c.group);
  const ExactUnion whole =
      exact_union(c.spheres, {.method = UnionMethod::arcs, .topology = TopologyRequest::none});
  for (std::size_t i = 0; i < c.group.size(); ++i)
    EXPECT_EQ(found.in_whole[i], whole.per_sphere[i].area) << i;
  std::vector<Sphere> some;
  std::vector<double> alone;
  for (std::size_t i = 0; i < c.group.size(); ++i) {
    if (c.group[i] != 1) continue;
    some.push_back(c.spheres[i]);
    alone.push_back(found.alone[i]);
  }
  const ExactUnion chain = exact_union(
      SphereSet(some), {.method = UnionMethod::arcs, .topology = TopologyRequest::none});
  for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(alone[i], chain.per_sphere[i].area);
}

TEST(Interfaces, DoNotDependOnThreads) {
  VDWMESH_NEEDS_SHARED("molecules/thesis/4INS.pdb");
  const Complex c = complex_of("thesis/4INS.pdb", 1.4);
  const Interfaces many = interfaces(c.spheres, c.group);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Interfaces single = interfaces(c.spheres, c.group);
  ASSERT_EQ(many.pairs.size(), single.pairs.size());
  for (std::size_t p = 0; p < many.pairs.size(); ++p) {
    const Interface &a = many.pairs[p], &b = single.pairs[p];
    EXPECT_EQ(a.buried_a, b.buried_a);
    EXPECT_EQ(a.contact_area, b.contact_area);
    ASSERT_EQ(a.contacts.size(), b.contacts.size());
    for (std::size_t i = 0; i < a.contacts.size(); ++i)
      EXPECT_EQ(a.contacts[i].area, b.contacts[i].area);
  }
}

// A cluster of balls of different sizes.
SphereSet random_cluster(unsigned seed, std::size_t count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(0, 4), radius(1, 2);
  std::vector<Sphere> balls;
  for (std::size_t i = 0; i < count; ++i)
    balls.push_back({{place(random), place(random), place(random)}, radius(random)});
  return SphereSet(std::move(balls));
}

// The area of the face between two balls by rays in its plane: along each, the parts of the chord
// that no third ball has more power over are intervals with ends in closed form.
double face_by_rays(const SphereSet& balls, SphereId i, SphereId j, int rays) {
  const Sphere &a = balls[i], &b = balls[j];
  const Vec3d to = b.center - a.center;
  const double d = std::sqrt(dot(to, to));
  const double t = (d * d + a.radius * a.radius - b.radius * b.radius) / (2 * d);
  if (std::abs(t) >= a.radius) return 0;
  const Vec3d axis = (1 / d) * to, foot = a.center + t * axis;
  const Vec3d helper = std::abs(axis.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  Vec3d u = cross(axis, helper);
  u = (1 / std::sqrt(dot(u, u))) * u;
  const Vec3d v = cross(axis, u);
  const double rho = std::sqrt(a.radius * a.radius - t * t), step = 2 * rho / rays;
  double area = 0;
  for (int ray = 0; ray < rays; ++ray) {
    const double x = -rho + (ray + 0.5) * step;
    double low = -std::sqrt(rho * rho - x * x), high = -low;
    for (std::size_t k = 0; k < balls.size(); ++k) {
      if (k == i || k == j) continue;
      // Power to ball k less that to a, linear along the ray: p + q y must not be negative.
      const Vec3d at = foot + x * u, apart = balls[k].center - a.center;
      const double p = dot(balls[k].center - at, balls[k].center - at) -
                       balls[k].radius * balls[k].radius - dot(at - a.center, at - a.center) +
                       a.radius * a.radius;
      const double q = -2 * dot(apart, v);
      if (q > 0) low = std::max(low, -p / q);
      if (q < 0) high = std::min(high, -p / q);
      if (q == 0 && p < 0) high = low;
    }
    area += std::max(0.0, high - low) * step;
  }
  return area;
}

// Simpler quadrature, larger tolerance: rays miss at most some of their width times the face's at
// either end, and the ends of the disk, where the chord grows like a square root.
TEST(Interfaces, ContactsAreTheFacesOfThePowerDiagram) {
  constexpr int kRays = 10000;
  constexpr double kTolerance = 4e-5;  // Å²: (rho / rays)^1.5 rho^0.5 with rho below 2, a few times
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const SphereSet balls = random_cluster(seed, 24);
    Groups group;
    for (std::size_t i = 0; i < balls.size(); ++i) group.push_back(i % 2 == 0 ? 0 : 1);
    const Interfaces found = interfaces(balls, group);
    ASSERT_EQ(found.pairs.size(), 1u);
    std::map<std::pair<SphereId, SphereId>, double> areas;
    for (const AtomContact& c : found.pairs[0].contacts) areas[{c.a, c.b}] = c.area;
    for (SphereId i = 0; i < balls.size(); i += 2) {
      for (SphereId j = 1; j < balls.size(); j += 2) {
        const auto known = areas.find({i, j});
        const double area = known == areas.end() ? 0 : known->second;
        EXPECT_WITHIN(area, face_by_rays(balls, i, j, kRays), kTolerance)
            << seed << ": " << i << ' ' << j;
      }
    }
  }
}

// The divergence theorem on ball ∩ power cell, about the ball's centre: 3 V = r A + sum t F over
// its faces, with V and A from the triangulation. Both sides of a face see the same area.
TEST(Interfaces, ContactsAddUpToTheVolume) {
  VDWMESH_NEEDS_SHARED("molecules/thesis/4INS.pdb");
  const Complex c = complex_of("thesis/4INS.pdb", 1.4);
  const ExactUnion whole = exact_union(c.spheres, {.method = UnionMethod::cgal});
  for (std::size_t i = 0; i < c.group.size(); i += 37) {
    Groups one(c.group.size(), 1), other(c.group.size(), 0);
    one[i] = 0;
    other[i] = 1;
    const Interfaces seen = interfaces(c.spheres, one), back = interfaces(c.spheres, other);
    ASSERT_EQ(seen.pairs.size(), 1u);
    const Sphere& ball = c.spheres[i];
    const SphereMeasures& measures = whole.per_sphere[i];
    double sum = ball.radius * measures.area, size = sum;
    for (const AtomContact& contact : seen.pairs[0].contacts) {
      const Sphere& near = c.spheres[contact.b];
      const Vec3d to = near.center - ball.center;
      const double d = std::sqrt(dot(to, to));
      const double t = (d * d + ball.radius * ball.radius - near.radius * near.radius) / (2 * d);
      sum += t * contact.area;
      size += std::abs(t) * contact.area;
    }
    EXPECT_WITHIN(sum, 3 * measures.volume, kSame * size) << i;
    EXPECT_WITHIN(seen.pairs[0].contact_area, back.pairs[0].contact_area,
                  kSame * seen.pairs[0].contact_area);
  }
}

}  // namespace
}  // namespace vdwmesh::testing
