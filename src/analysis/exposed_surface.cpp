// The boundary of a union of balls as patches (ExposedSurface), and the distance from points to it
// (SurfaceFinder).
//
// Construction treats every sphere by itself, on all cores (PatchBuilder):
//  1. Find the covers of the sphere, the caps that neighbours from the cell list cut from it. If a
//     neighbour buries the sphere, the sphere has no patch.
//  2. Sort the covers by decreasing size and drop caps that lie within others.
//  3. Intersect the circles of every two covers. An intersection that no third cap covers is a
//     corner, and both circles have exposed arcs there.
//  4. A circle without corners is exposed as a whole or not at all; one of its points decides.
//
// A cap is given by its axis, the unit vector to the other centre, and the cosine of its angle,
// which is also the distance of its plane from the centre of the sphere in units of the radius
// (arc_cap.hpp). The smaller the cosine, the larger the cap.
//
// Search: the nearest point of a patch is the radial projection of the query, or a point of an
// exposed arc, or a corner (update_nearest()). A BoxTree over the balls selects the patches to
// examine.
#include "analysis/exposed_surface.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "arrangement/arcs/ball_caps.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kSpheresPerBlock = 64;
// Circles count as parallel, without common points, if the squared sine of the angle between their
// planes is at most this. The angle is then at most 1e-9, and the line of intersection of the
// planes has at most seven correct digits. If such circles do cross, all points of one are within
// 2e-9 radii of the plane of the other.
constexpr double kParallel = 1e-18;
// A cap is dropped only if it lies within a larger one by this margin in the cosine, about 90
// roundings. Keeping a nested cap is always correct; dropping it only saves time.
constexpr double kNested = 1e-14;

// The patches of one block of spheres, and the covers and corners to which they refer. A vector may
// move its elements when it grows, so set_spans() sets the spans of the patches after all elements
// have been added. Until then the covers of patch i are the elements covers_end[i - 1] (0 for
// i = 0) to covers_end[i] - 1 of `covers`; corners_end gives its corners in the same way.
struct BlockPatches {
  std::vector<Patch> patches;
  std::vector<std::size_t> covers_end, corners_end;
  std::vector<Cover> covers;
  std::vector<Corner> corners;

  // Sets the spans of all patches.
  void set_spans() {
    covers.shrink_to_fit();
    corners.shrink_to_fit();
    std::size_t cover = 0, corner = 0;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      patches[i].covers = std::span(covers).subspan(cover, covers_end[i] - cover);
      patches[i].corners = std::span(corners).subspan(corner, corners_end[i] - corner);
      cover = covers_end[i];
      corner = corners_end[i];
    }
  }
};

// A strict order of covers: larger caps first, of equal caps the one with the lower list place.
bool comes_first(const Cover& a, const Cover& b) {
  return arcs::same_cap(a.cap, b.cap) ? a.place < b.place : arcs::cuts_deeper(a.cap, b.cap);
}

// Returns cos(φ - ψ), where φ and ψ are the angles of the two caps: cos φ cos ψ + sin φ sin ψ.
double cosine_between(const arcs::Cap& a, const arcs::Cap& b) {
  const double sines = (1 - a.cosine) * (1 + a.cosine) * ((1 - b.cosine) * (1 + b.cosine));
  return a.cosine * b.cosine + std::sqrt(sines);
}

// Returns whether the larger cap contains the smaller one: the angle between their axes is at most
// the angle of the large cap less the angle of the small one. The cosines of both are compared.
// The margin makes the test one-sided: it may miss a nested cap, and it never finds one wrongly.
bool contains_cap(const arcs::Cap& large, const arcs::Cap& small) {
  return arcs::same_cap(large, small) ||
         arcs::inner(large.axis, small.axis) > cosine_between(large, small) + kNested;
}

// Removes caps that lie within others and moves the kept ones to the front. Precondition: the
// covers are sorted by comes_first(), largest first, so a cap can only lie within an earlier one.
void drop_nested(std::vector<Cover>& covers) {
  std::size_t kept = 0;
  for (const Cover& cover : covers) {
    const auto last = covers.begin() + static_cast<std::ptrdiff_t>(kept);
    const bool nested = std::any_of(covers.begin(), last,
                                    [&](const Cover& c) { return contains_cap(c.cap, cover.cap); });
    if (!nested) covers[kept++] = cover;
  }
  covers.resize(kept);
}

// Builds the patch of one sphere after another. The vectors keep their memory between spheres.
class PatchBuilder {
 public:
  explicit PatchBuilder(const CellListView& list) : list_(list) {}

  // Appends the patch of the sphere at this list place to `out`, unless the sphere is buried.
  void add(std::uint32_t place, BlockPatches& out) {
    covers_.clear();
    if (!caps_.find(list_, place)) return;
    for (std::size_t i = 0; i < caps_.caps().size(); ++i)
      covers_.push_back({caps_.caps()[i], caps_.neighbors()[i]});
    std::sort(covers_.begin(), covers_.end(), comes_first);
    drop_nested(covers_);
    find_corners(place);
    find_whole_circles();
    const auto circles =
        static_cast<std::uint32_t>(std::count(exposed_.begin(), exposed_.end(), 1));
    // An exposed part of a sphere with covers is bounded by exposed arcs. If there are covers but
    // no such arcs, the whole sphere is covered. Without covers the whole sphere is exposed.
    if (circles == 0 && !covers_.empty()) return;
    // Covers with exposed arcs come first, as Patch::circles requires: one pass for each group.
    for (const bool wanted : {true, false}) {
      for (std::size_t i = 0; i < covers_.size(); ++i)
        if ((exposed_[i] != 0) == wanted) out.covers.push_back(covers_[i]);
    }
    out.corners.insert(out.corners.end(), corners_.begin(), corners_.end());
    out.patches.push_back({list_.spheres[place], place, circles, {}, {}});
    out.covers_end.push_back(out.covers.size());
    out.corners_end.push_back(out.corners.size());
  }

 private:
  // Finds the corners among the intersections of every two circles.
  void find_corners(std::uint32_t place) {
    corners_.clear();
    exposed_.assign(covers_.size(), 0);
    for (std::size_t i = 0; i < covers_.size(); ++i)
      for (std::size_t j = i + 1; j < covers_.size(); ++j) cross_circles(place, i, j);
  }

  // Adds the exposed points where circles i and j cross. Let a and b be the unit normals of their
  // planes, α and β the distances of the planes from the centre, c = a · b and s² = 1 - c². The
  // point of the planes' common line that is nearest to the centre is
  //   m = α a + ((β - c α) / s²) (b - c a).
  // The crossings are m ± (√g / s²) (a × b) with g = s² (1 - |m|²) = s² (1 - α²) - (β - c α)². This
  // is the Gram determinant of a, b and a crossing; the circles do not cross if it is not above 0.
  void cross_circles(std::uint32_t place, std::size_t i, std::size_t j) {
    const arcs::Cap& a = covers_[i].cap;
    const arcs::Cap& b = covers_[j].cap;
    const Vec3d normal = cross(a.axis, b.axis);
    const double squared_sine = arcs::inner(normal, normal);
    if (!(squared_sine > kParallel)) return;
    const double cosine = arcs::inner(a.axis, b.axis);
    const double toward_b = b.cosine - cosine * a.cosine;
    const double gram = (1 - a.cosine) * (1 + a.cosine) * squared_sine - toward_b * toward_b;
    if (!(gram > 0)) return;
    const Vec3d middle = a.cosine * a.axis + (toward_b / squared_sine) * (b.axis - cosine * a.axis);
    const Vec3d half = (std::sqrt(gram) / squared_sine) * normal;
    for (const Vec3d& point : {middle + half, middle - half}) {
      if (!exposed_beside(point, i, j)) continue;
      exposed_[i] = exposed_[j] = 1;
      corners_.push_back({point, place < std::min(covers_[i].place, covers_[j].place)});
    }
  }

  // Returns whether no cover other than i and j covers the direction. A crossing of the circles i
  // and j is on the border of both caps, where rounding alone would decide.
  bool exposed_beside(const Vec3d& direction, std::size_t i, std::size_t j) const {
    for (std::size_t k = 0; k < covers_.size(); ++k) {
      const arcs::Cap& cap = covers_[k].cap;
      if (arcs::inner(cap.axis, direction) > cap.cosine + kExposureTolerance && k != i && k != j)
        return false;
    }
    return true;
  }

  // Marks circles without corners that are exposed. Such a circle is exposed everywhere or nowhere,
  // because exposure changes at corners only, so any one of its points decides.
  void find_whole_circles() {
    for (std::size_t i = 0; i < covers_.size(); ++i) {
      if (exposed_[i]) continue;
      const arcs::Cap& cap = covers_[i].cap;
      const double sine = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
      const Vec3d point = cap.cosine * cap.axis + sine * arcs::frame_of(cap.axis).first;
      if (is_exposed(covers_, point, i)) exposed_[i] = 1;
    }
  }

  const CellListView& list_;
  arcs::BallCaps caps_;
  std::vector<Cover> covers_;
  std::vector<Corner> corners_;
  // For each element of covers_: 1 if its circle has exposed arcs. Complete after
  // find_whole_circles().
  std::vector<std::uint8_t> exposed_;
};

// Lowers `squared` to the squared distance from y to circle i, if that distance is smaller and the
// nearest point of the circle is exposed. If the nearest point is covered, the nearest exposed
// point of the circle is a corner at the end of an arc, and update_nearest() examines all corners
// itself. y is relative to the centre of the sphere, and all lengths are in units of its radius.
void update_nearest_on_circle(std::span<const Cover> covers, std::size_t i, const Vec3d& y,
                              double& squared) {
  const arcs::Cap& cap = covers[i].cap;
  const double height = arcs::inner(cap.axis, y);
  const Vec3d radial = y - height * cap.axis;
  const double length = norm(radial);
  const double radius = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
  const double up = height - cap.cosine, out = length - radius;
  const double found = up * up + out * out;
  if (!(found < squared)) return;
  // If y is on the axis of the circle, all points of the circle are equally near, and some of them
  // are exposed, because only circles with exposed arcs are examined.
  if (length > 0 && !is_exposed(covers, cap.cosine * cap.axis + (radius / length) * radial, i))
    return;
  squared = found;
}

// Returns the bounding box of a ball.
Box box_of(const Sphere& ball) {
  const Vec3d r{ball.radius, ball.radius, ball.radius};
  return {ball.center - r, ball.center + r};
}

}  // namespace

ExposedSurface::ExposedSurface(const SphereSet& spheres, Monitor* monitor)
    : list_(make_ball_list(spheres)) {
  const CellListView& list = list_.view();
  std::vector<BlockPatches> found(block_count(list.size, kSpheresPerBlock));
  begin_stage(monitor, "exposed surface", found.size());
  const auto build = [&](std::size_t block, std::size_t first, std::size_t end) {
    PatchBuilder builder(list);
    for (std::size_t place = first; place < end; ++place)
      builder.add(static_cast<std::uint32_t>(place), found[block]);
    found[block].set_spans();
  };
  for_each_block(list.size, kSpheresPerBlock, build, monitor);
  // A vector that is moved keeps its elements where they are, so the spans stay valid.
  for (BlockPatches& block : found) {
    patches_.insert(patches_.end(), block.patches.begin(), block.patches.end());
    covers_.push_back(std::move(block.covers));
    corners_.push_back(std::move(block.corners));
  }
  assert(!patches_.empty());  // a union of balls has a boundary
}

// The distance from p to a point of the sphere grows with the angle between that point and the
// direction of p. If that direction is exposed, it gives the nearest point; otherwise the nearest
// point is on the border of the patch, on an arc or at a corner. Along a circle the distance grows
// in the same way with the angle from the nearest point of the circle.
bool update_nearest(const Patch& patch, const Vec3d& p, double& squared) {
  const double r = patch.ball.radius;
  const Vec3d from_center = p - patch.ball.center;
  const double length = norm(from_center);
  // No point of the sphere is nearer than |gap|.
  const double gap = length - r;
  if (!(gap * gap < squared)) return false;
  const std::span<const Cover> all = patch.covers;
  // From the centre all points of the sphere are equally near, and some are exposed.
  if (!(length > 0) || is_exposed(all, (1 / length) * from_center)) {
    squared = gap * gap;
    return true;
  }
  const Vec3d y = (1 / r) * from_center;
  const double before = squared / (r * r);
  double best = before;
  for (std::size_t i = 0; i < patch.circles; ++i) update_nearest_on_circle(all, i, y, best);
  for (const Corner& corner : patch.corners) {
    const Vec3d to = y - corner.position;
    best = std::min(best, arcs::inner(to, to));
  }
  if (!(best < before)) return false;
  squared = best * r * r;
  return true;
}

// The visitor returns true at the first ball that contains p, which ends the visit.
bool ExposedSurface::contains(const Vec3d& p) const {
  const CellListView& cells = list();
  return visit_near_box(cells, p, p, [&](std::uint32_t place) {
    const Sphere& ball = cells.spheres[place];
    const Vec3d to = p - ball.center;
    return arcs::inner(to, to) < ball.radius * ball.radius;
  });
}

SurfaceFinder::SurfaceFinder(const ExposedSurface& surface, const Box& world)
    : surface_(surface),
      tree_(static_cast<std::uint32_t>(surface.patches().size()), world,
            [&](std::uint32_t i) { return box_of(surface.patches()[i].ball); }) {}

double SurfaceFinder::distance(const Vec3d& p, std::uint32_t& hint) const {
  const std::span<const Patch> patches = surface_.patches();
  double squared = std::numeric_limits<double>::infinity();
  update_nearest(patches[hint], p, squared);
  // `reach` is the distance to the nearest point found so far. A sphere has a point nearer than
  // this only if |p - center| is between radius - reach and radius + reach. The squares are
  // compared, so most balls are rejected without a square root. nearest() passes `squared` to the
  // visitor as `best`.
  double reach = std::sqrt(squared);
  tree_.nearest(p, squared, [&](std::uint32_t i, double& best) {
    const Sphere& ball = patches[i].ball;
    const Vec3d to = p - ball.center;
    const double square = arcs::inner(to, to);
    const double most = ball.radius + reach, least = ball.radius - reach;
    if (square > most * most || (least > 0 && square < least * least)) return;
    if (!update_nearest(patches[i], p, best)) return;
    hint = i;
    reach = std::sqrt(best);
  });
  return std::sqrt(squared);
}

}  // namespace vdwmesh
