// measure_by_sectors(): divide and conquer over parts of the sphere.
//
// 1. The sphere is divided into eight octants: spherical triangles, each bounded by three planes
//    through the centre. Every octant gets the caps that reach it.
// 2. A sector that more than `most_caps` caps reach is halved across its longest side, recursively,
//    as long as this reduces the number of caps.
// 3. The kernel measures each sector: measure_ball() with the sector's planes as three more caps of
//    cosine 0.
// The octants run in parallel. Their results are added in a fixed order.
#include "arrangement/arcs/arc_sectors.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "arrangement/directions.hpp"

namespace vdwmesh::arcs {
namespace {

// A spherical triangle and the planes through its sides and the centre.
struct Sector {
  std::array<Vec3d, 3> corner;  // unit vectors, counter-clockwise seen from outside
  std::array<Vec3d, 3> normal;  // unit, out of the sector; plane k is opposite to corner k
};

// Returns an orthonormal basis without symmetry: x, y and z axes for the octants. The coordinate
// axes would be a bad choice, because in a lattice radical planes coincide with the planes between
// octants.
std::array<Vec3d, 3> frame() {
  const Vec3d x = unit({0.31337, 0.72701, 0.61093});
  const Vec3d y = unit(cross(x, {0.91231, -0.22373, 0.17713}));
  return {x, y, cross(x, y)};
}

constexpr unsigned kOctants = 8;

// The octant whose corner k is minus axis k if bit k of `signs` is set, else plus axis k.
Sector octant(unsigned signs) {
  Sector s{};
  const std::array<Vec3d, 3> axes = frame();
  for (unsigned k = 0; k < 3; ++k) {
    s.corner[k] = (signs >> k & 1 ? -1.0 : 1.0) * axes[k];
    s.normal[k] = -1.0 * s.corner[k];
  }
  // An odd number of reversed axes makes the corners clockwise.
  const bool mirrored = (signs & 1) ^ (signs >> 1 & 1) ^ (signs >> 2 & 1);
  if (mirrored) {
    std::swap(s.corner[1], s.corner[2]);
    std::swap(s.normal[1], s.normal[2]);
  }
  return s;
}

// Halves a sector by a plane through the middle of its longest side, ab, and the corner k opposite
// to it. The halves have the same numbers for their common plane, up to the sign, and the planes of
// the sector are handed on unchanged. So no sliver is counted twice or left out.
std::array<Sector, 2> halves(const Sector& s) {
  std::size_t k = 0;
  // The cosine of the side opposite to corner i: the least cosine belongs to the longest side.
  const auto side = [&](std::size_t i) {
    return dot(s.corner[(i + 1) % 3], s.corner[(i + 2) % 3]);
  };
  for (std::size_t i = 1; i < 3; ++i) k = side(i) < side(k) ? i : k;
  const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
  const Vec3d middle = unit(s.corner[a] + s.corner[b]);
  const Vec3d plane = unit(cross(s.corner[k], middle));
  return {{{{s.corner[k], s.corner[a], middle}, {s.normal[k], plane, s.normal[b]}},
           {{s.corner[k], middle, s.corner[b]}, {s.normal[k], s.normal[a], -1.0 * plane}}}};
}

// Whether a cap reaches a sector, or comes so near that the kernel might have a doubt about it.
// This is a filter: it may say yes for a cap that does not reach the sector, but never no for one
// that does. It says no only if the cap lies wholly beyond one of the sector's planes, or outside a
// circle around the sector.
class MayReachSector {
 public:
  explicit MayReachSector(const Sector& sector)
      : sector_(sector), middle_(unit(sector.corner[0] + sector.corner[1] + sector.corner[2])) {
    for (const Vec3d& corner : sector.corner) cosine_ = std::min(cosine_, dot(middle_, corner));
    sine_ = sine_of(cosine_);
  }

  bool operator()(const Cap& cap) const {
    const double cosine = cap.cosine - kParallelGap;  // a slightly larger cap
    if (cosine <= 0) return true;  // the half-space holds the centre, a point of every sector
    const double sine = sine_of(cosine), toward = dot(cap.axis, middle_);
    // The cap lies beyond a plane if the angle from the plane to the axis exceeds the cap's angle.
    for (const Vec3d& normal : sector_.normal) {
      if (dot(cap.axis, normal) > sine + kCoarseRounding) return false;
    }
    // The circle of angle acos(cosine_) around middle_ contains the sector. If the axis is outside,
    // its angle to the nearest point of that circle is acos(toward) - acos(cosine_). The cosine of
    // this difference is compared with the cap's.
    return toward >= cosine_ || toward * cosine_ + sine_of(toward) * sine_ >= cosine;
  }

 private:
  static double sine_of(double cosine) {
    return std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
  }

  const Sector& sector_;
  Vec3d middle_;
  double cosine_ = 1, sine_ = 0;  // of the angle between middle_ and the farthest corner
};

// Returns the caps that may reach the sector, in their order.
std::vector<Cap> caps_in(const Sector& sector, std::span<const Cap> caps) {
  std::vector<Cap> found;
  std::copy_if(caps.begin(), caps.end(), std::back_inserter(found), MayReachSector(sector));
  return found;
}

BallMeasures operator+(const BallMeasures& a, const BallMeasures& b) {
  return {a.area + b.area, a.volume + b.volume, a.doubts | b.doubts};
}

// Measures a sector by recursive halving.
class SectorSum {
 public:
  // A sector with up to this number of caps is not halved.
  explicit SectorSum(std::size_t most_caps) : most_caps_(most_caps) {}

  // Returns area and volume of the ball's parts in the sector. `caps` are those that may reach it,
  // in any order; the call sorts them and may append the sector's planes. `halvings`: how many
  // halvings led to this sector.
  BallMeasures measure(const Sector& sector, std::vector<Cap>& caps, int halvings = 0) {
    // A halving about halves the area. So after 40 of them the sides are still about 2^-20 long,
    // far above rounding.
    constexpr int kMostHalvings = 40;
    if (caps.size() <= most_caps_ || halvings == kMostHalvings) return measure_here(sector, caps);
    const std::array<Sector, 2> parts = halves(sector);
    std::vector<Cap> first = caps_in(parts[0], caps), second = caps_in(parts[1], caps);
    // If the halves together have more than 3/2 of the caps, most caps reach both halves, as in a
    // bundle of nearly equal circles. Further halving would not separate them either.
    if (2 * (first.size() + second.size()) > 3 * caps.size()) return measure_here(sector, caps);
    return measure(parts[0], first, halvings + 1) + measure(parts[1], second, halvings + 1);
  }

 private:
  // The planes of the sector are caps with the cosine 0: half-spaces beyond the centre.
  BallMeasures measure_here(const Sector& sector, std::vector<Cap>& caps) {
    for (const Vec3d& normal : sector.normal) caps.push_back({normal, 0});
    return measure_ball(caps.data(), static_cast<std::uint32_t>(caps.size()),
                        space_.reserve(caps.size(), caps.size()));
  }

  std::size_t most_caps_;
  CellSpace space_;  // reused from sector to sector
};

// Measures the ball in one piece, with enough memory for all its caps.
BallMeasures measure_whole(std::span<const Cap> caps) {
  CellSpace space;
  std::vector<Cap> copy(caps.begin(), caps.end());
  return measure_ball(copy.data(), static_cast<std::uint32_t>(copy.size()),
                      space.reserve(copy.size(), copy.size()));
}

}  // namespace

// Arrays grow by a factor of two or more, so that a run over many balls allocates rarely. A convex
// body of n faces has fewer than 3 n edges.
ArcWorkspace CellSpace::reserve(std::size_t caps, std::size_t faces) {
  if (nudged_.size() < caps) nudged_.resize(2 * caps);
  if (faces_.size() < faces) {
    faces_.resize(std::max(faces, 2 * faces_.size()));
    active_.resize(faces_.size());
    edges_.resize(3 * faces_.size() + 8);
  }
  return {faces_.data(),
          active_.data(),
          static_cast<std::uint32_t>(faces_.size()),
          edges_.data(),
          static_cast<std::uint32_t>(edges_.size()),
          nudged_.data()};
}

BallMeasures measure_by_sectors(std::span<const Cap> caps, std::size_t most_caps) {
  std::array<Sector, kOctants> octants;
  std::array<std::vector<Cap>, kOctants> near;  // per octant: the caps that may reach it
  std::size_t total = 0;
  for (unsigned signs = 0; signs < kOctants; ++signs) {
    octants[signs] = octant(signs);
    near[signs] = caps_in(octants[signs], caps);
    total += near[signs].size();
  }
  // If a cap reaches more than half of the octants on average, most caps overlap each other, and
  // division into sectors would multiply the work instead of dividing it.
  if (2 * total > kOctants * caps.size()) return measure_whole(caps);
  std::array<BallMeasures, kOctants> parts{};
  // The caller's loop over balls uses memory of its thread, which includes `caps`. A thread that
  // waits here for the octants could otherwise take up a task of that loop, measure another ball in
  // the same memory and overwrite these caps. Isolation prevents it.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(0u, kOctants, [&](unsigned i) {
      parts[i] = SectorSum(most_caps).measure(octants[i], near[i]);
    });
  });
  BallMeasures sum{0, 0, 0};
  for (const BallMeasures& part : parts) sum = sum + part;
  return sum;
}

}  // namespace vdwmesh::arcs
