// Which points of a sphere are in the covered caps beside a patch, and which keep clear of them, so
// that they do not make flat triangles with the pieces of its arcs. For host and device.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "creases/arcs/patch_boundary.hpp"
#include "creases/patch/patch_memory.hpp"
#include "creases/sine_cosine.hpp"

namespace vdwmesh {

class Monitor;

// Finds the caps that matter for a point of the unit sphere. With few caps these are all of them.
// On the host many caps are kept in an octree: a cube has the list of those that come near to it,
// or a single one that covers it. Then the time for a point does not grow with their number.
template <class Memory>
class CapTree {
 public:
  VDWMESH_HD explicit CapTree(std::span<const CoveredCap> caps) : caps_(caps) {}

  // Whether test(i) holds for any cap i that covers u or, after build(), comes near to it.
  template <class Test>
  VDWMESH_HD bool holds_for_any(const Vec3d& u, const Test& test) const {
    if constexpr (!Memory::kIsBounded) {
      if (!cubes_.empty()) {
        for (const std::uint32_t i : near(u)) {
          if (test(i)) return true;
        }
        return false;
      }
    }
    return vdwmesh::holds_for_any<Memory>(caps_.size(), test);
  }
  // How many caps are tested for u at most.
  VDWMESH_HD std::size_t tests(const Vec3d& u) const {
    if constexpr (!Memory::kIsBounded) {
      if (!cubes_.empty()) return near(u).size();
    }
    return caps_.size();
  }

  // Many caps are sorted into the tree, for the host alone. A point u comes near to cap i if its
  // product with the axis is above bounds[i], a cosine that is at most that of the cap.
  void build(std::span<const double> bounds, Monitor* monitor);

 private:
  struct Cube {
    Vec3d center;
    double half_width;
    std::uint32_t first, count;  // its part of lists_
    std::uint32_t children;      // the first of eight; 0: none
  };
  std::span<const std::uint32_t> near(const Vec3d& u) const;

  std::span<const CoveredCap> caps_;
  typename Memory::template Array<Cube> cubes_;
  typename Memory::template Array<std::uint32_t> lists_;
};
template <>
void CapTree<GrowingMemory>::build(std::span<const double> bounds, Monitor* monitor);
template <>
std::span<const std::uint32_t> CapTree<GrowingMemory>::near(const Vec3d& u) const;

template <class Memory>
class CapMargins {
 public:
  // `margin`: an angle, rad. Precondition: there is a cap. `scratch` is for the bounds.
  //
  // The cosine of a cap's angular radius with the margin is that of a sum. If the sum is more than
  // half a turn, so that they cover the whole sphere, the bound of -2 admits no point.
  VDWMESH_HD CapMargins(std::span<const CoveredCap> caps, double margin,
                        typename Memory::template Array<double>& scratch)
      : caps_(caps), bounds_(scratch) {
    const SineCosine of_margin = sine_cosine(margin);
    bounds_.clear();
    for (const CoveredCap& cap : caps) {
      const double c = std::min(std::max(cap.cosine, -1.0), 1.0);
      const double sum = c * of_margin.cosine - std::sqrt((1 - c) * (1 + c)) * of_margin.sine;
      bounds_.push_back(c > -of_margin.cosine ? sum : -2);
    }
  }

  // Whether one of the caps `some`, with its margin, covers all points that are up to the angle
  // `radius` (rad) from a point. If none is found, `near` gets those of them that may meet the
  // points. Rounding has 1e-7 rad of room.
  bool covers(const Vec3d& center, double radius, std::span<const std::uint32_t> some,
              std::vector<std::uint32_t>& near) const {
    constexpr double kRoom = 1e-7;
    for (const std::uint32_t i : some) {
      if (bounds_[i] < -1) return true;
      const double apart = 2 * std::asin(std::min(1.0, norm(center - caps_[i].axis) / 2));
      const double reach = std::acos(std::min(bounds_[i], 1.0));
      if (apart + radius + kRoom < reach) return true;
      if (!(apart - radius - kRoom > reach)) near.push_back(i);
    }
    return false;
  }

  // Begins with the cap that the point before was too near to: mostly this one is, too.
  VDWMESH_HD bool is_clear(const Vec3d& u, const CapTree<Memory>& tree) {
    const auto is_near = [&](std::size_t cap) {
      const bool is = !(dot(u, caps_[cap].axis) <= bounds_[cap]);
      if (is) last_ = cap;
      return is;
    };
    return !is_near(last_) && !tree.holds_for_any(u, is_near);
  }
  std::span<const double> bounds() const { return bounds_; }

 private:
  std::span<const CoveredCap> caps_;
  typename Memory::template Array<double>& bounds_;
  std::size_t last_ = 0;
};

}  // namespace vdwmesh
