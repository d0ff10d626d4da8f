// Shape complementarity of two balls against closed forms: caps, and the median at half of the
// fitted cap's area, because the fit falls from the axis to the rim. Complexes that are turned,
// moved and mirrored have the same.
#include "interface/complementarity.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "spheres/directions.hpp"
#include "structure/reader.hpp"
#include "support/shared_files.hpp"

namespace vdwmesh::testing {
namespace {

// A ball of radius a at the origin, and one of radius b at a distance d on the z axis.
struct TwoBalls {
  double a, b, d;

  double rim_cosine(double probe) const {
    const double grown = a + probe, other = b + probe;
    return (d * d + grown * grown - other * other) / (2 * d * grown);
  }
  // Of the fitted cap: the rim is a chord.
  double fitted_cosine(double probe, double rim) const {
    return std::cos(std::acos(rim_cosine(probe)) - 2 * std::asin(rim / (2 * a)));
  }
  // Of the point of ball a at this cosine of the polar angle, with its nearest point of ball b.
  double distance(double cosine) const { return to_center(cosine) - b; }
  double fit(double cosine, double weight) const {
    const double to = to_center(cosine), gap = to - b;
    return (d * cosine - a) / to * std::exp(-weight * gap * gap);
  }
  TwoBalls swapped() const { return {b, a, d}; }

 private:
  double to_center(double cosine) const { return std::sqrt(d * d + a * a - 2 * d * a * cosine); }
};

double median(const TwoBalls& balls, const ComplementarityOptions& o) {
  return balls.fit(0.5 * (1 + balls.fitted_cosine(o.probe, o.rim)), o.weight);
}

// Integral of exp(-w d²) over the buried cap, by Simpson's rule in the cosine.
double contact(const TwoBalls& balls, const ComplementarityOptions& o) {
  constexpr int kSteps = 2000;
  const double from = balls.rim_cosine(o.probe), step = (1 - from) / kSteps;
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double gap = balls.distance(from + i * step);
    const double factor = i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2;
    sum += factor * std::exp(-o.weight * gap * gap);
  }
  return 2 * std::numbers::pi * balls.a * balls.a * sum * step / 3;
}

SphereSet ball_at(double z, double radius) { return SphereSet({{{0.3, -0.2, z}, radius}}); }

TEST(Complementarity, TwoBallsFitAsTheirClosedForms) {
  for (const TwoBalls balls : {TwoBalls{6, 6, 13}, TwoBalls{8, 6, 15.2}, TwoBalls{5, 9, 15}}) {
    const ComplementarityOptions o;
    const Complementarity found =
        complementarity(ball_at(0, balls.a), ball_at(balls.d, balls.b), o);
    const double a = median(balls, o), b = median(balls.swapped(), o);
    // The stated tolerance, and as much for what a last doubling would change.
    EXPECT_LE(found.error, o.tolerance);
    EXPECT_NEAR(found.sc, 0.5 * (a + b), 2 * o.tolerance);
    EXPECT_NEAR(found.median_a, a, 4 * o.tolerance);
    EXPECT_NEAR(found.median_b, b, 4 * o.tolerance);
    // Counts of samples on caps of some hundred Å²: a sample is less than 0.03 Å², and the lattice
    // leaves some tens of them along the rim to chance.
    const double cap = 2 * std::numbers::pi * balls.a * balls.a * (1 - balls.rim_cosine(o.probe));
    EXPECT_NEAR(found.buried_a, cap, 0.01 * cap);
    EXPECT_NEAR(found.contact_a, contact(balls, o), 0.01 * contact(balls, o));
    EXPECT_NEAR(found.contact_b, contact(balls.swapped(), o), 0.01 * contact(balls.swapped(), o));
  }
}

// Atoms that cannot have a part in the buried surfaces are left out before these are made. Rows of
// balls behind both sides, of which the first ones are kept, change nothing in front.
TEST(Complementarity, AtomsFarBehindChangeNothing) {
  const TwoBalls balls{6, 6, 13};
  const ComplementarityOptions o;
  const auto row_from = [](double z, double step) {
    std::vector<Sphere> row;
    for (int i = 0; i < 12; ++i) row.push_back({{0.3, -0.2, z + i * step}, 6});
    return SphereSet(std::move(row));
  };
  const Complementarity found = complementarity(row_from(0, -8), row_from(balls.d, 8), o);
  const double a = median(balls, o), b = median(balls.swapped(), o);
  EXPECT_NEAR(found.sc, 0.5 * (a + b), 2 * o.tolerance);
  const double cap = 2 * std::numbers::pi * balls.a * balls.a * (1 - balls.rim_cosine(o.probe));
  EXPECT_NEAR(found.buried_a, cap, 0.01 * cap);
  EXPECT_NEAR(found.buried_b, cap, 0.01 * cap);
  EXPECT_NEAR(found.contact_a, contact(balls, o), 0.01 * contact(balls, o));
}

TEST(Complementarity, SidesApartHaveNone) {
  const Complementarity far = complementarity(ball_at(0, 2), ball_at(50, 2));
  EXPECT_TRUE(std::isnan(far.sc) && std::isnan(far.error));
  EXPECT_EQ(far.buried_a, 0);
  // Buried, but nowhere farther than the rim from what is not.
  const Complementarity thin = complementarity(ball_at(0, 2), ball_at(6.7, 2));
  EXPECT_TRUE(std::isnan(thin.sc) && std::isnan(thin.error));
  EXPECT_GT(thin.buried_a, 0);
  EXPECT_EQ(thin.fitted_a, 0);
}

// Weights that fall off over much more than what is buried, and over much less than an Å: how far
// places are searched follows from them.
TEST(Complementarity, OfAnyWeight) {
  const TwoBalls balls{6, 6, 12.02};
  for (const double weight : {0.01, 5.0, 150.0}) {
    ComplementarityOptions o;
    o.weight = weight;
    o.density = 64;
    const Complementarity found =
        complementarity(ball_at(0, balls.a), ball_at(balls.d, balls.b), o);
    // Where most values are next to 0, spreading moves the median by a part of its width of 0.02.
    EXPECT_NEAR(found.sc, median(balls, o), weight > 100 ? 0.01 : 2 * o.tolerance) << weight;
    EXPECT_NEAR(found.contact_a, contact(balls, o), 0.03 * contact(balls, o)) << weight;
  }
}

// The atoms of the first two chains of a file.
std::array<std::vector<Sphere>, 2> first_chains(const std::string& file) {
  const Molecule molecule = read_structure(shared_path("molecules/thesis/" + file), {});
  std::array<std::vector<Sphere>, 2> sides;
  std::map<std::string, std::size_t> known;
  for (const Atom& atom : molecule.atoms) {
    const std::size_t next = known.size();
    const std::size_t side = known.try_emplace(std::string(atom.chain.view()), next).first->second;
    if (side < 2) sides[side].push_back({atom.position, atom.radius});
  }
  return sides;
}

TEST(Complementarity, DoesNotDependOnThreads) {
  VDWMESH_NEEDS_SHARED("molecules/thesis");
  const auto [first, second] = first_chains("4INS.pdb");
  const SphereSet a(first), b(second);
  const Complementarity many = complementarity(a, b);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Complementarity single = complementarity(a, b);
  EXPECT_EQ(many.sc, single.sc);
  EXPECT_EQ(many.error, single.error);
  EXPECT_EQ(many.contact_a, single.contact_a);
}

// A motion: three orthonormal vectors, to which the axes go, and a shift. With mirrored axes it
// turns the inside of space out.
struct Motion {
  std::array<Vec3d, 3> axis;
  Vec3d shift;

  SphereSet operator()(const std::vector<Sphere>& balls) const {
    std::vector<Sphere> moved;
    for (const auto& [c, radius] : balls)
      moved.push_back({shift + c.x * axis[0] + c.y * axis[1] + c.z * axis[2], radius});
    return SphereSet(std::move(moved));
  }
};

Motion random_motion(std::mt19937& dice, bool mirrored) {
  std::normal_distribution<double> normal;
  const auto any = [&] { return Vec3d{normal(dice), normal(dice), normal(dice)}; };
  const Vec3d first = unit(any()), some = any();
  const Vec3d second = unit(some - dot(some, first) * first);
  return {{first, second, (mirrored ? -1.0 : 1.0) * cross(first, second)}, 30.0 * any()};
}

// Samples move with the atoms, so that all figures are the same but for rounding: coordinates of
// some 100 Å have 1e-14 Å, which arcs at small angles enlarge a thousand times.
TEST(Complementarity, TurnsAndMirrorsWithTheComplex) {
  VDWMESH_NEEDS_SHARED("molecules/thesis");
  constexpr double kSame = 1e-9;
  std::mt19937 dice(20261129);
  for (const char* file : {"4INS.pdb", "1CKB.pdb", "133D.pdb"}) {
    const auto [a, b] = first_chains(file);
    const Complementarity still = complementarity(SphereSet(a), SphereSet(b));
    ASSERT_GT(still.fitted_a, 20) << file;
    for (int i = 0; i < 20; ++i) {
      const Motion move = random_motion(dice, i >= 10);
      const Complementarity moved = complementarity(move(a), move(b));
      EXPECT_NEAR(moved.sc, still.sc, kSame) << file;
      EXPECT_NEAR(moved.error, still.error, kSame) << file;
      EXPECT_NEAR(moved.fitted_b, still.fitted_b, kSame * still.fitted_b) << file;
      EXPECT_NEAR(moved.contact_a, still.contact_a, kSame * still.contact_a) << file;
    }
  }
}

TEST(Complementarity, BadInputIsRefused) {
  EXPECT_THROW(complementarity(SphereSet(), ball_at(0, 1)), InvalidInput);
  EXPECT_THROW(complementarity(ball_at(0, 1), ball_at(3, 1), {.probe = 0}), InvalidInput);
  for (const double weight : {0.0, 0.001, -1.0, std::nan("")})
    EXPECT_THROW(complementarity(ball_at(0, 1), ball_at(3, 1), {.weight = weight}), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::testing
