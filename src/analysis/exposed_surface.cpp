#include "analysis/exposed_surface.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace vdwmesh {
namespace {

constexpr std::uint32_t kBlock = 64;  // spheres
// Squared sine of the angle below which two planes count as parallel.
constexpr double kParallel = 1e-18;
// A cap is left out only where it lies this far within a larger one: several roundings.
constexpr double kNested = 1e-14;

// The patches of one block of spheres. Until all are found they refer to nothing; their covers and
// corners end at these places.
struct BlockPatches {
  std::vector<Patch> patches;
  std::vector<std::size_t> covers_end, corners_end;
  std::vector<Cover> covers;
  std::vector<Corner> corners;

  void refer() {
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

bool same_ball(const Sphere& a, const Sphere& b) {
  return a.center == b.center && a.radius == b.radius;
}

bool comes_first(const Cover& a, const Cover& b) {
  return arcs::same_cap(a.cap, b.cap) ? a.place < b.place : arcs::cuts_deeper(a.cap, b.cap);
}

// Cosine of the difference of two caps' angles.
double cosine_between(const arcs::Cap& a, const arcs::Cap& b) {
  const double sines = (1 - a.cosine) * (1 + a.cosine) * ((1 - b.cosine) * (1 + b.cosine));
  return a.cosine * b.cosine + std::sqrt(sines);
}

// Whether the larger cap holds the smaller.
bool holds(const arcs::Cap& large, const arcs::Cap& small) {
  return arcs::same_cap(large, small) ||
         arcs::inner(large.axis, small.axis) > cosine_between(large, small) + kNested;
}

// Removes caps within others, of those sorted by falling size.
void drop_nested(std::vector<Cover>& covers) {
  std::size_t kept = 0;
  for (const Cover& cover : covers) {
    const auto last = covers.begin() + static_cast<std::ptrdiff_t>(kept);
    const bool nested =
        std::any_of(covers.begin(), last, [&](const Cover& c) { return holds(c.cap, cover.cap); });
    if (!nested) covers[kept++] = cover;
  }
  covers.resize(kept);
}

class PatchBuilder {
 public:
  explicit PatchBuilder(const CellListView& list) : list_(list) {}

  void add(std::uint32_t place, BlockPatches& out) {
    if (!find_covers(place)) return;
    std::sort(covers_.begin(), covers_.end(), comes_first);
    drop_nested(covers_);
    find_corners(place);
    find_whole_circles();
    const auto circles =
        static_cast<std::uint32_t>(std::count(exposed_.begin(), exposed_.end(), 1));
    if (circles == 0 && !covers_.empty()) return;
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
  // False where one neighbour buries the sphere.
  bool find_covers(std::uint32_t place) {
    covers_.clear();
    const Sphere& ball = list_.spheres[place];
    const Vec3d r{ball.radius, ball.radius, ball.radius};
    return !visit_near_box(list_, ball.center - r, ball.center + r, [&](std::uint32_t other) {
      const Sphere& near = list_.spheres[other];
      if (same_ball(near, ball)) return list_.id[other] < list_.id[place];
      Cover cover{{}, other};
      const arcs::CapKind kind = arcs::make_cap(ball, near, cover.cap);
      if (kind == arcs::CapKind::cuts) covers_.push_back(cover);
      return kind == arcs::CapKind::buries;
    });
  }

  void find_corners(std::uint32_t place) {
    corners_.clear();
    exposed_.assign(covers_.size(), 0);
    for (std::size_t i = 0; i < covers_.size(); ++i)
      for (std::size_t j = i + 1; j < covers_.size(); ++j) cross_circles(place, i, j);
  }

  // Where planes i and j and the sphere meet.
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

  bool exposed_beside(const Vec3d& direction, std::size_t i, std::size_t j) const {
    for (std::size_t k = 0; k < covers_.size(); ++k) {
      const arcs::Cap& cap = covers_[k].cap;
      if (arcs::inner(cap.axis, direction) > cap.cosine + kExposureTolerance && k != i && k != j)
        return false;
    }
    return true;
  }

  // A circle without exposed corners is exposed everywhere or nowhere.
  void find_whole_circles() {
    for (std::size_t i = 0; i < covers_.size(); ++i) {
      if (exposed_[i]) continue;
      const arcs::Cap& cap = covers_[i].cap;
      const double sine = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
      const Vec3d point = cap.cosine * cap.axis + sine * frame_of(cap.axis).first;
      if (is_exposed(covers_, point, i)) exposed_[i] = 1;
    }
  }

  const CellListView& list_;
  std::vector<Cover> covers_;
  std::vector<Corner> corners_;
  std::vector<std::uint8_t> exposed_;  // per cover: its circle has exposed arcs
};

// Lowers `squared` to the squared distance from y to the exposed arcs' nearest points within them,
// all in units of the radius.
void improve_by_circle(std::span<const Cover> covers, std::size_t i, const Vec3d& y,
                       double& squared) {
  const arcs::Cap& cap = covers[i].cap;
  const double height = arcs::inner(cap.axis, y);
  const Vec3d radial = y - height * cap.axis;
  const double length = norm(radial);
  const double radius = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
  const double up = height - cap.cosine, out = length - radius;
  const double found = up * up + out * out;
  if (!(found < squared)) return;
  // On the axis every point of the circle is as near, and some are exposed.
  if (length > 0 && !is_exposed(covers, cap.cosine * cap.axis + (radius / length) * radial, i))
    return;
  squared = found;
}

Box box_of(const Sphere& ball) {
  const Vec3d r{ball.radius, ball.radius, ball.radius};
  return {ball.center - r, ball.center + r};
}

}  // namespace

ExposedSurface::ExposedSurface(const SphereSet& spheres, Monitor* monitor)
    : list_(make_ball_list(spheres)) {
  const CellListView& list = list_.view();
  const std::uint32_t blocks = (list.size + kBlock - 1) / kBlock;
  begin_stage(monitor, "exposed surface", blocks);
  std::vector<BlockPatches> found(blocks);
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, blocks, 1), [&](const auto& range) {
    PatchBuilder builder(list);
    for (std::uint32_t block = range.begin(); block != range.end(); ++block) {
      const std::uint32_t end = std::min(list.size, (block + 1) * kBlock);
      for (std::uint32_t place = block * kBlock; place < end; ++place)
        builder.add(place, found[block]);
      found[block].refer();
      advance(monitor, 1);
    }
  });
  for (BlockPatches& block : found) {
    patches_.insert(patches_.end(), block.patches.begin(), block.patches.end());
    covers_.push_back(std::move(block.covers));
    corners_.push_back(std::move(block.corners));
  }
  assert(!patches_.empty());
}

// Along the sphere the distance grows with the angle from the radial direction, so where that is
// covered, the nearest point is on the patch's border; and along a circle likewise.
bool improve(const Patch& patch, const Vec3d& p, double& squared) {
  const double r = patch.ball.radius;
  const Vec3d from_center = p - patch.ball.center;
  const double length = norm(from_center);
  const double gap = length - r;
  if (!(gap * gap < squared)) return false;
  const std::span<const Cover> all = patch.covers;
  // From the centre every point is as near.
  if (!(length > 0) || is_exposed(all, (1 / length) * from_center)) {
    squared = gap * gap;
    return true;
  }
  const Vec3d y = (1 / r) * from_center;
  const double before = squared / (r * r);
  double best = before;
  for (std::size_t i = 0; i < patch.circles; ++i) improve_by_circle(all, i, y, best);
  for (const Corner& corner : patch.corners) {
    const Vec3d to = y - corner.position;
    best = std::min(best, arcs::inner(to, to));
  }
  if (!(best < before)) return false;
  squared = best * r * r;
  return true;
}

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
  improve(patches[hint], p, squared);
  // Compared as a length: most balls near p are passed over without a square root.
  double reach = std::sqrt(squared);
  tree_.nearest(p, squared, [&](std::uint32_t i, double& best) {
    const Sphere& ball = patches[i].ball;
    const Vec3d to = p - ball.center;
    const double square = arcs::inner(to, to);
    const double most = ball.radius + reach, least = ball.radius - reach;
    if (square > most * most || (least > 0 && square < least * least)) return;
    if (!improve(patches[i], p, best)) return;
    hint = i;
    reach = std::sqrt(best);
  });
  return std::sqrt(squared);
}

}  // namespace vdwmesh
