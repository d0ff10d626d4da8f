// Checks of ExcludedMeasures against themselves and against the exact union of balls.
#include "contract/excluded_measures_contract.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "measures/exact_union.hpp"
#include "unit/arrangement/union_cases.hpp"

namespace vdwmesh::testing {
namespace {

using std::size_t;

// Share of the accessible area by which ∫ n dA may differ from 0.
constexpr double kClosure = 1e-12;
// The integral of curvature is a sum of angles, some of them ill-conditioned; it tells integers
// apart.
constexpr double kGaussBonnet = 1e-6;

// Written so that NaN fails.
void expect_near(double found, double expected, double tolerance, const char* what) {
  EXPECT_TRUE(std::abs(found - expected) <= tolerance)
      << what << ": " << found << ", expected " << expected << ", differs by " << found - expected
      << ", allowed " << tolerance;
}

ExactUnion union_of(const SphereSet& atoms, double more) {
  std::vector<Sphere> grown(atoms.spheres().begin(), atoms.spheres().end());
  for (Sphere& s : grown) s.radius += more;
  return exact_union(SphereSet(grown), {.method = UnionMethod::cgal});
}

struct Slack {
  double area, volume, closure;  // Å², Å³, Å²
};
Slack slack(const ExcludedSurface& s) {
  return {kExcludedRounding * s.accessible_area, kExcludedRounding * s.accessible_volume,
          kClosure * s.accessible_area};
}

void expect_sound_totals(const ExcludedSurface& s, const Slack& allowed) {
  EXPECT_TRUE(s.area > 0 && std::isfinite(s.area)) << s.area;
  EXPECT_TRUE(s.volume > 0 && std::isfinite(s.volume)) << s.volume;
  for (const double part : {s.area_by_kind.contact, s.area_by_kind.saddle, s.area_by_kind.concave,
                            s.layer_by_kind.contact, s.layer_by_kind.saddle}) {
    EXPECT_TRUE(part >= 0) << part;
  }
  expect_near(s.area_by_kind.sum(), s.area, allowed.area, "area by kind");
  expect_near(s.accessible_volume - s.layer_by_kind.sum(), s.volume, allowed.volume, "layer");
}

void expect_sound_checks(const ExcludedSurface& s, const Slack& allowed) {
  EXPECT_EQ(s.checks.uncertified_patches, 0u);
  EXPECT_TRUE(s.checks.closure * s.area <= allowed.closure) << s.checks.closure;
  expect_near(s.checks.check_volume, s.volume, allowed.volume, "check volume");
}

void expect_sound_shells(const ExcludedSurface& s, const Slack& allowed) {
  const ExcludedTopology& t = *s.topology;
  ASSERT_FALSE(t.shells.empty());
  double area = 0, volume = 0;
  std::int64_t euler_characteristic = 0;
  std::uint64_t cavities = 0;
  for (const ExcludedShell& shell : t.shells) {
    area += shell.area;
    volume += shell.volume;
    euler_characteristic += shell.euler_characteristic;
    cavities += shell.volume < 0 ? 1 : 0;
    EXPECT_GT(shell.area, 0);
    EXPECT_GE(shell.genus, 0);
    EXPECT_EQ(shell.euler_characteristic, 2 - 2 * shell.genus);
  }
  EXPECT_EQ(t.euler_characteristic, euler_characteristic);
  EXPECT_EQ(t.cavities, cavities);
  EXPECT_GT(t.shells.front().volume, 0);
  expect_near(area, s.area, allowed.area, "area of shells");
  expect_near(volume, s.volume, allowed.volume, "volume of shells");
  const auto is_before = [](const ExcludedShell& a, const ExcludedShell& b) {
    if ((a.volume < 0) != (b.volume < 0)) return b.volume < 0;
    return std::abs(a.volume) > std::abs(b.volume);
  };
  EXPECT_TRUE(std::is_sorted(t.shells.begin(), t.shells.end(), is_before));
}

void expect_sound_components(const ExcludedSurface& s, const Slack& allowed) {
  double area = 0, volume = 0, excluded = 0;
  for (const AccessibleComponent& c : s.topology->components) {
    area += c.accessible_area;
    volume += c.accessible_volume;
    excluded += c.excluded_area;
    EXPECT_EQ(c.is_cavity, c.accessible_volume < 0);
  }
  expect_near(area, s.accessible_area, allowed.area, "area of components");
  expect_near(volume, s.accessible_volume, allowed.volume, "volume of components");
  expect_near(excluded, s.area, allowed.area, "excluded area of components");
}

void expect_sound_topology(const ExcludedSurface& s, const Slack& allowed) {
  ASSERT_TRUE(s.topology.has_value());
  EXPECT_TRUE(s.topology->gauss_bonnet_residual <= kGaussBonnet)
      << s.topology->gauss_bonnet_residual;
  expect_sound_shells(s, allowed);
  expect_sound_components(s, allowed);
}

void expect_sound_atoms(const ExcludedSurface& s, const Slack& allowed, size_t atoms) {
  ASSERT_EQ(s.per_atom.size(), atoms);
  ByPatchKind area{0, 0, 0};
  double volume = 0;
  for (const ExcludedAtom& a : s.per_atom) {
    area.contact += a.area.contact;
    area.saddle += a.area.saddle;
    area.concave += a.area.concave;
    volume += a.volume;
  }
  expect_near(area.contact, s.area_by_kind.contact, allowed.area, "contact areas of atoms");
  expect_near(area.saddle, s.area_by_kind.saddle, allowed.area, "saddle areas of atoms");
  expect_near(area.concave, s.area_by_kind.concave, allowed.area, "concave areas of atoms");
  expect_near(volume, s.volume, allowed.volume, "volumes of atoms");
}

void expect_no_negative_share(const ExcludedSurface& s, const Slack& allowed) {
  for (const ExcludedAtom& a : s.per_atom) {
    EXPECT_TRUE(std::min({a.area.contact, a.area.saddle, a.area.concave}) >= -allowed.area);
  }
}

// The solid holds the atoms and lies in the grown balls.
void expect_sound_unions(const SphereSet& atoms, double probe, const ExcludedSurface& s,
                         const Slack& allowed) {
  const ExactUnion grown = union_of(atoms, probe), plain = union_of(atoms, 0);
  expect_near(s.accessible_area, grown.area, allowed.area, "accessible area");
  expect_near(s.accessible_volume, grown.volume, allowed.volume, "accessible volume");
  EXPECT_LE(s.volume, grown.volume + allowed.volume);
  EXPECT_GE(s.volume, plain.volume - allowed.volume);
  EXPECT_LE(s.area_by_kind.contact, plain.area + allowed.area);
}

// Filling cavities adds to the solid.
void expect_sound_exterior(const ExcludedSurface& complete, const ExcludedSurface& exterior,
                           const Slack& allowed) {
  EXPECT_GE(exterior.volume, complete.volume - allowed.volume);
  const auto& components = complete.topology->components;
  // A cavity of one held probe is no component.
  const bool has_cavity =
      complete.topology->cavities > 0 ||
      std::any_of(components.begin(), components.end(), [](auto& c) { return c.is_cavity; });
  if (!has_cavity) {
    EXPECT_EQ(exterior.area, complete.area);
    EXPECT_EQ(exterior.volume, complete.volume);
  }
  for (const AccessibleComponent& c : exterior.topology->components) EXPECT_FALSE(c.is_cavity);
}

void expect_sound_surface(const ExcludedSurface& s) {
  const Slack allowed = slack(s);
  expect_sound_totals(s, allowed);
  expect_sound_checks(s, allowed);
  expect_sound_topology(s, allowed);
}

bool is_certified(const ExcludedSurface& s) {
  return s.checks.uncertified_patches == 0 && s.topology &&
         s.topology->gauss_bonnet_residual <= kGaussBonnet;
}

}  // namespace

SphereSet equal_spheres(const std::vector<reference::Point>& centers, double radius) {
  std::vector<Sphere> spheres;
  for (const reference::Point& c : centers) spheres.push_back({{c[0], c[1], c[2]}, radius});
  return SphereSet(std::move(spheres));
}

SphereSet to_spheres(const std::vector<reference::Ball>& balls) {
  std::vector<Sphere> spheres;
  for (const auto& [c, radius] : balls) spheres.push_back({{c[0], c[1], c[2]}, radius});
  return SphereSet(std::move(spheres));
}

std::vector<reference::Ball> reference_balls(const SphereSet& spheres) {
  std::vector<reference::Ball> balls;
  for (const Sphere& s : spheres.spheres()) {
    balls.push_back({{{s.center.x, s.center.y, s.center.z}}, s.radius});
  }
  return balls;
}

ExcludedMeasures measure_excluded(const SphereSet& atoms, double probe) {
  return excluded_measures(atoms, {.probe = probe, .per_atom = true, .exterior = true});
}

bool is_certified(const ExcludedMeasures& measures) {
  return is_certified(measures.complete) &&
         (!measures.exterior || is_certified(*measures.exterior));
}

void expect_sound(const SphereSet& atoms, const ExcludedMeasures& measures) {
  const Slack allowed = slack(measures.complete);
  expect_sound_surface(measures.complete);
  expect_sound_atoms(measures.complete, allowed, atoms.size());
  expect_no_negative_share(measures.complete, allowed);
  expect_sound_unions(atoms, measures.probe, measures.complete, allowed);
  ASSERT_TRUE(measures.exterior.has_value());
  expect_sound_surface(*measures.exterior);
  if (::testing::Test::HasFatalFailure()) return;
  expect_sound_exterior(measures.complete, *measures.exterior, allowed);
}

void expect_form(const ExcludedSurface& found, const reference::ExcludedForm& expected,
                 double tolerance) {
  const double area = tolerance * expected.area();
  expect_near(found.area_by_kind.contact, expected.contact, area, "contact area");
  expect_near(found.area_by_kind.saddle, expected.saddle, area, "saddle area");
  expect_near(found.area_by_kind.concave, expected.concave, area, "concave area");
  expect_near(found.area, expected.area(), area, "area");
  expect_near(found.volume, expected.volume, tolerance * expected.volume, "volume");
}

void expect_same_measures(const ExcludedSurface& found, const ExcludedSurface& expected,
                          double tolerance, double scale) {
  const double square = scale * scale, cube = square * scale;
  const ByPatchKind &a = found.area_by_kind, &b = expected.area_by_kind;
  const double area = tolerance * expected.accessible_area;
  expect_near(found.area / square, expected.area, area, "area");
  expect_near(a.contact / square, b.contact, area, "contact area");
  expect_near(a.saddle / square, b.saddle, area, "saddle area");
  expect_near(a.concave / square, b.concave, area, "concave area");
  expect_near(found.volume / cube, expected.volume, tolerance * expected.accessible_volume,
              "volume");
}

void expect_same_topology(const ExcludedTopology& found, const ExcludedTopology& expected) {
  EXPECT_EQ(found.euler_characteristic, expected.euler_characteristic);
  EXPECT_EQ(found.cavities, expected.cavities);
  EXPECT_EQ(found.components.size(), expected.components.size());
  ASSERT_EQ(found.shells.size(), expected.shells.size());
}

void expect_same_counts(const ExcludedCounts& found, const ExcludedCounts& expected) {
  EXPECT_EQ(found.arcs, expected.arcs);
  EXPECT_EQ(found.whole_rings, expected.whole_rings);
  EXPECT_EQ(found.spindle_saddles, expected.spindle_saddles);
  EXPECT_EQ(found.probes, expected.probes);
  EXPECT_EQ(found.low_probes, expected.low_probes);
  EXPECT_EQ(found.crowded_probes, expected.crowded_probes);
  EXPECT_EQ(found.crease_arcs, expected.crease_arcs);
  EXPECT_EQ(found.cusps, expected.cusps);
}

}  // namespace vdwmesh::testing
