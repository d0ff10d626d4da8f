// The space between the excluded surfaces of two probes, by pockets: closed forms by quadrature,
// counting in a lattice of points from the definition alone, and what has to stay.
#include "excluded/two_probe_shell.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/disjoint_sets.hpp"
#include "core/errors.hpp"
#include "core/no_index.hpp"
#include "reference/accessible_distance.hpp"
#include "reference/excluded_forms.hpp"
#include "spheres/box.hpp"
#include "support/dice.hpp"
#include "support/shared_files.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

using reference::Ball;
using reference::ExcludedForm;
using reference::Point;

// Relative. Quadrature and patches round in the 14th digit; the volumes of shells are differences.
constexpr double kForm = 1e-11;
// Of the sums over pockets beside the difference of two measures.
constexpr double kSumOfPockets = 1e-10;

void expect_near(double found, double expected, double tolerance) {
  EXPECT_NEAR(found, expected, tolerance * std::max(1.0, std::abs(expected)));
}

SphereSet set_of(const std::vector<Ball>& balls) {
  std::vector<Sphere> spheres;
  for (const Ball& b : balls) {
    spheres.push_back({{b.center[0], b.center[1], b.center[2]}, b.radius});
  }
  return SphereSet(spheres);
}

double ball_volume(double r) { return 4 * std::numbers::pi / 3 * r * r * r; }
double ball_area(double r) { return 4 * std::numbers::pi * r * r; }

// What holds for every shell that is divided.
void expect_sound(const TwoProbeShell& shell) {
  ASSERT_EQ(shell.doubt, "");
  double sum = 0, last = std::numeric_limits<double>::infinity();
  for (const ShellPocket& pocket : shell.pockets) {
    EXPECT_LE(pocket.volume, last);
    EXPECT_GT(pocket.volume, -1e-9);
    EXPECT_EQ(pocket.mouths, 1u);
    EXPECT_GT(pocket.mouth_area, 0);
    EXPECT_GE(pocket.area, 0);
    sum += last = pocket.volume;
  }
  expect_near(sum, shell.volume(), kSumOfPockets);
  EXPECT_LT(shell.closure, 1e-8);
}

void expect_pocket(const ShellPocket& pocket, double volume, double area, double mouth_area) {
  expect_near(pocket.volume, volume, kForm);
  expect_near(pocket.area, area, kForm);
  expect_near(pocket.mouth_area, mouth_area, kForm);
}

double reentrant(const ExcludedForm& form) { return form.saddle + form.concave; }

TEST(TwoProbeShell, BallsAloneHaveNone) {
  for (const double apart : {0.0, 100.0}) {
    std::vector<Ball> balls{{{{1, 2, 3}}, 1.5}};
    if (apart > 0) balls.push_back({{{1, 2, 3 + apart}}, 1.7});
    const TwoProbeShell shell = two_probe_shell(set_of(balls), 1, 4);
    expect_sound(shell);
    EXPECT_TRUE(shell.pockets.empty());
    EXPECT_NEAR(shell.volume(), 0, 1e-12);
  }
}

// A ring around two balls that are near: probes roll around both.
TEST(TwoProbeShell, RingAroundTwoBalls) {
  for (const double apart : {1.5, 2.5, 3.5}) {
    const Ball a{{{0, 0, 0}}, 1.5}, b{{{apart, 0, 0}}, 1.9};
    for (const auto& [small, large] : {std::pair{1.0, 4.0}, {0.5, 1.2}, {1.4, 1.41}, {2, 30}}) {
      const ExcludedForm s = excluded_two_balls(a, b, small), l = excluded_two_balls(a, b, large);
      const TwoProbeShell shell = two_probe_shell(set_of({a, b}), small, large);
      expect_sound(shell);
      ASSERT_EQ(shell.pockets.size(), 1u);
      expect_pocket(shell.pockets[0], l.volume - s.volume, s.area() - l.contact, reentrant(l));
      EXPECT_EQ(shell.pockets[0].lining, (std::vector<SphereId>{0, 1}));
      EXPECT_EQ(shell.pockets[0].islands, 0u);
    }
  }
}

// Balls so far apart that the large probe reaches their axis between them: a pocket at each ball.
TEST(TwoProbeShell, TwoPocketsUnderCusps) {
  const Ball a{{{0, 0, 0}}, 1.5}, b{{{0, 6, 0}}, 1.9};
  for (const double small : {0.5, 1.4}) {
    const double large = 1.6;
    const TwoProbeShell shell = two_probe_shell(set_of({a, b}), small, large);
    expect_sound(shell);
    ASSERT_EQ(shell.pockets.size(), 2u);
    std::vector<double> expected;
    for (const auto& [first, second] : {std::pair{a, b}, {b, a}}) {
      // The small probe rolls around neither, or makes cusps too.
      const double share =
          small < 1 ? ball_volume(first.radius) : share_of_first(first, second, small).volume;
      expected.push_back(share_of_first(first, second, large).volume - share);
    }
    std::ranges::sort(expected, std::greater());
    for (std::size_t i = 0; i < 2; ++i) expect_near(shell.pockets[i].volume, expected[i], kForm);
    EXPECT_NE(shell.pockets[0].lining, shell.pockets[1].lining);
  }
}

// The solid of atoms on the corners of a polyhedron, each with `edges` neighbours, around whose
// pairs a probe rolls freely: for each atom its share in each pair, less the balls counted twice.
ExcludedForm necklace(std::size_t atoms, int edges, const Ball& a, const Ball& b, double probe) {
  const ExcludedForm share = share_of_first(a, b, probe);
  const auto n = static_cast<double>(atoms);
  return {.contact = n * (edges * share.contact - (edges - 1) * ball_area(a.radius)),
          .saddle = n * edges * share.saddle,
          .concave = 0,
          .volume = n * (edges * share.volume - (edges - 1) * ball_volume(a.radius))};
}

std::vector<Ball> balls_at(const std::vector<Point>& centers, double radius) {
  std::vector<Ball> balls;
  for (const Point& c : centers) balls.push_back({c, radius});
  return balls;
}

// Six balls in a ring: the small probe passes through, the large one touches all six from above.
TEST(TwoProbeShell, RingOfSix) {
  const double radius = 1.5, edge = 3.4, small = 1.2, large = 3;
  const std::vector<Ball> balls = balls_at(reference::regular_polygon(6, edge), radius);
  const ExcludedForm s = necklace(6, 2, balls[0], balls[1], small),
                     l = excluded_cage(reference::hull_cage(reference::regular_polygon(6, edge)),
                                       radius, large, reference::CageSides::outer);
  const TwoProbeShell shell = two_probe_shell(set_of(balls), small, large);
  expect_sound(shell);
  ASSERT_EQ(shell.pockets.size(), 1u);
  expect_pocket(shell.pockets[0], l.volume - s.volume, s.area() - l.contact, reentrant(l));
}

// A ball in a cage through whose windows the small probe goes, all around the ball.
TEST(TwoProbeShell, IslandInACage) {
  const double radius = 1.5, edge = 6, small = 1.6, large = 4, guest = 0.4;
  const std::vector<Point> corners = reference::cube(edge);
  std::vector<Ball> balls = balls_at(corners, radius);
  Point middle{{0, 0, 0}};
  for (const Point& c : corners) middle = middle + 0.125 * c;
  const auto other = std::ranges::find_if(corners, [&](const Point& c) {
    return std::abs(reference::distance(c, corners[0]) - edge) < 1e-9;
  });
  const ExcludedForm s = necklace(8, 3, balls[0], {*other, radius}, small),
                     l = excluded_cage(reference::hull_cage(corners), radius, large,
                                       reference::CageSides::outer);
  balls.push_back({middle, guest});
  const TwoProbeShell shell = two_probe_shell(set_of(balls), small, large);
  expect_sound(shell);
  ASSERT_EQ(shell.pockets.size(), 1u);
  EXPECT_EQ(shell.pockets[0].islands, 1u);
  EXPECT_EQ(shell.pockets[0].lining.size(), 9u);
  expect_pocket(shell.pockets[0], l.volume - s.volume - ball_volume(guest),
                s.area() - l.contact + ball_area(guest), reentrant(l));
}

// Things far apart have the pockets of each.
TEST(TwoProbeShell, PocketsOfSeveralThings) {
  std::vector<Ball> balls;
  std::vector<double> expected;
  for (int k = 0; k < 5; ++k) {
    const Ball a{{{0, 40.0 * k, 0}}, 1.5}, b{{{1.5 + 0.4 * k, 40.0 * k, 0}}, 1.8};
    balls.push_back(a), balls.push_back(b);
    expected.push_back(excluded_two_balls(a, b, 4).volume - excluded_two_balls(a, b, 1).volume);
  }
  std::ranges::sort(expected, std::greater());
  const TwoProbeShell shell = two_probe_shell(set_of(balls), 1, 4);
  expect_sound(shell);
  ASSERT_EQ(shell.pockets.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) expect_near(shell.pockets[i].volume, expected[i], kForm);
}

struct RandomShell {
  std::vector<Ball> balls;
  double small, large;
};

// Some sets are sparse, so that they have islands and many pockets.
RandomShell random_shell(unsigned seed, int most) {
  Dice dice(seed);
  RandomShell out;
  const int count = dice.whole(3, most);
  const double edge = std::cbrt(count) * dice.real(1.5, 6);
  for (int i = 0; i < count; ++i) {
    out.balls.push_back(
        {{{dice.real(0, edge), dice.real(0, edge), dice.real(0, edge)}}, dice.real(0.6, 2)});
  }
  out.small = dice.real(0.3, 1.5);
  out.large = out.small * (dice.one_in(2) ? dice.real(1.05, 1.5) : dice.real(1.5, 10));
  return out;
}

TEST(TwoProbeShell, RandomSetsAreSound) {
  std::size_t pockets = 0, islands = 0, several = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const RandomShell random = random_shell(seed, 60);
    const TwoProbeShell shell = two_probe_shell(set_of(random.balls), random.small, random.large);
    expect_sound(shell);
    pockets += shell.pockets.size();
    several += shell.pockets.size() > 1;
    for (const ShellPocket& pocket : shell.pockets) islands += pocket.islands;
  }
  // So that the sets have what is to be tried.
  EXPECT_GT(pockets, 900u);
  EXPECT_GT(several, 100u);
  EXPECT_GT(islands, 10u);
}

// Whether a point is in the large solid and not in the small one, from the definition alone.
class PlainShell {
 public:
  explicit PlainShell(const RandomShell& shell)
      : small_(shell.balls, shell.small), large_(shell.balls, shell.large), probes_(shell) {}

  bool has(const Point& p) const {
    return small_.nearest(p).distance < probes_.small &&
           large_.nearest(p).distance >= probes_.large;
  }
  bool has_segment(const Point& from, const Point& to) const {
    constexpr int kParts = 32;
    for (int i = 1; i < kParts; ++i) {
      if (!has(from + (static_cast<double>(i) / kParts) * (to - from))) return false;
    }
    return true;
  }

 private:
  reference::AccessibleDistance small_, large_;
  const RandomShell& probes_;
};

// Points of a cubic lattice in a shell. Two are joined if they are up to kReach steps apart along
// each axis and the segment between them is in the shell: where it is thin, as beside the curves in
// which the surfaces part, neighbours alone would leave pieces.
class Lattice {
 public:
  Lattice(const RandomShell& random, double step) : shell_(random), step_(step) {
    Box box = empty_box();
    for (const Ball& b : random.balls) include(box, set_of({b})[0]);
    origin_ = {{box.lower.x, box.lower.y, box.lower.z}};
    const auto count = [&](int axis) {
      return static_cast<int>((box.upper[axis] - box.lower[axis]) / step) + 2;
    };
    size_ = {count(0), count(1), count(2)};
    for (int z = 0; z < size_[2]; ++z) {
      for (int y = 0; y < size_[1]; ++y) {
        for (int x = 0; x < size_[0]; ++x) {
          if (shell_.has(place({x, y, z}))) points_.push_back({x, y, z});
        }
      }
    }
    at_.assign(static_cast<std::size_t>(size_[0] * size_[1] * size_[2]), kNoIndex);
    for (std::uint32_t i = 0; i < points_.size(); ++i) at_[index(points_[i])] = i;
  }

  // The numbers of points of the connected sets, falling.
  std::vector<std::size_t> sets() const {
    DisjointSets sets(points_.size());
    for (const int reach : {1, kReach}) {
      for (std::uint32_t i = 0; i < points_.size(); ++i) join(i, reach, sets);
    }
    std::vector<std::size_t> counts(points_.size(), 0);
    for (std::uint32_t i = 0; i < points_.size(); ++i) ++counts[sets.find(i)];
    std::ranges::sort(counts, std::greater());
    return counts;
  }
  std::size_t size() const { return points_.size(); }

 private:
  static constexpr int kReach = 5;
  using Place = std::array<int, 3>;

  std::size_t index(const Place& p) const {
    return static_cast<std::size_t>((p[2] * size_[1] + p[1]) * size_[0] + p[0]);
  }
  Point place(const Place& p) const {
    return origin_ + step_ * Point{{p[0] - 0.382, p[1] - 0.382, p[2] - 0.382}};
  }
  void join(std::uint32_t i, int reach, DisjointSets& sets) const {
    const Place& a = points_[i];
    for (int z = std::max(a[2] - reach, 0); z <= std::min(a[2] + reach, size_[2] - 1); ++z) {
      for (int y = std::max(a[1] - reach, 0); y <= std::min(a[1] + reach, size_[1] - 1); ++y) {
        for (int x = std::max(a[0] - reach, 0); x <= std::min(a[0] + reach, size_[0] - 1); ++x) {
          const std::uint32_t j = at_[index({x, y, z})];
          if (j == kNoIndex || j >= i || sets.find(i) == sets.find(j)) continue;
          if (shell_.has_segment(place(a), place({x, y, z}))) sets.join(i, j);
        }
      }
    }
  }

  const PlainShell shell_;
  const double step_;  // Å
  Point origin_;
  Place size_;
  std::vector<Place> points_;
  std::vector<std::uint32_t> at_;  // by place: the point's number, or kNoIndex
};

// Pockets and their volumes beside points of a lattice. The count of points in a body of surface A
// has a spread of about (0.2 A / step²)^½, as if each point near the surface fell at random; the
// bar is five times as much. Smaller pockets are left out on both sides.
TEST(TwoProbeShell, LatticePoints) {
  constexpr double kStep = 0.1, kCell = kStep * kStep * kStep, kSmall = 0.3;
  std::size_t compared = 0, with_several = 0;
  for (unsigned seed = 1000; compared < 24; ++seed) {
    SCOPED_TRACE(seed);
    const RandomShell random = random_shell(seed, 7);
    const TwoProbeShell shell = two_probe_shell(set_of(random.balls), random.small, random.large);
    expect_sound(shell);
    // The oracle knows all accessible places, not only those that are joined to the outside.
    if (shell.small.complete.volume != shell.small.exterior->volume) continue;
    const auto bar = [&](double area) { return 5 * kCell * std::sqrt(0.2 * area) / kStep; };
    const Lattice lattice(random, kStep);
    const std::vector<std::size_t> sets = lattice.sets();
    const auto counted = [&](std::size_t i) {
      return i < sets.size() ? static_cast<double>(sets[i]) * kCell : 0;
    };
    std::size_t i = 0;
    double area = 0;
    for (const ShellPocket& pocket : shell.pockets) {
      area += pocket.area + pocket.mouth_area;
      if (pocket.volume < kSmall) continue;
      EXPECT_NEAR(counted(i), pocket.volume, bar(pocket.area + pocket.mouth_area)) << i;
      ++i;
    }
    EXPECT_NEAR(static_cast<double>(lattice.size()) * kCell, shell.volume(), bar(area));
    EXPECT_LT(counted(i), kSmall + bar(area));
    with_several += i > 1;
    ++compared;
  }
  EXPECT_GT(with_several, 3u);
}

// Turned and renumbered sets have the same pockets.
TEST(TwoProbeShell, TurnedAndRenumbered) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const RandomShell random = random_shell(seed, 60);
    const std::size_t n = random.balls.size();
    std::vector<Ball> turned(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Point& c = random.balls[i].center;
      // A turn by an angle about z, then the axes in another order, and a shift.
      const double cosine = std::cos(0.7), sine = std::sin(0.7);
      turned[n - 1 - i] = {
          {{c[2] + 3, cosine * c[0] - sine * c[1] - 1, sine * c[0] + cosine * c[1]}},
          random.balls[i].radius};
    }
    const TwoProbeShell a = two_probe_shell(set_of(random.balls), random.small, random.large),
                        b = two_probe_shell(set_of(turned), random.small, random.large);
    ASSERT_EQ(a.pockets.size(), b.pockets.size());
    for (std::size_t i = 0; i < a.pockets.size(); ++i) {
      expect_near(b.pockets[i].volume, a.pockets[i].volume, 1e-10);
      expect_near(b.pockets[i].area, a.pockets[i].area, 1e-10);
      expect_near(b.pockets[i].mouth_area, a.pockets[i].mouth_area, 1e-10);
      EXPECT_EQ(b.pockets[i].islands, a.pockets[i].islands);
      // Pockets of equal volume may change places.
      EXPECT_EQ(b.pockets[i].lining.size(), a.pockets[i].lining.size());
    }
  }
}

TEST(TwoProbeShell, MoleculesSumToTheDifference) {
  for (const char* name : {"1CRN", "1UBQ", "4PTI", "133D"}) {
    const std::string file = std::string("reference/") + name + ".xyzr";
    VDWMESH_NEEDS_SHARED(file);
    const SphereSet atoms = read_xyzr(shared_path(file));
    for (const auto& [small, large] : {std::pair{1.4, 4.0}, {1.4, 1.5}, {0.6, 1.0}}) {
      SCOPED_TRACE(std::string(name) + ' ' + std::to_string(large));
      const TwoProbeShell shell = two_probe_shell(atoms, small, large);
      expect_sound(shell);
      const auto exterior = [&](double probe) {
        return excluded_measures(atoms, {.probe = probe, .exterior = true}).exterior->volume;
      };
      expect_near(shell.volume(), exterior(large) - exterior(small), kSumOfPockets);
      EXPECT_FALSE(shell.pockets.empty());
    }
  }
}

TEST(TwoProbeShell, LargeProbeIsTheLarger) {
  const SphereSet atoms({{{0, 0, 0}, 1.5}});
  EXPECT_THROW(two_probe_shell(atoms, 2, 2), InvalidInput);
  EXPECT_THROW(two_probe_shell(atoms, 2, 1), InvalidInput);
  EXPECT_THROW(two_probe_shell(atoms, 0, 1), InvalidInput);
  EXPECT_THROW(two_probe_shell(atoms, 2, std::nan("")), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::testing
