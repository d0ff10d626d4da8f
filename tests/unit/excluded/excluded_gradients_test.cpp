// Derivatives of the excluded surface against values of 60 digits, differences of the exact
// measures and identities.
#include "excluded/excluded_gradients.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "excluded/excluded_measures.hpp"
#include "reference/cages.hpp"
#include "support/family_sets.hpp"
#include "support/shared_files.hpp"
#include "support/worst.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

using std::numbers::pi;

using EightNumbers = std::array<double, 8>;

EightNumbers numbers_of(const BallGradient& g) {
  return {g.area_center.x,   g.area_center.y,   g.area_center.z,   g.area_radius,
          g.volume_center.x, g.volume_center.y, g.volume_center.z, g.volume_radius};
}

ExcludedMeasures measured(const std::vector<Sphere>& atoms, double probe, bool exterior = false) {
  return excluded_measures(
      SphereSet(atoms), {.probe = probe, .shells = false, .exterior = exterior, .gradients = true});
}

ExcludedGradients gradients_of(const std::vector<Sphere>& atoms, double probe) {
  return measured(atoms, probe).complete.gradients.value();
}

std::vector<Sphere> atoms_at(const std::vector<reference::Point>& centers, double radius) {
  std::vector<Sphere> atoms;
  for (const reference::Point& c : centers) atoms.push_back({{c[0], c[1], c[2]}, radius});
  return atoms;
}

// ---- Closed forms

// Values of 60 digits, made with mpmath by a program of its own: area and volume from Gauss–Bonnet
// sums and fluxes over the patches of so few atoms, which are found by trial of all triples; each
// derivative is a central difference of step 1e-20. Coordinates are exact in double; the probe has
// the double nearest to 1.4, 0.5 or 2.
struct ClosedForm {
  const char* name;
  std::vector<Sphere> atoms;
  double probe, area, volume;
  std::vector<EightNumbers> expected;
  double area_probe, volume_probe;
};

const std::vector<ClosedForm>& closed_forms() {
  static const std::vector<ClosedForm> forms{
      {"one",
       {{{0.5, -0.25, 1.0}, 1.75}},
       1.4,
       38.484510006474967,
       22.449297503777064,
       {{0.0, 0.0, 0.0, 43.982297150257105, 0.0, 0.0, 0.0, 38.484510006474967}},
       0.0,
       0.0},
      {"two",
       {{{0.25, 0.5, -0.75}, 1.5}, {{2.5, -0.625, 1.5}, 1.25}},
       1.4,
       48.960471239064391,
       24.434921573521926,
       {{-2.8008752915999976, 1.4004376457999988, -2.8008752915999976, 33.003745400405912,
         -0.055572524577540635, 0.027786262288770317, -0.055572524577540635, 29.452150879351783},
        {2.8008752915999976, -1.4004376457999988, 2.8008752915999976, 26.631770780090571,
         0.055572524577540635, -0.027786262288770317, 0.055572524577540635, 21.191264528098851}},
       0.67584267048693683,
       1.6829441683862434},
      {"two, a spindle",
       {{{0.25, 0.5, -0.75}, 1.5}, {{3.5, -1.125, 2.5}, 1.25}},
       1.4,
       48.682820814810728,
       22.543337373641344,
       {{2.2533908172284603, -1.1266954086142302, 2.2533908172284603, 41.627870701983664,
         0.55730557999765624, -0.27865278999882812, 0.55730557999765624, 29.310912493894841},
        {-2.2533908172284603, 1.1266954086142302, -2.2533908172284603, 35.481090313805339,
         -0.55730557999765624, 0.27865278999882812, -0.55730557999765624, 20.701740408715801}},
       5.0359950252660023,
       1.3298320877999139},
      {"two, radical plane beyond both",
       {{{0.25, 0.5, -0.75}, 2.0}, {{1.375, -0.0625, 0.375}, 0.75}},
       0.5,
       51.159832411232749,
       33.995582410866324,
       {{-2.3267933136372746, 1.1633966568186373, -2.3267933136372746, 46.518272181577418,
         -1.1822575325484728, 0.59112876627423639, -1.1822575325484728, 48.440665095381316},
        {2.3267933136372746, -1.1633966568186373, 2.3267933136372746, 4.5671582214864384,
         1.1822575325484728, -0.59112876627423639, 1.1822575325484728, 2.7779290563989889}},
       -0.063887563897037421,
       0.058761740547555492},
      {"three",
       {{{0.0, 0.0, 0.0}, 1.5}, {{2.5, 0.25, -0.125}, 1.25}, {{1.0, 2.25, 0.5}, 1.75}},
       1.4,
       69.03373731839416,
       45.21908222177604,
       {{-6.6479262139169249, -6.469286919454883, -1.1524743236924118, 20.599771012430604,
         -3.8712048411253371, -4.1619963559202838, -0.77210567863873897, 22.599994084943581},
        {6.9131765498982596, -3.5585373586255473, -1.432831040280241, 15.865729018613301,
         3.8434549543423291, -2.0924635813819556, -0.82577506969335072, 16.091415337697839},
        {-0.26525033598133461, 10.02782427808043, 2.5853053639726528, 27.070485105944932,
         0.027749886783008045, 6.2544599373022393, 1.5978807483320897, 31.756913309759743}},
       -0.14293569809864076,
       1.4145854140070037},
      {"three, probes overlap in a circle",
       {{{0.0, 0.0, 0.0}, 1.0}, {{4.125, 0.125, 0.0}, 1.125}, {{2.0, 3.625, 0.25}, 1.0625}},
       2,
       55.847198458854622,
       18.85989569872285,
       {{5.628454001887567, 3.9737610780646907, 0.26674954638522258, 38.316116899332335,
         2.729355333274576, 1.6588243884446879, 0.11054590751413416, 19.088649410934887},
        {-4.8624402585174236, 2.1472552019284394, 0.16093913267195733, 38.681398520639619,
         -2.7948587245728308, 1.5085841081289155, 0.11174948840133271, 22.480904255371727},
        {-0.76601374337014337, -6.1210162799931301, -0.42768867905717991, 38.516964846719783,
         0.06550339129825475, -3.1674084965736033, -0.22229539591546687, 20.735331289745295}},
       16.277112185320282,
       6.4576864971972878},
      {"three, probes overlap between spindles",
       {{{0.0, 0.0, 0.0}, 1.0}, {{4.75, 0.125, 0.0}, 1.0625}, {{2.375, 4.25, 0.25}, 0.9375}},
       2,
       40.24755611457419,
       13.293234142720372,
       {{3.3020679175464598, 1.3473819430438293, 0.07525286082972357, 30.797923372706572,
         0.7602053481558012, 0.32572653993608069, 0.018252008121626497, 14.061457294944294},
        {-3.614119153565923, 1.7155726204699254, 0.10810035935808812, 33.181208753172057,
         -0.82697319340070972, 0.40168093703745859, 0.025280202357932657, 15.898438856125308},
        {0.3120512360194632, -3.0629545635137546, -0.18335322018781169, 28.508496455627257,
         0.066767845244908523, -0.72740747697353928, -0.043532210479559154, 12.365337029588876}},
       8.4951660226797616,
       2.0776770660842873},
      {"four, each probe cuts the three others",
       {{{0.0, 0.0, 0.0}, 1.0},
        {{4.625, 0.125, 0.0}, 1.0625},
        {{2.25, 4.0, 0.125}, 0.9375},
        {{2.25, 1.375, 3.75}, 1.03125}},
       2,
       76.560459360535805,
       22.657742614501031,
       {{16.999572505081981, 9.3437979964284804, 7.429384392766085, 60.69626178755845,
         5.3225833323604065, 3.0823334375376187, 2.3012330455657957, 23.954340240235962},
        {-19.312112140753914, 10.089993796556618, 9.4253938217276979, 67.212586713310397,
         -5.7184501487907143, 3.0276039169170012, 2.5575863204878982, 26.315208560849582},
        {0.82836639748694002, -19.00812033483295, 6.8666144027765009, 59.718503781824109,
         0.16220893875253409, -6.0101996472141945, 1.9946236115083704, 22.436944481311175},
        {1.484173238184993, -0.42567145815214817, -23.721392617270284, 67.463923036927248,
         0.23365787767777365, -0.099737707240425368, -6.8534429775620644, 25.580198754546537}},
       71.510872989096233,
       21.726232676407451}};
  return forms;
}

// Relative to 1 + the size of the value: roundings; corners of low probes lose a digit.
constexpr double kClosedForm = 1e-13;

TEST(ExcludedGradients, ClosedForms) {
  for (const ClosedForm& form : closed_forms()) {
    SCOPED_TRACE(form.name);
    const ExcludedSurface s = measured(form.atoms, form.probe).complete;
    const auto expect_near = [](double found, double value) {
      EXPECT_NEAR(found, value, kClosedForm * (1 + std::abs(value)));
    };
    expect_near(s.area, form.area);
    expect_near(s.volume, form.volume);
    expect_near(s.gradients->area_probe, form.area_probe);
    expect_near(s.gradients->volume_probe, form.volume_probe);
    for (std::size_t i = 0; i < form.atoms.size(); ++i) {
      const EightNumbers found = numbers_of(s.gradients->per_atom[i]);
      for (std::size_t k = 0; k < 8; ++k) expect_near(found[k], form.expected[i][k]);
    }
    EXPECT_EQ(s.gradients->kink_probes, 0u);
  }
}

// ---- Differences of the exact measures

struct Totals {
  double area, volume;
};

Totals totals_of(const std::vector<Sphere>& atoms, double probe, bool exterior) {
  const ExcludedMeasures m =
      excluded_measures(SphereSet(atoms), {.probe = probe, .shells = false, .exterior = exterior});
  const ExcludedSurface& s = exterior ? *m.exterior : m.complete;
  return {s.area, s.volume};
}

// A step of 2⁻¹⁰ Å. Measures are right to some 1e-14 of themselves (docs/excluded_surface.md), so
// differences over half of it, extrapolated, are right to the measure times kRounding.
constexpr double kStep = 0x1p-10, kMeasure = 2e-14, kRounding = kMeasure * (10 / 3.0) / kStep;

// The number of differences that agree, and of those that agree to rounding alone.
struct Agreement {
  int all = 0, to_rounding = 0;

  // at(t) moves the atoms by t along a line.
  template <class At>
  void compare(const At& at, double by_area, double by_volume) {
    const auto slopes = [&](double step) {
      const Totals ahead = at(step), behind = at(-step);
      return Totals{(ahead.area - behind.area) / (2 * step),
                    (ahead.volume - behind.volume) / (2 * step)};
    };
    const Totals here = at(0), coarse = slopes(kStep), fine = slopes(kStep / 2);
    const auto judge = [&](double wide, double narrow, double slope, double size) {
      const double extrapolated = narrow + (narrow - wide) / 3,
                   error = std::abs(extrapolated - slope);
      // Where an arc appears between the steps, the slope changes as a root of the way, and both
      // differences are as wrong as they differ.
      const double rounding = kRounding * size;
      EXPECT_LE(error, rounding + 3 * std::abs(narrow - wide));
      ++all;
      to_rounding += error <= rounding + 1e-2 * std::abs(narrow - wide);
    };
    judge(coarse.area, fine.area, by_area, here.area);
    judge(coarse.volume, fine.volume, by_volume, here.volume);
  }
};

// Some atoms, each moved in a direction in the space of its centre and radius; and the probe.
void compare_differences(const std::vector<Sphere>& atoms, double probe, int count, Dice& dice,
                         Agreement& agreement, bool exterior = false) {
  const ExcludedMeasures m = measured(atoms, probe, exterior);
  const ExcludedGradients& g = *(exterior ? *m.exterior : m.complete).gradients;
  for (int n = 0; n < count; ++n) {
    const auto i = static_cast<std::size_t>(dice.whole(0, static_cast<int>(atoms.size()) - 1));
    const Vec3d move = random_point(dice, 1);
    const double growth = dice.real(-1, 1);
    SCOPED_TRACE(::testing::Message() << "atom " << i << ", probe " << probe);
    const auto at = [&](double t) {
      std::vector<Sphere> moved = atoms;
      moved[i].center = moved[i].center + t * move;
      moved[i].radius += t * growth;
      return totals_of(moved, probe, exterior);
    };
    const BallGradient& d = g.per_atom[i];
    agreement.compare(at, dot(d.area_center, move) + d.area_radius * growth,
                      dot(d.volume_center, move) + d.volume_radius * growth);
  }
  agreement.compare([&](double t) { return totals_of(atoms, probe + t, exterior); }, g.area_probe,
                    g.volume_probe);
}

// Most moves meet no event within a step.
void expect_agreement(const Agreement& agreement, int expected) {
  EXPECT_EQ(agreement.all, expected);
  EXPECT_GE(agreement.to_rounding, agreement.all * 9 / 10);
}

std::vector<Sphere> heap(Dice& dice, int count, double half) {
  std::vector<Sphere> atoms;
  for (int i = 0; i < count; ++i) atoms.push_back({random_point(dice, half), dice.real(1.1, 1.9)});
  return atoms;
}

TEST(ExcludedGradients, DifferencesOfRandomSets) {
  constexpr int kAtoms = 5;
  Dice dice(20);
  Agreement agreement;
  int expected = 0;
  for (int set = 0; set < 24; ++set) {
    SCOPED_TRACE(set);
    const std::vector<Sphere> atoms = heap(dice, 10 + 2 * set, 4.5);
    compare_differences(atoms, dice.real(0.5, 4), kAtoms, dice, agreement);
    expected += 2 * (kAtoms + 1);
  }
  expect_agreement(agreement, expected);
}

TEST(ExcludedGradients, DifferencesOfProteins) {
  VDWMESH_NEEDS_SHARED("reference/1CRN.xyzr");
  VDWMESH_NEEDS_SHARED("reference/4PTI.xyzr");
  constexpr int kAtoms = 20;
  Dice dice(21);
  Agreement agreement;
  for (const char* name : {"1CRN", "4PTI"}) {
    SCOPED_TRACE(name);
    const SphereSet set = read_xyzr(shared_path(std::string("reference/") + name + ".xyzr"));
    const std::vector<Sphere> atoms(set.spheres().begin(), set.spheres().end());
    for (const double probe : {1.4, 3.0})
      compare_differences(atoms, probe, kAtoms, dice, agreement);
  }
  expect_agreement(agreement, 2 * 4 * (kAtoms + 1));
}

// A cage with a cavity, shaken so that no probe touches four atoms, and so far that few corners are
// nearer than a step: both surfaces.
TEST(ExcludedGradients, DifferencesOfTheExteriorSurface) {
  constexpr double kShake = 0.2;
  constexpr int kAtoms = 4;
  Dice dice(22);
  std::vector<Sphere> atoms = atoms_at(reference::fullerene(1.45, 1.4), 1.7);
  for (Sphere& s : atoms) s.center = s.center + random_point(dice, kShake);
  const ExcludedMeasures m = measured(atoms, 1.4, true);
  ASSERT_LT(m.exterior->area, m.complete.area);
  Agreement agreement;
  compare_differences(atoms, 1.4, kAtoms, dice, agreement, false);
  compare_differences(atoms, 1.4, kAtoms, dice, agreement, true);
  expect_agreement(agreement, 4 * (kAtoms + 1));
}

// ---- Identities

// Sums over a set that rounding keeps from what they are in mathematics, beside the sum of sizes.
struct Balance {
  double sum = 0, size = 0;
  void add(double term) {
    sum += term;
    size += std::abs(term);
  }
};

// Translation, rotation and scaling: Σ ∂ = 0, Σ x × ∂ = 0, Σ x·∂x + r ∂r + p ∂p = 2 A or 3 V.
void expect_identities(const std::vector<Sphere>& atoms, double probe) {
  const ExcludedSurface s = measured(atoms, probe).complete;
  const ExcludedGradients& g = *s.gradients;
  Balance area_sum, volume_sum, area_torque, volume_torque, area_scale, volume_scale;
  double reach = 0;
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    const BallGradient& d = g.per_atom[i];
    const Vec3d x = atoms[i].center - atoms[0].center;
    for (int axis = 0; axis < 3; ++axis) {
      area_sum.add(d.area_center[axis]);
      volume_sum.add(d.volume_center[axis]);
      area_torque.add(cross(x, d.area_center)[axis]);
      volume_torque.add(cross(x, d.volume_center)[axis]);
      area_scale.add(x[axis] * d.area_center[axis]);
      volume_scale.add(x[axis] * d.volume_center[axis]);
      reach = std::max(reach, std::abs(x[axis]));
    }
    area_scale.add(atoms[i].radius * d.area_radius);
    volume_scale.add(atoms[i].radius * d.volume_radius);
  }
  area_scale.add(probe * g.area_probe);
  volume_scale.add(probe * g.volume_probe);
  area_scale.add(-2 * s.area);
  volume_scale.add(-3 * s.volume);
  // Terms are right to 1e-12 of their sizes, those of probes near the plane of their atoms to 1e-9.
  constexpr double kError = 1e-9;
  EXPECT_LE(std::abs(area_sum.sum), kError * (1 + area_sum.size));
  EXPECT_LE(std::abs(volume_sum.sum), kError * (1 + volume_sum.size));
  EXPECT_LE(std::abs(area_torque.sum), kError * (1 + reach) * (1 + area_sum.size));
  EXPECT_LE(std::abs(volume_torque.sum), kError * (1 + reach) * (1 + volume_sum.size));
  EXPECT_LE(std::abs(area_scale.sum), kError * (1 + area_scale.size));
  EXPECT_LE(std::abs(volume_scale.sum), kError * (1 + volume_scale.size));
}

TEST(ExcludedGradients, IdentitiesOnSetsUnlikeProteins) {
  for_sets_of_families(210, [](const std::vector<Sphere>& atoms, Dice& dice, unsigned) {
    expect_identities(atoms, dice.real(0.3, 3));
  });
}

// Probes that touch four to six atoms: motions of the whole cage move them as it moves.
TEST(ExcludedGradients, IdentitiesOfCages) {
  for (const auto& centers : {reference::cube(2.8), reference::fullerene(1.45, 1.4),
                              reference::dodecahedron(1.6), reference::regular_polygon(6, 1.4)}) {
    for (const double probe : {0.5, 1.4, 3.0}) {
      const std::vector<Sphere> atoms = atoms_at(centers, 1.7);
      SCOPED_TRACE(::testing::Message() << atoms.size() << " atoms, probe " << probe);
      expect_identities(atoms, probe);
      const ExcludedSurface s = measured(atoms, probe).complete;
      EXPECT_GE(s.gradients->kink_probes, s.counts.crowded_probes);
      // Atoms that the cage's symmetry exchanges have equal derivatives.
      const BallGradient& first = s.gradients->per_atom[0];
      for (const BallGradient& g : s.gradients->per_atom) {
        EXPECT_NEAR(g.area_radius, first.area_radius, 1e-9);
        EXPECT_NEAR(g.volume_radius, first.volume_radius, 1e-9);
        EXPECT_NEAR(norm(g.area_center), norm(first.area_center), 1e-9);
        EXPECT_NEAR(norm(g.volume_center), norm(first.volume_center), 1e-9);
      }
    }
  }
}

TEST(ExcludedGradients, MeasuresAreTheSameWithAndWithoutThem) {
  Dice dice(23);
  const std::vector<Sphere> atoms = heap(dice, 60, 5);
  const ExcludedSurface with = measured(atoms, 1.4).complete;
  const ExcludedSurface without = excluded_measures(SphereSet(atoms)).complete;
  EXPECT_EQ(with.area, without.area);
  EXPECT_EQ(with.volume, without.volume);
  EXPECT_FALSE(without.gradients.has_value());
}

bool same_bytes(const std::vector<BallGradient>& a, const std::vector<BallGradient>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

TEST(ExcludedGradients, SameBytesForAnyNumberOfThreadsAndOrderOfAtoms) {
  Dice dice(24);
  const std::vector<Sphere> atoms = heap(dice, 1500, 14);
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return gradients_of(atoms, 1.4);
  };
  const ExcludedGradients one = run(1), eight = run(8);
  EXPECT_TRUE(same_bytes(one.per_atom, eight.per_atom));
  EXPECT_EQ(one.area_probe, eight.area_probe);
  EXPECT_EQ(one.volume_probe, eight.volume_probe);
  const ExcludedGradients turned = gradients_of({atoms.rbegin(), atoms.rend()}, 1.4);
  EXPECT_TRUE(same_bytes(one.per_atom, {turned.per_atom.rbegin(), turned.per_atom.rend()}));
  EXPECT_EQ(one.area_probe, turned.area_probe);
}

// ---- Where there is no derivative

TEST(ExcludedGradients, OfEqualAtomsTheFirstCounts) {
  const std::vector<Sphere> atoms{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{1, 0, 0}, 1}};
  const ExcludedGradients g = gradients_of(atoms, 1.4),
                          alone = gradients_of({atoms[0], atoms[1]}, 1.4);
  EXPECT_EQ(g.kink_atoms, 1u);
  EXPECT_EQ(alone.kink_atoms, 0u);
  EXPECT_EQ(numbers_of(g.per_atom[2]), EightNumbers{});
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(numbers_of(g.per_atom[i]), numbers_of(alone.per_atom[i]));
  }
}

TEST(ExcludedGradients, SwallowedAtomsHaveNone) {
  const ExcludedGradients g =
      gradients_of({{{0, 0, 0}, 2}, {{0.5, 0, 0}, 1}, {{0, 0, 0}, 1.5}}, 1.4);
  EXPECT_EQ(numbers_of(g.per_atom[0]), (EightNumbers{0, 0, 0, 16 * pi, 0, 0, 0, 16 * pi}));
  for (std::size_t i = 1; i < 3; ++i) EXPECT_EQ(numbers_of(g.per_atom[i]), EightNumbers{});
  EXPECT_EQ(g.kink_atoms, 0u);
}

// Three atoms in a circle of the radius of their grown balls: both probes are in their plane, where
// the derivative is infinite. A hair inside, it is finite.
TEST(ExcludedGradients, ProbesInThePlaneOfTheirAtoms) {
  const auto ring = [](double circle) {
    return atoms_at({{circle, 0, 0},
                     {-circle / 2, circle * std::sqrt(3.0) / 2, 0},
                     {-circle / 2, -circle * std::sqrt(3.0) / 2, 0}},
                    1.6);
  };
  for (const double short_of : {0.0, 1e-15, 1e-6, 0.1}) {
    SCOPED_TRACE(short_of);
    const std::vector<Sphere> atoms = ring(3.0 - short_of);
    const ExcludedGradients g = gradients_of(atoms, 1.4);
    if (short_of > 1e-9) {
      EXPECT_EQ(g.kink_probes, 0u);
      expect_identities(atoms, 1.4);
    }
    for (const BallGradient& d : g.per_atom) {
      for (const double x : numbers_of(d)) EXPECT_TRUE(std::isfinite(x));
    }
  }
}

// Three atoms whose two probes touch in the plane: the area has a kink there.
TEST(ExcludedGradients, ProbesThatTouchAreCounted) {
  constexpr double kProbe = 2;  // 3² - 2² = 5
  const auto ring = [](double circle) {
    return atoms_at({{circle, 0, 0},
                     {-circle / 2, circle * std::sqrt(3.0) / 2, 0},
                     {-circle / 2, -circle * std::sqrt(3.0) / 2, 0}},
                    1.0);
  };
  EXPECT_EQ(gradients_of(ring(std::sqrt(5.0) - 1e-10), kProbe).kink_probes, 2u);
  EXPECT_EQ(gradients_of(ring(std::sqrt(5.0) + 1e-10), kProbe).kink_probes, 2u);
  EXPECT_EQ(gradients_of(ring(std::sqrt(5.0) + 1e-3), kProbe).kink_probes, 0u);
  // Beyond, the circle of the crease takes 2 π p per Å from either probe.
  const auto by_circle = [&](double circle) {
    double sum = 0;
    const ExcludedGradients g = gradients_of(ring(circle), kProbe);
    const std::vector<Sphere> atoms = ring(1);
    for (std::size_t i = 0; i < 3; ++i) sum += dot(g.per_atom[i].area_center, atoms[i].center);
    return sum;
  };
  const double apart = by_circle(std::sqrt(5.0) - 1e-7), met = by_circle(std::sqrt(5.0) + 1e-7);
  // Heights fall by circle / height per Å, and each patch loses the cap of that height.
  const double jump = -2 * (2 * pi * kProbe) * std::sqrt(5.0) / kProbe;
  EXPECT_NEAR(met - apart, jump, 1e-5);
}

}  // namespace
}  // namespace vdwmesh::testing
