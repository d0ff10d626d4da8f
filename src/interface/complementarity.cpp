// complementarity(): samples both excluded surfaces near the other side, chooses the buried and the
// fitted ones, and compares each with the nearest of the other side. Rounds with several seeds and
// rising density say how far the result is settled.
#include "interface/complementarity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"
#include "excluded/distances/judged_surface.hpp"
#include "excluded/distances/surface_samples.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kSeeds = 4;  // rounds of one density

using Points = std::vector<Vec3d>;

// Points in cells, for searches around others.
class PointSearch {
 public:
  explicit PointSearch(const Points& points) {
    // About as far as the nearest point of the other side is.
    constexpr double kCell = 0.5;  // Å
    std::vector<Sphere> balls;
    balls.reserve(points.size());
    for (const Vec3d& point : points) balls.push_back({point, kCell});
    if (!balls.empty()) list_ = make_ball_list(SphereSet(std::move(balls)));
  }

  bool has_within(const Vec3d& point, double distance) const {
    return !is_empty() && visit(point, distance, [&](ListPlace place) {
      return squared_norm(at(place) - point) < distance * distance;
    });
  }

  // The index of the nearest point, the lowest of several, if there is one within `most`.
  std::optional<SphereId> nearest(const Vec3d& point, double most) const {
    if (is_empty()) return std::nullopt;
    for (double reach = 1; reach < 2 * most; reach *= 2) {
      double least = reach * reach;
      std::optional<SphereId> found;
      visit(point, reach, [&](ListPlace place) {
        const double squared = squared_norm(at(place) - point);
        const SphereId id = list_.view().id[place];
        if (squared > least || (found && squared == least && id > *found)) return false;
        least = squared;
        found = id;
        return false;
      });
      if (found) return found;
    }
    return std::nullopt;
  }

 private:
  bool is_empty() const { return list_.view().size == 0; }
  Vec3d at(ListPlace place) const { return list_.view().spheres[place].center; }
  template <class Visit>
  bool visit(const Vec3d& point, double distance, const Visit& visitor) const {
    const Vec3d reach{distance, distance, distance};
    return visit_near_box(list_.view(), point - reach, point + reach, visitor);
  }

  CellList list_;
};

// The atoms of one side near the other, their excluded surface, and the other side's grown atoms.
struct SampledSide {
  SampledSide(const SphereSet& own, const CellListView& others,
              const ComplementarityOptions& options)
      : grown(excluded::grown_by(own, options.probe)),
        surface(own, options.probe, ExcludedPart::complete, options.monitor),
        accessible(grown, options.monitor),
        other(others) {}

  const SphereSet grown;
  const excluded::JudgedSurface surface;
  const ExposedSurface accessible;
  const CellListView& other;
};

// Whether the centre of a probe is inside an atom of the list, which has grown by the probe.
bool overlaps(const CellListView& grown, const Vec3d& probe) {
  return visit_near_box(grown, probe, probe, [&](ListPlace place) {
    const Sphere& ball = grown.spheres[place];
    return squared_norm(ball.center - probe) < ball.radius * ball.radius;
  });
}

// Samples of one side that the other one buries, and which of them are fitted.
struct BuriedSamples {
  Points points, normals;
  std::vector<std::uint8_t> is_fitted;
};

BuriedSamples sample(const SampledSide& side, double density, std::uint64_t seed,
                     const ComplementarityOptions& options) {
  const excluded::SurfaceSamples samples(side.surface, side.accessible, options.probe, density,
                                         seed);
  BuriedSamples buried;
  Points open;
  std::vector<std::array<Points, 2>> parts(samples.element_count());
  for_each_index(parts.size(), [&](std::size_t i) { samples.add(i, parts[i][0], parts[i][1]); });
  for (const auto& [points, probes] : parts) {
    advance(options.monitor, 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!overlaps(side.other, probes[i])) {
        open.push_back(points[i]);
        continue;
      }
      buried.points.push_back(points[i]);
      buried.normals.push_back((1 / options.probe) * (probes[i] - points[i]));
    }
  }
  const PointSearch open_search(open);
  buried.is_fitted.resize(buried.points.size());
  for_each_index(buried.points.size(), [&](std::size_t i) {
    buried.is_fitted[i] = !open_search.has_within(buried.points[i], options.rim);
  });
  return buried;
}

BuriedSamples fitted_of(const BuriedSamples& all) {
  BuriedSamples fitted;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    if (all.is_fitted[i] == 0) continue;
    fitted.points.push_back(all.points[i]);
    fitted.normals.push_back(all.normals[i]);
  }
  return fitted;
}

double median_of(std::vector<double>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

// Points farther apart than this have a weight below 1e-16 for every usual w.
constexpr double kFarthest = 16;  // Å

// Squared distance from a point to the surface around a sample. A sample is beside the nearest
// point by about the spacing of samples: so near, the surface is its tangent plane. Farther than
// that begins the outside of the patch.
double squared_distance(const Vec3d& point, const BuriedSamples& other, SphereId sample,
                        double density) {
  constexpr double kSpacings = 2;
  const Vec3d apart = point - other.points[sample];
  const double height = dot(apart, other.normals[sample]), squared = squared_norm(apart);
  return squared - height * height <= kSpacings * kSpacings / density ? height * height : squared;
}

double median_fit(const BuriedSamples& own, const BuriedSamples& other, double density,
                  const ComplementarityOptions& options) {
  const PointSearch search(other.points);
  std::vector<double> fits(own.points.size());
  for_each_index(fits.size(), [&](std::size_t i) {
    const auto nearest = search.nearest(own.points[i], kFarthest);
    if (!nearest) return;
    const double squared = squared_distance(own.points[i], other, *nearest, density);
    fits[i] = -dot(own.normals[i], other.normals[*nearest]) * std::exp(-options.weight * squared);
  });
  return median_of(fits);
}

double contact_surface(const BuriedSamples& own, const BuriedSamples& other, double density,
                       const ComplementarityOptions& options) {
  const PointSearch search(other.points);
  std::vector<double> weights(own.points.size());
  for_each_index(weights.size(), [&](std::size_t i) {
    const auto nearest = search.nearest(own.points[i], kFarthest);
    if (!nearest) return;
    const double squared = squared_distance(own.points[i], other, *nearest, density);
    weights[i] = std::exp(-options.weight * squared);
  });
  WideSum sum;
  for (const double weight : weights) sum.add(weight);
  return sum.value() / density;
}

// One seed.
Complementarity measure_once(const std::array<const SampledSide*, 2>& sides, double density,
                             std::uint64_t seed, const ComplementarityOptions& options) {
  const BuriedSamples a = sample(*sides[0], density, 2 * seed, options),
                      b = sample(*sides[1], density, 2 * seed + 1, options);
  const BuriedSamples fitted_a = fitted_of(a), fitted_b = fitted_of(b);
  Complementarity once{};
  once.median_a = median_fit(fitted_a, fitted_b, density, options);
  once.median_b = median_fit(fitted_b, fitted_a, density, options);
  once.sc = 0.5 * (once.median_a + once.median_b);
  once.fitted_a = static_cast<double>(fitted_a.points.size()) / density;
  once.fitted_b = static_cast<double>(fitted_b.points.size()) / density;
  once.buried_a = static_cast<double>(a.points.size()) / density;
  once.buried_b = static_cast<double>(b.points.size()) / density;
  once.contact_a = contact_surface(a, b, density, options);
  once.contact_b = contact_surface(b, a, density, options);
  once.density = density;
  return once;
}

// The mean of all seeds, with the standard error of Sc.
Complementarity measure_round(const std::array<const SampledSide*, 2>& sides, double density,
                              const ComplementarityOptions& options) {
  Complementarity mean{};
  std::array<double, kSeeds> found{};
  for (std::size_t i = 0; i < kSeeds; ++i) {
    const Complementarity once = measure_once(sides, density, options.seed * kSeeds + i, options);
    found[i] = once.sc;
    for (double Complementarity::*member :
         {&Complementarity::sc, &Complementarity::median_a, &Complementarity::median_b,
          &Complementarity::fitted_a, &Complementarity::fitted_b, &Complementarity::buried_a,
          &Complementarity::buried_b, &Complementarity::contact_a, &Complementarity::contact_b}) {
      mean.*member += once.*member / kSeeds;
    }
  }
  double squares = 0;
  for (const double sc : found) squares += (sc - mean.sc) * (sc - mean.sc);
  mean.error = std::sqrt(squares / (kSeeds * (kSeeds - 1)));
  mean.density = density;
  return mean;
}

// The atoms of one side that may have a part in its buried surface or in the rim around it. A
// buried point is within r + 2 p of an atom of the other side, and what makes the surface there or
// within the rim is within r + 2 p of that.
SphereSet atoms_near(const SphereSet& own, const SphereSet& other,
                     const ComplementarityOptions& options) {
  const auto largest = [](const SphereSet& set) {
    double radius = 0;
    for (const Sphere& ball : set.spheres()) radius = std::max(radius, ball.radius);
    return radius;
  };
  const double reach = largest(own) + largest(other) + 4 * options.probe + options.rim;
  Points centers;
  for (const Sphere& ball : other.spheres()) centers.push_back(ball.center);
  const PointSearch search(centers);
  std::vector<Sphere> near;
  for (const Sphere& ball : own.spheres())
    if (search.has_within(ball.center, reach)) near.push_back(ball);
  return SphereSet(std::move(near));
}

}  // namespace

Complementarity complementarity(const SphereSet& a, const SphereSet& b,
                                const ComplementarityOptions& options) {
  if (a.empty() || b.empty()) throw InvalidInput("a side without atoms has no surface to fit");
  const SphereSet grown_a = excluded::grown_by(a, options.probe),
                  grown_b = excluded::grown_by(b, options.probe);
  const CellList list_a = make_ball_list(grown_a), list_b = make_ball_list(grown_b);
  const SphereSet near_a = atoms_near(a, b, options), near_b = atoms_near(b, a, options);
  Complementarity found{};
  found.sc = found.median_a = found.median_b = std::numeric_limits<double>::quiet_NaN();
  if (near_a.empty() || near_b.empty()) return found;
  const SampledSide side_a(near_a, list_b.view(), options), side_b(near_b, list_a.view(), options);
  double before = std::numeric_limits<double>::infinity();  // of the round with half the density
  for (double density = options.density; density <= options.most_density; density *= 2) {
    found = measure_round({&side_a, &side_b}, density, options);
    found.error = std::max(found.error, std::abs(found.sc - before));
    before = found.sc;
    if (!std::isfinite(found.sc) || found.error <= options.tolerance) break;
  }
  return found;
}

}  // namespace vdwmesh
