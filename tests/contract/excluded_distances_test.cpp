// Contract of excluded_signed_distances() and excluded_distances(): against closed forms of one and
// two balls, against bounds that follow from the definition alone (`excluded_distance.hpp`),
// against meshes whose vertices lie on the surface, and what holds for every set.
#include "excluded/excluded_distances.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/signed_distance.hpp"
#include "contract/excluded_distances_contract.hpp"
#include "contract/excluded_measures_contract.hpp"
#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "core/sum.hpp"
#include "excluded/distances/surface_samples.hpp"
#include "excluded/excluded_mesher.hpp"
#include "reference/cages.hpp"
#include "reference/excluded_distance.hpp"
#include "support/ball_families.hpp"
#include "support/shared_files.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

std::vector<double> measure(const std::vector<Vec3d>& points, const SphereSet& atoms,
                            double probe) {
  return excluded_signed_distances(points, atoms, probe);
}

// Every distance between the bounds of the oracle.
void expect_bounds(const SphereSet& atoms, double probe, const std::vector<Vec3d>& points,
                   double width = kBounds) {
  const reference::ExcludedDistance oracle(reference_balls(atoms), probe);
  const std::vector<double> found = measure(points, atoms, probe);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d& p = points[i];
    const auto [lower, upper] = oracle.bounds({{p.x, p.y, p.z}}, width);
    EXPECT_TRUE(found[i] >= lower - kSlack && found[i] <= upper + kSlack)
        << found[i] << " is not from " << lower << " to " << upper << " at " << p.x << ", " << p.y
        << ", " << p.z << ", probe " << probe;
  }
}

// In the half-plane of a point and the axis of two balls: an arc of a circle, counter-clockwise.
struct FlatArc {
  double x, y, radius, from, to;  // the centre; x along the axis, y >= 0 across it

  double distance(double px, double py) const {
    const double dx = px - x, dy = py - y;
    double angle = std::atan2(dy, dx);
    while (angle < from) angle += 2 * std::numbers::pi;
    if (angle <= to) return std::abs(std::hypot(dx, dy) - radius);
    const auto end = [&](double a) {
      return std::hypot(px - x - radius * std::cos(a), py - y - radius * std::sin(a));
    };
    return std::min(end(from), end(to));
  }
};

// Two balls on the x axis, the first in the origin, around which a probe rolls.
class TwoBalls {
 public:
  TwoBalls(double r, double s, double apart, double probe) : r_(r), s_(s), d_(apart), p_(probe) {
    const double a = r + probe, b = s + probe;
    t_ = (apart * apart + (a - b) * (a + b)) / (2 * apart);
    rho_ = std::sqrt((a - t_) * (a + t_));
    const double to_first = std::atan2(rho_, t_), to_second = std::atan2(rho_, apart - t_);
    arcs_.push_back({0, 0, r, to_first, std::numbers::pi});
    arcs_.push_back({apart, 0, s, 0, std::numbers::pi - to_second});
    // Seen from the probe the atoms are in the directions π + to_first and -to_second.
    const double first = std::numbers::pi + to_first, second = 2 * std::numbers::pi - to_second;
    if (rho_ >= probe) {
      arcs_.push_back({t_, rho_, probe, first, second});
    } else {
      const double cusp = std::asin(rho_ / probe);
      arcs_.push_back({t_, rho_, probe, first, std::numbers::pi + cusp});
      arcs_.push_back({t_, rho_, probe, 2 * std::numbers::pi - cusp, second});
    }
  }
  double waist() const { return rho_ - p_; }

  double signed_distance(double x, double y) const {
    double least = std::numeric_limits<double>::infinity();
    for (const FlatArc& arc : arcs_) least = std::min(least, arc.distance(x, y));
    return is_inside(x, y) ? -least : least;
  }

 private:
  // In an atom; or in the triangle of the centres and the probe, and not in the probe.
  bool is_inside(double x, double y) const {
    if (std::hypot(x, y) < r_ || std::hypot(x - d_, y) < s_) return true;
    const bool between = y * t_ < x * rho_ && y * (d_ - t_) < (d_ - x) * rho_;
    return between && std::hypot(x - t_, y - rho_) > p_;
  }

  double r_, s_, d_, p_, t_, rho_;
  std::vector<FlatArc> arcs_;
};

TEST(ExcludedDistances, OneBall) {
  const SphereSet atom({{{1, 2, 3}, 1.7}});
  const std::vector<double> found =
      measure({{1, 2, 3}, {1, 2, 4}, {1, 2, 4.7}, {1, 2, 5.5}, {1, 2, 6.1}, {41, 2, 3}}, atom, 1.4);
  const std::array<double, 6> expected{-1.7, -0.7, 0, 0.8, 1.4, 38.3};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], kRounding);
}

// Rings with a wide waist, a thin one, and spindles whose cusps are near each other or far apart.
TEST(ExcludedDistances, TwoBalls) {
  Dice dice(2025);
  int spindles = 0;
  for (const double apart : {2.0, 3.2, 4.2, 4.9, 5.1, 5.4, 5.7, 5.95}) {
    const TwoBalls form(1.7, 1.5, apart, 1.4);
    spindles += form.waist() < 0;
    const SphereSet atoms({{{0, 0, 0}, 1.7}, {{apart, 0, 0}, 1.5}});
    std::vector<Vec3d> points;
    for (int i = 0; i < 4000; ++i) {
      points.push_back({dice.real(-4, apart + 4), dice.real(-3.5, 3.5), dice.real(-3.5, 3.5)});
      if (i % 4 == 0) points.back() = {dice.real(1, apart - 1), dice.real(-1, 1), dice.real(-1, 1)};
      if (i % 40 == 0) points.back() = {points.back().x, 0, 0};
    }
    const std::vector<double> found = measure(points, atoms, 1.4);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d& p = points[i];
      EXPECT_NEAR(found[i], form.signed_distance(p.x, std::hypot(p.y, p.z)), kRounding)
          << apart << ": " << p.x << ", " << p.y << ", " << p.z;
    }
  }
  EXPECT_GE(spindles, 3);
}

// Two mirror probes over three atoms meet in a crease, and leave a hole where they are low enough.
TEST(ExcludedDistances, ThreeBallsBetweenBounds) {
  Dice dice(33);
  for (const double side : {3.0, 3.9, 4.2, 4.5, 4.8, 5.2}) {
    SCOPED_TRACE(side);
    const SphereSet atoms(
        {{{0, 0, 0}, 1.7}, {{side, 0, 0}, 1.5}, {{0.48 * side, 0.87 * side, 0.1}, 1.6}});
    std::vector<Vec3d> points = places_around(atoms, 2, dice, 8);
    const Vec3d middle = (1.0 / 3) * (atoms[0].center + atoms[1].center + atoms[2].center);
    for (int i = 0; i < 12; ++i) points.push_back(middle + random_point(dice, 0.9));
    expect_bounds(atoms, 1.4, points);
  }
}

// Atoms on the corners of cages, in place, so that many touch one probe; outside and in the cavity.
TEST(ExcludedDistances, CagesBetweenBounds) {
  Dice dice(7);
  for (const std::vector<reference::Point>& corners :
       {reference::cube(3.1), reference::octahedron(3.3), reference::dodecahedron(2.4),
        reference::regular_polygon(6, 1.4), reference::fullerene(1.45, 1.4)}) {
    const SphereSet atoms = equal_spheres(corners, 1.6);
    for (const double probe : {0.7, 1.4}) {
      SCOPED_TRACE(std::to_string(corners.size()) + ", " + std::to_string(probe));
      std::vector<Vec3d> points = places_around(atoms, 1.5, dice, 10);
      for (int i = 0; i < 4; ++i) points.push_back(random_point(dice, 0.7));
      expect_bounds(atoms, probe, points);
    }
  }
}

// A probe that touches the eight atoms around it and cannot roll: its sphere is the wall of a
// cavity, of which the exterior surface knows nothing.
TEST(ExcludedDistances, AProbeThatItsAtomsHold) {
  constexpr double kProbe = 1.4, kRadius = 1.5;
  const double half = (kProbe + kRadius) / std::sqrt(3.0);
  std::vector<Sphere> atoms;
  for (int i = 0; i < 8; ++i) {
    atoms.push_back({{i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half}, kRadius});
  }
  Dice dice(47);
  std::vector<Vec3d> inside, around{{0, 0, 0}};
  for (int i = 0; i < 1000; ++i) inside.push_back(dice.real(0, 1.39) * random_direction(dice));
  const std::vector<double> found = measure(inside, SphereSet(atoms), kProbe);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    EXPECT_NEAR(found[i], kProbe - norm(inside[i]), kRounding);
  }
  for (int i = 0; i < 200; ++i) around.push_back(dice.real(0, 4) * random_direction(dice));
  // The oracle finds no probe that cannot move, so it judges points outside of the cage alone.
  std::vector<Vec3d> beyond;
  for (int i = 0; i < 200; ++i) beyond.push_back(dice.real(4.5, 6) * random_direction(dice));
  expect_bounds(SphereSet(atoms), kProbe, beyond);
  const IndexedMesh mesh = mesh_excluded(SphereSet(atoms), {.probe = kProbe}).mesh;
  const MeshDistances both = excluded_distances(mesh, SphereSet(atoms), kProbe);
  EXPECT_LT(both.hausdorff_lower_bound, 0.1);
  // An atom in the middle fills the cavity and stays away from the outside.
  std::vector<Sphere> filled = atoms;
  filled.push_back({{0, 0, 0}, 0.5});
  const std::vector<double> expected = measure(around, SphereSet(filled), kProbe),
                            exterior = excluded_signed_distances(around, SphereSet(atoms), kProbe,
                                                                 nullptr, ExcludedPart::exterior);
  for (std::size_t i = 0; i < around.size(); ++i) {
    EXPECT_NEAR(exterior[i], expected[i], kRounding);
  }
}

TEST(ExcludedDistances, RandomSetsBetweenBounds) {
  Dice dice(404);
  const std::array<std::function<std::vector<Sphere>(Dice&)>, 4> families{sparse_gas, dense_heap,
                                                                          chain, lattice};
  for (int i = 0; i < 24; ++i) {
    SCOPED_TRACE(i);
    const SphereSet atoms(families[static_cast<std::size_t>(i % 4)](dice));
    const double probe = dice.real(0.3, 2);
    expect_bounds(atoms, probe, places_around(atoms, 1.5 * probe, dice, 8));
  }
}

// Of the vertices of a mesh those at which the concave patches of two probes meet.
std::vector<std::size_t> vertices_of_creases(const ExcludedMesh& made) {
  const IndexedMesh& mesh = made.mesh;
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> patch(mesh.vertex_count(), kNone);
  std::vector<std::uint8_t> sharp(mesh.vertex_count(), 0);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const std::uint32_t index = made.triangle_patch[t];
    if (made.patches[index].kind != PatchKind::concave) continue;
    for (const std::uint32_t v : mesh.triangles[t]) {
      sharp[v] = sharp[v] != 0 || (patch[v] != kNone && patch[v] != index);
      patch[v] = index;
    }
  }
  std::vector<std::size_t> found;
  for (std::size_t v = 0; v < sharp.size(); ++v) {
    if (sharp[v] != 0) found.push_back(v);
  }
  return found;
}

// Between two probes that meet in a crease the crease is nearest, and no single probe says how
// near.
TEST(ExcludedDistances, OverCreasesOfAMolecule) {
  VDWMESH_NEEDS_SHARED("reference/1L2Y.xyzr");
  const SphereSet atoms = read_xyzr(shared_path("reference/1L2Y.xyzr"));
  Dice dice(5);
  for (const double probe : {1.4, 3.0}) {
    ExcludedMeshOptions options;
    options.probe = probe;
    options.edge_length = 0.7;
    const ExcludedMesh made = mesh_excluded(atoms, options);
    std::vector<Vec3d> all;
    for (const std::size_t v : vertices_of_creases(made)) {
      all.push_back(made.mesh.positions[v] +
                    dice.real(0.05, 0.4) * cast<double>(made.mesh.normals[v]));
    }
    std::vector<Sphere> grown(atoms.spheres().begin(), atoms.spheres().end());
    for (Sphere& s : grown) s.radius += probe;
    const std::vector<double> accessible = signed_distances(all, SphereSet(grown)),
                              found = measure(all, atoms, probe);
    std::vector<Vec3d> sharp;
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_GE(found[i], accessible[i] + probe);
      if (found[i] > accessible[i] + probe + 1e-3) sharp.push_back(all[i]);
    }
    EXPECT_GE(2 * sharp.size(), all.size());
    ASSERT_GE(sharp.size(), 40u);
    for (std::size_t i = 0; i < 40; ++i) {
      sharp[i] = sharp[i + (sharp.size() - 40) / 40 * i];
    }
    sharp.resize(std::min<std::size_t>(sharp.size(), 40));
    expect_bounds(atoms, probe, sharp);
  }
}

// Vertices of the mesh are on the surface; from there along the normal the distance is the way, as
// long as it is short, and never more.
TEST(ExcludedDistances, VerticesAndNormalsOfMeshes) {
  for (const char* name : {"1L2Y", "1CRN"}) {
    const std::string file = std::string("reference/") + name + ".xyzr";
    VDWMESH_NEEDS_SHARED(file);
    const SphereSet atoms = read_xyzr(shared_path(file));
    for (const double probe : {0.7, 1.4, 3.0}) {
      ExcludedMeshOptions options;
      options.probe = probe;
      options.edge_length = 0.7;
      const IndexedMesh mesh = mesh_excluded(atoms, options).mesh;
      for (const double way : {0.0, 0.05, -0.05}) {
        std::vector<Vec3d> points;
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
          points.push_back(mesh.positions[v] + way * cast<double>(mesh.normals[v]));
        }
        const std::vector<double> found = measure(points, atoms, probe);
        std::size_t short_of = 0;
        for (const double d : found) {
          EXPECT_LE(std::abs(d), way == 0 ? kRounding : std::abs(way) + 1e-7);
          short_of += std::abs(d - way) > 1e-6;
        }
        // Around creases and necks another part of the surface is nearer.
        EXPECT_LE(short_of, points.size() / 3) << name << ", " << probe << ", " << way;
      }
    }
  }
}

// The distance changes by no more than the point moves; far off it is that of the atoms.
TEST(ExcludedDistances, ChangesNoFasterThanThePoint) {
  Dice dice(90);
  for (int i = 0; i < 20; ++i) {
    const SphereSet atoms(i % 2 == 0 ? chain(dice) : dense_heap(dice));
    std::vector<Vec3d> points, moved, far;
    for (const Vec3d& p : places_around(atoms, 2, dice, 500)) {
      points.push_back(p);
      moved.push_back(p + 0.01 * random_direction(dice));
      far.push_back(atoms[0].center + dice.real(100, 1000) * random_direction(dice));
    }
    const std::vector<double> a = measure(points, atoms, 1), b = measure(moved, atoms, 1);
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_LE(std::abs(a[k] - b[k]), 0.01 + kRounding);
    const std::vector<double> there = measure(far, atoms, 1),
                              union_there = signed_distances(far, atoms);
    for (std::size_t k = 0; k < far.size(); ++k) EXPECT_NEAR(there[k], union_there[k], 1e-9);
  }
}

// The samples are spread evenly: the mean distance of the surface from a speck is an integral over
// the surface, which a fine mesh has as well.
TEST(ExcludedDistances, SamplesCoverTheSurfaceEvenly) {
  std::vector<SphereSet> sets;
  sets.emplace_back(std::vector<Sphere>{{{0, 0, 0}, 1.7}, {{4.9, 0, 0}, 1.5}});
  sets.emplace_back(
      std::vector<Sphere>{{{0, 0, 0}, 1.7}, {{4.2, 0, 0}, 1.5}, {{2.0, 3.7, 0.1}, 1.6}});
  for (const SphereSet& atoms : sets) {
    ExcludedMeshOptions options;
    options.edge_length = 0.06;
    const IndexedMesh fine = mesh_excluded(atoms, options).mesh;
    for (const Vec3d& at : {Vec3d{12, 1, 2}, Vec3d{2, -9, 1}, Vec3d{2, 1, 8}, Vec3d{-6, 2, -3}}) {
      WideSum area, moment;
      for (const Triangle& t : fine.triangles) {
        const Vec3d &a = fine.positions[t[0]], &b = fine.positions[t[1]], &c = fine.positions[t[2]];
        const double here = norm(cross(b - a, c - a)) / 2;
        area.add(here);
        moment.add(here * norm((1.0 / 3) * (a + b + c) - at));
      }
      DistanceOptions wanted;
      wanted.samples_per_area = 2000;
      const DistanceStatistics found =
          excluded_distances(speck_at(at), atoms, 1.4, wanted).surface_to_mesh;
      EXPECT_NEAR(found.mean, moment.value() / area.value(), 5 * found.mean_error + 1e-3);
    }
  }
}

// However many samples there are, some thousands are kept at a time.
TEST(ExcludedDistances, SamplesAreTakenInParts) {
  constexpr double kProbe = 1.4, kDensity = 1e4;
  const SphereSet atoms({{{0, 0, 0}, 1.5}, {{2.5, 0, 0}, 1.7}});
  const excluded::JudgedSurface surface(atoms, kProbe, ExcludedPart::complete, nullptr);
  const ExposedSurface accessible(excluded::grown_by(atoms, kProbe));
  const excluded::SurfaceSamples samples(surface, accessible, kProbe, kDensity, 1);
  std::vector<Vec3d> inside, border;
  std::size_t taken = 0, most = 0;
  const auto take = [&] {
    taken += inside.size();
    most = std::max({most, inside.size(), border.size()});
    inside.clear();
    border.clear();
  };
  for (std::size_t i = 0; i < samples.element_count(); ++i) samples.add(i, inside, border, take);
  take();
  EXPECT_LE(most, excluded::SurfaceSamples::kTogether);
  const double area = excluded_measures(atoms, {.probe = kProbe}).complete.area;
  EXPECT_NEAR(static_cast<double>(taken), area * kDensity, 0.01 * area * kDensity);
}

// A mesh of the surface is near it both ways, and nearer by four when its edges are half as long.
TEST(ExcludedDistances, BothWaysOfAMesh) {
  VDWMESH_NEEDS_SHARED("reference/1L2Y.xyzr");
  const SphereSet atoms = read_xyzr(shared_path("reference/1L2Y.xyzr"));
  double before = 0;
  for (const double edge_length : {0.8, 0.4, 0.2}) {
    ExcludedMeshOptions options;
    options.edge_length = edge_length;
    const IndexedMesh mesh = mesh_excluded(atoms, options).mesh;
    const MeshDistances found = excluded_distances(mesh, atoms, 1.4);
    // A chord of a circle of 1.4 Å is edge² / (8 · 1.4) Å from it in the middle. Necks of saddles
    // have circles of some tenths of an Å around them.
    const double chord = edge_length * edge_length / (8 * 1.4);
    EXPECT_LE(found.hausdorff_lower_bound, edge_length / 4);
    EXPECT_LE(found.mesh_to_surface.rms, chord);
    EXPECT_LE(found.surface_to_mesh.rms, chord);
    EXPECT_NEAR(found.mesh_to_surface.mean, found.surface_to_mesh.mean,
                0.15 * found.mesh_to_surface.mean);
    if (before > 0) {
      EXPECT_GT(before / found.mesh_to_surface.mean, 2.5);
      EXPECT_LT(before / found.mesh_to_surface.mean, 5);
    }
    before = found.mesh_to_surface.mean;
  }
}

TEST(ExcludedDistances, SameBitsOnAnyThreads) {
  Dice dice(8);
  std::vector<Sphere> balls = chain(dice);
  while (balls.size() < 60) balls = chain(dice);
  const SphereSet atoms(balls);
  ExcludedMeshOptions options;
  options.edge_length = 0.6;
  const IndexedMesh mesh = mesh_excluded(atoms, options).mesh;
  const auto figures = [&] {
    const MeshDistances d = excluded_distances(mesh, atoms, 1.4);
    return std::vector<double>{d.mesh_to_surface.mean, d.mesh_to_surface.rms,
                               d.surface_to_mesh.mean, d.surface_to_mesh.rms,
                               d.surface_to_mesh.p95,  d.hausdorff_lower_bound};
  };
  const std::vector<double> many = figures();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(many, figures());
}

// Asks to stop at the given call of advance().
class StoppingMonitor final : public Monitor {
 public:
  explicit StoppingMonitor(int calls) : left_(calls) {}
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return left_.fetch_sub(1) <= 0; }

 private:
  mutable std::atomic<int> left_;
};

TEST(ExcludedDistances, StopsWhenAsked) {
  const SphereSet atoms({{{0, 0, 0}, 1.7}, {{4.2, 0, 0}, 1.5}, {{2.0, 3.7, 0.1}, 1.6}});
  DistanceOptions options;
  int calls = 0;
  for (bool stopped = true; stopped; ++calls) {
    StoppingMonitor monitor(calls);
    options.monitor = &monitor;
    try {
      excluded_distances(speck_at({9, 0, 0}), atoms, 1.4, options);
      stopped = false;
    } catch (const Cancelled&) {
    }
  }
  EXPECT_GE(calls, 8);
  StoppingMonitor at_once(0);
  EXPECT_THROW(excluded_signed_distances(std::vector<Vec3d>{{0, 0, 0}}, atoms, 1.4, &at_once),
               Cancelled);
}

TEST(ExcludedDistances, RefusesWrongInput) {
  const SphereSet atoms({{{0, 0, 0}, 1.7}});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double wrong : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(measure({{0, 0, 0}}, atoms, wrong), InvalidInput);
    EXPECT_THROW(excluded_distances(speck_at({5, 0, 0}), atoms, wrong), InvalidInput);
  }
  EXPECT_THROW(measure({{0, nan, 0}}, atoms, 1.4), InvalidInput);
  EXPECT_THROW(measure({{0, 0, 0}}, SphereSet(), 1.4), InvalidInput);
  EXPECT_THROW(excluded_distances(IndexedMesh{}, atoms, 1.4), InvalidInput);
  DistanceOptions little;
  little.memory_limit = 1000;
  EXPECT_THROW(excluded_distances(speck_at({5, 0, 0}), atoms, 1.4, little), LimitExceeded);
  EXPECT_TRUE(measure({}, atoms, 1.4).empty());
}

}  // namespace
}  // namespace vdwmesh::testing
