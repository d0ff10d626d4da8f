// Quasi-Monte Carlo integration of a surface's area: directions are evenly spread and fixed instead
// of random, so the same set always gives the same estimate. A sample of the spheres stands for all
// of them.
// - Union of balls: of 32 points spread evenly over a sphere, the share that no other ball covers
//   is the exposed share of the sphere's area.
// - Blended field: every point of the isosurface belongs to the atom that contributes most there.
//   Rays from the atom's centre find its part of the isosurface, and a change of variables from
//   solid angle to area gives the part's area.
// sample_surface() returns the points themselves. It needs the spheres near those of the sample
// only, which are found by one look at each sphere; a cell list of all would take much longer.
// Several processes share these looks: each finds among its spheres those near the samples of all.
#include "extract/area_estimate.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/fixed_blocks.hpp"
#include "core/lanes/multiversion.hpp"
#include "extract/blended/field_formulas.hpp"
#include "extract/blended/field_sample.hpp"
#include "extract/field_list.hpp"
#include "spheres/box.hpp"
#include "spheres/cell_list.hpp"
#include "spheres/even_directions.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint64_t kSampledSpheres = 4096;  // largest number of spheres in the sample
constexpr int kPointsPerSphere = 32;             // union of balls
// Blended fields: kRays is divided by the number of spheres, and each sphere in the sample gets
// this number of rays, but at least kFewestRays and at most kMostRays.
constexpr std::uint64_t kRays = 16384;
constexpr int kFewestRays = 4, kMostRays = 128;
constexpr double kRayStep = 0.25;  // relative to the radius
// Least cosine between a ray and the normal. It limits the weight of grazing rays to ten times the
// weight of a ray that meets the surface at a right angle.
constexpr double kLeastCosine = 0.1;

// The balls that may cover points of a sphere.
class Covers {
 public:
  Covers(const CellListView& list, ListPlace own) : list_(list), own_(own) {
    constexpr double kMargin = 1e-6;  // relative; far more than points are rounded by, and kSlack
    const Sphere& ball = list.spheres[own];
    const Box box = box_of(ball);
    visit_near_box(list, box.lower, box.upper, [&](ListPlace place) {
      const Vec3d d = list.spheres[place].center - ball.center;
      const double most = (ball.radius + list.spheres[place].radius) * (1 + kMargin);
      if (place != own && dot(d, d) <= most * most) near_.push_back(place);
      return false;
    });
  }

  // Whether another ball covers the point p of the sphere. If the point lies on several spheres, it
  // counts as covered for all of them but the first in the list.
  bool is_covered(const Vec3d& p) {
    for (ListPlace& place : near_) {
      if (!covers(place, p)) continue;
      std::swap(place, near_.front());  // it may well cover the next point, too
      return true;
    }
    return false;
  }

 private:
  bool covers(ListPlace place, const Vec3d& p) const {
    // A point counts as lying on a sphere if its squared distance from the centre differs from the
    // squared radius by less than this share of it. So of several equal spheres the first keeps its
    // area and the others have none, whichever way the point is rounded.
    constexpr double kSlack = 1e-9;
    const Sphere& ball = list_.spheres[place];
    const double square = ball.radius * ball.radius;
    const Vec3d d = p - ball.center;
    return dot(d, d) < square * (place < own_ ? 1 + kSlack : 1 - kSlack);
  }

  const CellListView& list_;
  ListPlace own_;
  std::vector<ListPlace> near_;
};

// Share of a sphere's area that no other ball covers, 0 to 1.
double exposed_part(const CellListView& list, ListPlace own) {
  const Sphere& ball = list.spheres[own];
  Covers covers(list, own);
  int exposed = 0;
  for (int k = 0; k < kPointsPerSphere; ++k)
    exposed += !covers.is_covered(ball.center + ball.radius * even_direction(k, kPointsPerSphere));
  return exposed / static_cast<double>(kPointsPerSphere);
}

// Estimates the sum of area_of(place) over all list places from evenly spaced ones. The terms are
// summed in the order of the list, so the result does not depend on the number of threads.
template <class AreaOf>
double sum_over_sample(std::uint64_t spheres, const AreaOf& area_of) {
  if (spheres == 0) return 0;
  const std::uint64_t sampled = std::min(spheres, kSampledSpheres);
  std::vector<double> areas(sampled);
  tbb::parallel_for(std::uint64_t{0}, sampled, [&](std::uint64_t i) {
    areas[i] = area_of(static_cast<ListPlace>(i * spheres / sampled));
  });
  double sum = 0;
  for (const double area : areas) sum += area;
  return sum * static_cast<double>(spheres) / static_cast<double>(sampled);
}

// Where a ray from the centre of a sphere meets the part of the isosurface that belongs to the
// sphere: the distance from the centre, Å, and the area per solid angle there, Å². Both are 0 if it
// does not.
struct RayHit {
  double distance = 0, area = 0;
};

// Follows the ray in direction u from the centre of the sphere at list place `own`. The ray is
// walked in steps from the centre outwards, as long as the point is inside and `own` contributes
// most. The first step that leaves the surface brackets a crossing at distance r, which linear
// interpolation finds. An area dA there fills the solid angle dA cos(a) / r^2, with a the angle
// between ray and normal, so the area per solid angle is r^2 / cos(a). There is no hit if another
// sphere contributes most on the way or at the crossing, or if the field is below the isovalue
// after the first step.
RayHit follow_ray(const CellListView& list, const FieldModel& model, ListPlace own,
                  const Vec3d& u) {
  const Sphere& ball = list.spheres[own];
  const double step = kRayStep * ball.radius, reach = field_reach(model, ball.radius);
  double r = 0, value = 0;  // value: the field at r; 0 at the centre, where it is not evaluated
  while (r < reach) {
    const FieldSample next = sample_field(list, model, ball.center + (r + step) * u);
    if (next.value >= model.isovalue) {
      if (next.place != own) return {};
      value = next.value;
      r += step;
      continue;
    }
    if (!(value > 0)) return {};
    const double way = r + step * (value - model.isovalue) / (value - next.value);
    const FieldSample at = sample_field(list, model, ball.center + way * u);
    if (!at.in_reach || at.place != own) return {};
    const double cosine = std::abs(dot(at.gradient, u)) / norm(at.gradient);
    return {way, way * way / std::clamp(cosine, kLeastCosine, 1.0)};
  }
  return {};
}

// Area of the isosurface that belongs to the sphere at list place `own`, Å²: the mean over the rays
// times the full solid angle.
VDWMESH_MULTIVERSION double area_along_rays(const CellListView& list, const FieldModel& model,
                                            ListPlace own, int rays) {
  double sum = 0;
  for (int k = 0; k < rays; ++k) sum += follow_ray(list, model, own, even_direction(k, rays)).area;
  return 4 * std::numbers::pi / rays * sum;
}

// Samples of one sphere's part of the surface, in `points` directions from its centre. Each
// stands for the areas of `weight` spheres.
void sample_sphere(const CellListView& list, const FieldModel& model, ListPlace own, int points,
                   double weight, std::vector<SurfaceSample>& samples) {
  const Sphere& ball = list.spheres[own];
  const double solid_angle = 4 * std::numbers::pi / points * weight;
  std::optional<Covers> covers;
  if (model.kind == FieldKind::vdw) covers.emplace(list, own);
  for (int k = 0; k < points; ++k) {
    const Vec3d u = even_direction(k, points);
    RayHit hit{ball.radius, ball.radius * ball.radius};
    if (!covers) {
      hit = follow_ray(list, model, own, u);
    } else if (covers->is_covered(ball.center + ball.radius * u)) {
      continue;
    }
    if (!(hit.area > 0)) continue;
    samples.push_back({list.id[own], ball.center + hit.distance * u, solid_angle * hit.area});
  }
}

// The part of a set of so many spheres, and its sample: evenly spaced numbers, ascending.
class SampledBlock {
 public:
  SampledBlock(std::uint64_t spheres, std::size_t part, std::size_t parts)
      : first_(begin_of_part(spheres, part, parts)),
        size_(begin_of_part(spheres, part + 1, parts) - first_) {}

  std::uint64_t first() const { return first_; }
  std::uint64_t size() const { return size_; }
  std::vector<SphereId> sample() const {
    constexpr std::uint64_t kMost = 2048;
    const std::uint64_t count = std::min(size_, kMost);
    std::vector<SphereId> chosen;
    for (std::uint64_t i = 0; i < count; ++i) {
      chosen.push_back(static_cast<SphereId>(first_ + i * size_ / count));
    }
    return chosen;
  }

 private:
  std::uint64_t first_, size_;
};

// The box that the reaches of some spheres take, and the largest of these, Å.
struct Reaches {
  Box box = empty_box();
  double largest = 0;
};

// Precondition: the part has spheres.
Reaches reaches_of(const SphereSet& spheres, const FieldModel& model, const SampledBlock& part) {
  return join_blocks(
      part.size(),
      [&](std::size_t begin, std::size_t end) {
        Reaches all;
        for (const Sphere& s : spheres.spheres().subspan(part.first() + begin, end - begin)) {
          const double reach = field_reach(model, s.radius);
          include(all.box, box_of({s.center, reach}));
          all.largest = std::max(all.largest, reach);
        }
        return all;
      },
      [](Reaches& all, const Reaches& other) {
        include(all.box, other.box);
        all.largest = std::max(all.largest, other.largest);
      });
}

// Cells of a box, of which some are marked.
class MarkedCells {
 public:
  MarkedCells() = default;
  // Cells of about this edge, Å, or longer where an axis would have too many.
  MarkedCells(const Box& box, double edge) : lower_(box.lower) {
    const Vec3d size = box.upper - box.lower;
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double kMost = 512;  // 16 MB of bits in all
      const auto a = static_cast<std::size_t>(axis);
      const double cells = std::clamp(std::floor(size[axis] / edge), 1.0, kMost);
      count_[a] = static_cast<std::size_t>(cells);
      scale_[a] = size[axis] > 0 ? cells / size[axis] : 0;
    }
    marks_.resize(count_[0] * count_[1] * count_[2]);
  }

  void mark(const Box& box) {
    const std::array<std::size_t, 3> first = cell_of(box.lower), last = cell_of(box.upper);
    for (std::size_t z = first[2]; z <= last[2]; ++z) {
      for (std::size_t y = first[1]; y <= last[1]; ++y) {
        for (std::size_t x = first[0]; x <= last[0]; ++x) marks_[index_of({x, y, z})] = true;
      }
    }
  }
  // True if the point is in a box that was marked: along each axis the cell does not fall where the
  // coordinate rises, however it is rounded, so it is one of those between the ends of the box.
  bool is_marked(const Vec3d& point) const { return marks_[index_of(cell_of(point))]; }

 private:
  std::array<std::size_t, 3> cell_of(const Vec3d& p) const {
    std::array<std::size_t, 3> cell;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double place = (p[axis] - lower_[axis]) * scale_[a];
      cell[a] =
          static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(count_[a] - 1)));
    }
    return cell;
  }
  std::size_t index_of(const std::array<std::size_t, 3>& cell) const {
    return (cell[2] * count_[1] + cell[1]) * count_[0] + cell[0];
  }

  Vec3d lower_{};
  std::array<double, 3> scale_{};
  std::array<std::size_t, 3> count_{};
  std::vector<bool> marks_;
};

// The samples of all parts that reach a box, and which spheres within it have an effect on their
// surface. The points at which the field is evaluated for a sphere of a sample are at most a step
// of a ray beyond its reach. Numbers of a structure mostly follow each other in space, so the box
// of a block leaves out most samples. Of the spheres of the block, most are near no sample, and one
// look at the cells around the samples tells.
class AreaSamples {
 public:
  // Precondition of add(): the sphere and its reach are within `around`.
  AreaSamples(const SphereSet& spheres, const FieldModel& model, std::size_t parts,
              const Reaches& around)
      : ends_in_box_(model.kind != FieldKind::vdw && model.truncation == Truncation::subgrid) {
    std::vector<Sphere> all;
    for (std::size_t part = 0; part < parts; ++part) {
      for (const SphereId id : SampledBlock(spheres.size(), part, parts).sample()) {
        const Sphere& s = spheres[id];
        const double reach = field_reach(model, s.radius) + kRayStep * s.radius;
        if (!meet(around.box, box_of({s.center, reach}))) continue;
        all.push_back(s);
        part_.push_back(part);
        reach_.push_back(reach);
      }
    }
    if (all.empty()) return;
    cells_ = MarkedCells(around.box, around.largest + std::ranges::max(reach_));
    for (std::size_t i = 0; i < all.size(); ++i) {
      cells_.mark(box_of({all[i].center, (reach_[i] + around.largest) * (1 + kRounding)}));
    }
    list_ = CellList(SphereSet(std::move(all)), reach_);
  }

  // Appends the sphere's number to those near each part on whose sample it may have an effect.
  void add(const Sphere& s, double reach, SphereId id,
           std::vector<std::vector<SphereId>>& near) const {
    if (reach_.empty() || !cells_.is_marked(s.center)) return;
    const Box box = box_of({s.center, reach});
    visit_near_box(list_.view(), box.lower, box.upper, [&](ListPlace place) {
      const SphereId sampled = list_.view().id[place];
      std::vector<SphereId>& ids = near[part_[sampled]];
      const Vec3d d = list_.view().spheres[place].center - s.center;
      const double most = (reach + reach_[sampled]) * (1 + kRounding);
      const bool is_near = ends_in_box_ || dot(d, d) <= most * most;
      if (is_near && (ids.empty() || ids.back() != id)) ids.push_back(id);
      return false;
    });
  }

 private:
  static constexpr double kRounding = 1e-9;  // relative; more than sums and squares are rounded by

  bool ends_in_box_;  // at the faces of a box of cells; all other fields end at a sphere
  std::vector<std::size_t> part_;  // by sphere of the samples
  std::vector<double> reach_;      // likewise, Å
  MarkedCells cells_;              // of the centres of spheres that may be near
  CellList list_;
};

}  // namespace

double estimate_area(const SphereSet& spheres) {
  const CellList list = make_ball_list(spheres);
  return sum_over_sample(spheres.size(), [&](ListPlace place) {
    const double r = list.view().spheres[place].radius;
    return 4 * std::numbers::pi * r * r * exposed_part(list.view(), place);
  });
}

double estimate_area(const SphereSet& spheres, const FieldModel& model) {
  const CellList list = make_field_list(spheres, model);
  const std::uint64_t wanted = kRays / std::max<std::uint64_t>(spheres.size(), 1);
  const int rays = static_cast<int>(std::clamp<std::uint64_t>(wanted, kFewestRays, kMostRays));
  return sum_over_sample(spheres.size(), [&](ListPlace place) {
    return area_along_rays(list.view(), model, place, rays);
  });
}

std::vector<std::vector<SphereId>> spheres_near_samples(const SphereSet& spheres,
                                                        const FieldModel& model, std::size_t block,
                                                        std::size_t parts) {
  using Near = std::vector<std::vector<SphereId>>;  // by part
  const SampledBlock own(spheres.size(), block, parts);
  if (own.size() == 0) return Near(parts);
  const AreaSamples samples(spheres, model, parts, reaches_of(spheres, model, own));
  return join_blocks(
      own.size(),
      [&](std::size_t begin, std::size_t end) {
        Near near(parts);
        for (std::size_t i = own.first() + begin; i < own.first() + end; ++i) {
          const double reach = field_reach(model, spheres[i].radius);
          samples.add(spheres[i], reach, static_cast<SphereId>(i), near);
        }
        return near;
      },
      append_to_each<SphereId>);
}

std::vector<SurfaceSample> sample_surface(const SphereSet& spheres, const FieldModel& model,
                                          std::size_t part, std::size_t parts,
                                          std::span<const SphereId> near) {
  constexpr std::uint64_t kPoints = 16384;
  constexpr std::uint64_t kFewestPoints = 8, kMostPoints = 256;  // of one sphere
  const SampledBlock own(spheres.size(), part, parts);
  const std::vector<SphereId> sample = own.sample();
  if (sample.empty()) return {};
  const auto points =
      static_cast<int>(std::clamp(kPoints / sample.size(), kFewestPoints, kMostPoints));
  const double weight = static_cast<double>(own.size()) / static_cast<double>(sample.size());
  std::vector<Sphere> balls;
  for (const SphereId id : near) balls.push_back(spheres[id]);
  const CellList list = make_field_list(SphereSet(std::move(balls)), model);
  const auto id_at = [&](ListPlace place) { return near[list.view().id[place]]; };
  std::vector<ListPlace> places;  // of the sample, ascending
  for (std::uint32_t i = 0; i < list.view().size; ++i) {
    if (std::ranges::binary_search(sample, id_at(ListPlace{i}))) places.push_back(ListPlace{i});
  }
  std::vector<std::vector<SurfaceSample>> of_sphere(places.size());
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    sample_sphere(list.view(), model, places[i], points, weight, of_sphere[i]);
  });
  std::vector<SurfaceSample> all;
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (const SurfaceSample& found : of_sphere[i]) {
      all.push_back({id_at(places[i]), found.point, found.area});
    }
  }
  return all;
}

}  // namespace vdwmesh
