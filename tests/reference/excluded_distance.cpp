// ExcludedDistance: best-first search in an octree around the point.
#include "reference/excluded_distance.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace vdwmesh::reference {

struct ExcludedDistance::Cube {
  Point middle;
  double half;   // of an edge, Å
  double lower;  // of the distance of its points from the point asked for, Å
  bool operator<(const Cube& other) const { return lower > other.lower; }  // the nearest on top
};

// Looks for the nearest place on the other side of the surface than `at`.
class ExcludedDistance::Search {
 public:
  Search(const ExcludedDistance& owner, const Point& at, bool inside, double upper)
      : owner_(owner), at_(at), inside_(inside), upper_(upper) {
    owner.accessible_.narrow(owner.accessible_.all(), at, upper * std::sqrt(3.0) + owner.probe_,
                             near_);
  }

  DistanceBounds run(double width) {
    std::priority_queue<Cube> open;
    open.push({at_, upper_, 0});
    double lower = upper_;
    while (!open.empty()) {
      const Cube cube = open.top();
      lower = std::min(cube.lower, upper_);
      if (upper_ - lower <= width) break;
      open.pop();
      lower = upper_;
      if (!may_hold(cube)) continue;
      for (int octant = 0; octant < 8; ++octant) {
        const Cube part = octant_of(cube, octant);
        if (part.lower < upper_) open.push(part);
      }
    }
    return {lower, upper_};
  }

 private:
  // How far beyond the surface a place is, Å: above 0 on the other side.
  double beyond(const Point& place) const {
    const double depth = owner_.accessible_.nearest(place, near_).distance - owner_.probe_;
    return inside_ ? -depth : depth;
  }

  bool may_hold(const Cube& cube) {
    const double here = beyond(cube.middle);
    if (here < -cube.half * std::sqrt(3.0)) return false;
    if (here > 0) approach(cube.middle);
    return true;
  }

  // Bisects the way to a place that is beyond the surface.
  void approach(const Point& place) {
    double near = 0, far = 1;
    for (int step = 0; step < 40; ++step) {
      const double middle = 0.5 * (near + far);
      (beyond(at_ + middle * (place - at_)) > 0 ? far : near) = middle;
    }
    upper_ = std::min(upper_, far * distance(at_, place));
  }

  Cube octant_of(const Cube& cube, int octant) const {
    Cube part{cube.middle, 0.5 * cube.half, 0};
    double squared = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      part.middle[axis] += (octant >> axis & 1) != 0 ? part.half : -part.half;
      const double off = std::abs(at_[axis] - part.middle[axis]) - part.half;
      squared += off > 0 ? off * off : 0;
    }
    part.lower = std::sqrt(squared);
    return part;
  }

  const ExcludedDistance& owner_;
  Point at_;
  bool inside_;
  double upper_;
  AccessibleDistance::Candidates near_;
};

ExcludedDistance::ExcludedDistance(const std::vector<Ball>& atoms, double probe)
    : atoms_(atoms), probe_(probe), accessible_(atoms, probe) {}

// Atoms are in the solid, and accessible places are not: one of either bounds the search.
DistanceBounds ExcludedDistance::bounds(const Point& at, double width) const {
  const NearestAccess access = accessible_.nearest(at);
  const bool inside = access.distance >= probe_;
  double upper = access.distance;
  if (!inside) {
    upper = distance(at, atoms_[0].center);
    for (const Ball& atom : atoms_) upper = std::min(upper, distance(at, atom.center));
  }
  const DistanceBounds found = Search(*this, at, inside, upper).run(width);
  return inside ? DistanceBounds{-found.upper, -found.lower} : found;
}

}  // namespace vdwmesh::reference
