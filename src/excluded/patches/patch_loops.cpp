// join_loops(): chains segments by the names of the circles that meet in their ends.
//
// Gauss–Bonnet gives the area on the left of each loop as if it bounded a disk: 2 π + Σ φ h - Σ ε,
// with the angles φ of the segments, the cosines h of their circles and the exterior angles ε. The
// polygon of all sides is a disk in a hemisphere. So a loop with a segment of a side bounds a piece
// from outside. A loop of caps alone is the rim of a hole if the area on its left is 2 π or more.
#include "excluded/patches/patch_loops.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "spheres/directions.hpp"

namespace vdwmesh::excluded {
namespace {

constexpr double kPi = std::numbers::pi;
// Solid angle. It is far more than the rounding of a loop's area, and far less than a hemisphere
// has beside a piece that caps alone bound.
constexpr double kRounding = 1e-6;

class LoopJoiner {
 public:
  explicit LoopJoiner(ConcavePatch& patch) : patch_(patch) {}

  void run() {
    const std::vector<Loop> all = loops();
    std::vector<const Loop*> outer;
    // Without a side the patch is the whole sphere less its caps.
    if (patch_.sides.empty()) {
      patch_.pieces.push_back({4 * kPi, {0, 0, 0}, 0});
      outer.push_back(nullptr);
    }
    for (const Loop& loop : all) {
      if (loop.hole) continue;
      patch_.pieces.push_back({0, {0, 0, 0}, 0});
      add_to_piece(static_cast<std::uint32_t>(outer.size()), loop, loop.solid_angle);
      outer.push_back(&loop);
    }
    // There are holes, but no piece: a decision was wrong.
    if (outer.empty() && !all.empty()) {
      patch_.certified = false;
      patch_.pieces.push_back({4 * kPi, {0, 0, 0}, 0});
    }
    for (const Loop& loop : all) {
      if (loop.hole) add_to_piece(piece_around(loop, outer), loop, loop.solid_angle - 4 * kPi);
    }
  }

 private:
  std::uint32_t cap_count() const { return static_cast<std::uint32_t>(patch_.caps.size()); }
  Vec3d axis_of(std::uint32_t circle) const {
    const std::uint32_t caps = cap_count();
    return circle < caps ? patch_.caps[circle].axis : -1.0 * patch_.sides[circle - caps].inward;
  }
  double cosine_of(std::uint32_t circle) const {
    return circle < cap_count() ? patch_.caps[circle].cosine : 0;
  }

  // The segment behind another one on its loop.
  std::optional<std::uint32_t> successor(const PatchSegment& s) const {
    for (std::uint32_t i = 0; i < patch_.segments.size(); ++i) {
      const PatchSegment& other = patch_.segments[i];
      if (other.circle == s.next && other.before == s.circle) return i;
    }
    return std::nullopt;
  }

  struct Loop {
    double solid_angle;
    Vec3d vector;
    std::vector<std::uint32_t> segments;
    bool hole;
  };

  Vec3d vector_of(const PatchSegment& s) const {
    const Vec3d axis = axis_of(s.circle);
    const double h = cosine_of(s.circle), squared_sine = (1 - h) * (1 + h);
    return -0.5 * ((squared_sine * s.angle) * axis - h * cross(axis, s.to - s.from));
  }

  // Joins the segments to loops. A loop that does not close is left out, and not certified.
  std::vector<Loop> loops() {
    std::vector<Loop> out;
    std::vector<std::uint8_t> used(patch_.segments.size(), 0);
    for (std::uint32_t first = 0; first < used.size(); ++first) {
      if (used[first]) continue;
      Loop loop{2 * kPi, {0, 0, 0}, {}, true};
      std::optional<std::uint32_t> i = first;
      while (i && !used[*i]) {
        used[*i] = 1;
        const PatchSegment& s = patch_.segments[*i];
        loop.solid_angle += s.angle * cosine_of(s.circle) - s.turning;
        loop.vector = loop.vector + vector_of(s);
        loop.segments.push_back(*i);
        loop.hole = loop.hole && s.circle < cap_count();
        i = s.next == kNoIndex && s.before == kNoIndex ? first : successor(s);
      }
      if (i != first) patch_.certified = false;
      loop.hole = loop.hole && loop.solid_angle > 2 * kPi - kRounding;
      out.push_back(std::move(loop));
    }
    return out;
  }

  void add_to_piece(std::uint32_t piece, const Loop& loop, double solid_angle) {
    PatchPiece& p = patch_.pieces[piece];
    p.solid_angle += solid_angle;
    p.vector = p.vector + loop.vector;
    ++p.loops;
    for (const std::uint32_t s : loop.segments) patch_.segments[s].piece = piece;
  }

  // The piece in which a hole is: the smallest of the pieces whose outer loop is around it.
  std::uint32_t piece_around(const Loop& hole, const std::vector<const Loop*>& outer) {
    if (outer.size() == 1) return 0;
    const Vec3d& point = patch_.segments[hole.segments[0]].from;
    std::uint32_t best = kNoIndex;
    for (std::uint32_t i = 0; i < outer.size(); ++i) {
      if (outer[i] != nullptr && !is_inside(point, *outer[i])) continue;
      if (best == kNoIndex || patch_.pieces[i].solid_angle < patch_.pieces[best].solid_angle) {
        best = i;
      }
    }
    if (best == kNoIndex) patch_.certified = false;
    return best == kNoIndex ? 0 : best;
  }

  // Whether a loop is around a point. Half a great circle leads from the point, through the
  // hemisphere without the polygon, to the opposite point, which is outside of the polygon. The
  // loop is around the point if it crosses this half an odd number of times.
  bool is_inside(const Vec3d& point, const Loop& loop) const {
    Vec3d away{0, 0, 0};
    for (const PatchSide& s : patch_.sides) away = away - s.contact[0];
    const Vec3d toward = unit(away - dot(away, point) * point);
    bool inside = false;
    for (const std::uint32_t i : loop.segments) {
      inside ^= (crossings(patch_.segments[i], point, toward) & 1) != 0;
    }
    return inside;
  }

  // How often a segment crosses the half great circle cos(τ) point + sin(τ) toward, 0 < τ < π.
  int crossings(const PatchSegment& s, const Vec3d& point, const Vec3d& toward) const {
    const Vec3d axis = axis_of(s.circle);
    const double x = dot(axis, point), y = dot(axis, toward), size = std::hypot(x, y);
    const double ratio = cosine_of(s.circle) / size;
    if (!(std::abs(ratio) < 1)) return 0;
    int count = 0;
    for (const double sign : {-1.0, 1.0}) {
      const double tau = std::remainder(std::atan2(y, x) + sign * std::acos(ratio), 2 * kPi);
      if (tau <= 0) continue;
      const Vec3d w = std::cos(tau) * point + std::sin(tau) * toward;
      const Vec3d from = s.from - dot(s.from, axis) * axis, at = w - dot(w, axis) * axis;
      double angle = -std::atan2(triple_product(axis, from, at), dot(from, at));
      if (angle < 0) angle += 2 * kPi;
      count += angle < s.angle;
    }
    return count;
  }

  ConcavePatch& patch_;
};

}  // namespace

void join_loops(ConcavePatch& patch) { LoopJoiner(patch).run(); }

}  // namespace vdwmesh::excluded
