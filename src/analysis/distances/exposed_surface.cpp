// Construction of the boundary of a union of balls as patches. The search is in surface_search.hpp.
//
// Construction treats every sphere by itself, on all cores (PatchBuilder):
//  1. Find the covers of the sphere, the caps that neighbours from the cell list cut from it. If a
//     neighbour contains the ball, the sphere has no patch.
//  2. Sort the covers by decreasing size and drop caps that lie within others, and of many covers
//     first those that others cover together.
//  3. Intersect the circles of every two covers. An intersection that no third cap covers is a
//     corner, and both circles have exposed arcs there.
//  4. A circle without corners is exposed as a whole or not at all; one of its points decides.
//
// A cap is given by its axis, the unit vector to the other centre, and the cosine of its angle,
// which is also the distance of its plane from the centre of the sphere in units of the radius
// (arc_cap.hpp). The smaller the cosine, the larger the cap.
//
// The complex (src/complex/boundary/) finds exposed arcs too, but needs a triangulation of all
// balls. Here a sphere needs its neighbours alone, and what rounding does to a corner does no harm.
#include "analysis/distances/exposed_surface.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/fixed_blocks.hpp"
#include "measures/arcs/ball_caps.hpp"
#include "measures/arcs/power_cell.hpp"

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

// So many covers are dropped first where others cover them together: balls grown by a large probe
// have thousands of covers, of which some ten are left.
constexpr std::size_t kManyCovers = 128;

// Covers every direction: the cosine is below that of any.
constexpr Cover kCoversAll{{{0, 0, 1}, -2}, kNoPlace};

// The patches of one block of spheres, and the covers and corners to which they point. A vector may
// move its elements when it grows, so set_pointers() sets the pointers of the patches after all
// elements have been added. The covers and corners of the patches stand one after another.
struct BlockPatches {
  std::vector<Patch> patches, buried;
  std::vector<Cover> covers;
  std::vector<SphereCorner> corners;

  void set_pointers() {
    covers.shrink_to_fit();
    corners.shrink_to_fit();
    const Cover* cover = covers.data();
    const SphereCorner* corner = corners.data();
    for (Patch& patch : patches) {
      patch.covers = cover;
      patch.corners = corner;
      cover += patch.cover_count;
      corner += patch.corner_count;
    }
  }
};

template <class T>
std::uint32_t count_of(const std::vector<T>& elements) {
  return static_cast<std::uint32_t>(elements.size());
}

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

  // Appends the patch of the sphere at this list place to `out`. A sphere that several others bury
  // together has an empty one; a sphere within another ball has none.
  void add(ListPlace place, BlockPatches& out) {
    covers_.clear();
    if (!caps_.find(list_, place)) return;
    for (std::size_t i = 0; i < caps_.caps().size(); ++i)
      covers_.push_back({caps_.caps()[i], caps_.neighbors()[i]});
    std::sort(covers_.begin(), covers_.end(), comes_first);
    if (covers_.size() > kManyCovers) drop_redundant();
    drop_nested(covers_);
    find_corners(place);
    find_whole_circles();
    const auto circles =
        static_cast<std::uint32_t>(std::count(exposed_.begin(), exposed_.end(), 1));
    // An exposed part of a sphere with covers is bounded by exposed arcs. If there are covers but
    // no such arcs, the whole sphere is covered. Without covers the whole sphere is exposed.
    if (circles == 0 && !covers_.empty()) {
      out.buried.push_back({list_.spheres[place], place, 0, 1, 0, &kCoversAll, nullptr});
      return;
    }
    // Covers with exposed arcs come first, as Patch::circles requires: one pass for each group.
    for (const bool wanted : {true, false}) {
      for (std::size_t i = 0; i < covers_.size(); ++i)
        if ((exposed_[i] != 0) == wanted) out.covers.push_back(covers_[i]);
    }
    out.corners.insert(out.corners.end(), corners_.begin(), corners_.end());
    out.patches.push_back({list_.spheres[place], place, circles, count_of(covers_),
                           count_of(corners_), nullptr, nullptr});
  }

 private:
  // Drops caps whose planes cut nothing from the power cell of the sphere: what they cover, others
  // cover too. Precondition: the covers are sorted by comes_first().
  void drop_redundant() {
    cell_.reset();
    std::size_t kept = 0;
    for (const Cover& cover : covers_) {
      if (cell_.empty() || cell_.reach() <= cover.cap.cosine) break;
      if (cell_.cut(cover.cap)) covers_[kept++] = cover;
    }
    covers_.resize(kept);
  }

  // Finds the corners among the intersections of every two circles.
  void find_corners(ListPlace place) {
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
  void cross_circles(ListPlace place, std::size_t i, std::size_t j) {
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
      if (is_exposed(covers_.data(), count_of(covers_), point, static_cast<std::uint32_t>(i)))
        exposed_[i] = 1;
    }
  }

  const CellListView& list_;
  arcs::BallCaps caps_;
  arcs::PowerCell cell_;
  std::vector<Cover> covers_;
  std::vector<SphereCorner> corners_;
  // For each element of covers_: 1 if its circle has exposed arcs. Complete after
  // find_whole_circles().
  std::vector<std::uint8_t> exposed_;
};

}  // namespace

ExposedSurface::ExposedSurface(const SphereSet& spheres, Monitor* monitor)
    : list_(make_ball_list(spheres)) {
  const CellListView& list = list_.view();
  std::vector<BlockPatches> found(block_count(list.size, kSpheresPerBlock));
  begin_stage(monitor, "exposed surface", found.size());
  const auto build = [&](std::size_t block, std::size_t first, std::size_t end) {
    PatchBuilder builder(list);
    for (std::size_t place = first; place < end; ++place)
      builder.add(static_cast<ListPlace>(place), found[block]);
    found[block].set_pointers();
  };
  for_each_block(list.size, kSpheresPerBlock, build, monitor);
  // Patches without exposed points stand behind all others. A vector that is moved keeps its
  // elements where they are, so the pointers stay valid.
  for (BlockPatches& block : found) {
    patches_.insert(patches_.end(), block.patches.begin(), block.patches.end());
    covers_.push_back(std::move(block.covers));
    corners_.push_back(std::move(block.corners));
  }
  assert(!patches_.empty());  // a union of balls has a boundary
  exposed_ = patches_.size();
  for (const BlockPatches& block : found)
    patches_.insert(patches_.end(), block.buried.begin(), block.buried.end());
}

}  // namespace vdwmesh
