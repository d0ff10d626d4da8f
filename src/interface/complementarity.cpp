// complementarity(): samples both excluded surfaces near the other side, chooses the buried and the
// fitted ones, and compares each with the nearest of the other side. Rounds of rising density, each
// of four placements of the samples, say how far the result is settled.
#include "interface/complementarity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <vector>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"
#include "interface/point_grid.hpp"
#include "interface/side_samples.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kPlacements = 4;  // of one density

// Width of cells in which points are sought, Å.
constexpr double kCell = 0.9;

using Points = std::vector<Vec3d>;

// A sample of the buried part, with what comes of it.
struct BuriedSample {
  PatchSample at;
  std::uint32_t placement;
  // How much farther than the rim it is from what is not buried, Å, up to kClearance.
  double clearance = 0;
  double fit = 0;         // S; of those that are fitted
  double gap_weight = 0;  // exp(-w d²), of the distance to the buried part of the other side

  bool is_fitted() const { return clearance > 0; }
};

// Of the fitted part one only needs to know where it ends.
constexpr double kClearance = 0.5;  // Å

// A place of one side with which the other one is compared.
struct Target {
  SurfacePlace at;
  std::uint32_t patch;
  double clearance;
};

// One side of a round: its buried samples, of all placements, and what it does not bury.
class SampledSide {
 public:
  SampledSide(const SideSampler& side, double density, const ComplementarityOptions& options)
      : sampler(side), rim_(options.rim), spacing_(1 / std::sqrt(density)), open_(side.border()) {
    for (std::uint32_t i = 0; i < kPlacements; ++i) {
      advance(options.monitor, 0);
      const std::uint64_t seed = options.seed * kPlacements + i;
      for (const PatchSample& sample : side.samples(density / kPlacements, seed)) {
        if (sample.is_buried) {
          buried.push_back({.at = sample, .placement = i});
        } else {
          open_.push_back(sample.point);
        }
      }
    }
    grid_.emplace(open_, kCell);
    for_each_index(buried.size(),
                   [&](std::size_t i) { buried[i].clearance = clearance(buried[i].at.point); });
  }

  double spacing() const { return spacing_; }  // of samples, Å
  bool is_fitted(const Vec3d& place) const { return !grid_->has_within(place, rim_); }

  std::vector<Target> buried_targets() const {
    std::vector<Target> targets;
    for (const BuriedSample& s : buried)
      targets.push_back({{s.at.point, s.at.normal}, s.at.patch, s.clearance});
    return targets;
  }

  // The fitted samples, and places where the fitted part ends. Without these it would seem to end
  // farther inside, by about half the spacing of samples.
  std::vector<Target> fitted_targets() const {
    std::vector<Target> targets = buried_targets();
    for_each_index(targets.size(), [&](std::size_t i) {
      if (targets[i].clearance <= 0) move_to_end(targets[i]);
    });
    std::erase_if(targets, [](const Target& target) { return target.clearance < 0; });
    return targets;
  }

  const SideSampler& sampler;
  std::vector<BuriedSample> buried;

 private:
  std::optional<std::uint32_t> nearest_open(const Vec3d& place) const {
    return grid_->nearest(place, rim_ + kClearance);
  }
  double clearance(const Vec3d& place) const {
    const auto nearest = nearest_open(place);
    return nearest ? norm(open_[*nearest] - place) - rim_ : kClearance;
  }

  // Moves a target beside the fitted part to its end, on its sphere or tube: away from what is not
  // buried. Its clearance then is 0, and otherwise below.
  void move_to_end(Target& target) const {
    constexpr int kSteps = 4;
    constexpr double kClose = 1e-3;  // Å
    const Vec3d begin = target.at.point;
    if (target.clearance < -spacing_) return;
    for (int i = 0; i < kSteps; ++i) {
      const auto nearest = nearest_open(target.at.point);
      if (!nearest) return;
      const Vec3d from = target.at.point - open_[*nearest];
      const double missing = rim_ - norm(from);
      if (std::abs(missing) < kClose) {
        target.clearance = 0;
        return;
      }
      const Vec3d beyond = target.at.point + (missing / norm(from)) * from;
      target.at = sampler.nearest_on(target.patch, beyond);
      if (!(norm(target.at.point - begin) <= 2 * spacing_)) return;
    }
  }

  double rim_, spacing_;
  Points open_;
  std::optional<PointGrid> grid_;  // of open_
};

// The place of a side that is nearest to a point. Targets are beside it by about their spacing; of
// the patches on which the nearest of them lie, the place itself is found. Where none of these has
// one, the surface ends there or has a crease, and the nearest target is taken.
class NearestPlaces {
 public:
  enum class Which : std::uint8_t { buried, fitted };
  struct NearPlace {
    SurfacePlace place;
    bool is_fitted;  // surely
  };

  NearestPlaces(const SampledSide& side, Which which)
      : side_(side),
        which_(which),
        targets_(which == Which::fitted ? side.fitted_targets() : side.buried_targets()),
        grid_(points(targets_), kCell) {}

  // Where one search goes on from the one before, which was for a point near by.
  struct PlaceSearch {
    std::optional<std::uint32_t> last;       // the nearest target
    std::vector<std::uint32_t> near, tried;  // targets; patches
  };

  // If there is one up to `most` (Å).
  std::optional<NearPlace> nearest(const Vec3d& point, double most, PlaceSearch& search) const {
    if (search.last) {
      find_near(point, squared_norm(targets_[*search.last].at.point - point), search);
    } else {
      for (double reach = 1; !search.last; reach *= 2) {
        find_near(point, reach * reach, search);
        if (reach >= most) break;
      }
    }
    if (!search.last) return std::nullopt;
    const double least = squared_norm(targets_[*search.last].at.point - point);
    if (least > most * most + more()) return std::nullopt;  // targets are beside the place
    return nearest_on_patches(point, least, search);
  }

 private:
  // How much farther, by its square, the targets may be that lie on the patch of the nearest place:
  // about h² (1 + d / r) at a distance h of the place, d from the point and on a radius r.
  double more() const { return 2 * side_.spacing() * side_.spacing(); }

  // Finds the nearest target up to a squared distance, Å², and those that are not much farther.
  void find_near(const Vec3d& point, double bound, PlaceSearch& search) const {
    constexpr double kSlack = 1 + 1e-9;
    double least = bound * kSlack, limit = least + more();
    search.near.clear();
    search.last.reset();
    grid_.each_near(point, limit, [&](std::uint32_t i, double squared) {
      if (squared > limit) return;
      search.near.push_back(i);
      if (squared > least || (search.last && squared == least && i > *search.last)) return;
      least = squared;
      limit = least + more();
      search.last = i;
    });
  }

  NearPlace nearest_on_patches(const Vec3d& point, double to_target, PlaceSearch& search) const {
    const Target& at = targets_[*search.last];
    NearPlace found{at.at, at.clearance > 0};
    double least = std::numeric_limits<double>::infinity();
    search.tried.clear();
    for (const std::uint32_t i : search.near) {
      const Target& near = targets_[i];
      if (squared_norm(near.at.point - point) > to_target + more()) continue;
      if (std::ranges::find(search.tried, near.patch) != search.tried.end()) continue;
      search.tried.push_back(near.patch);
      const SurfacePlace place = side_.sampler.nearest_on(near.patch, point);
      const double gap = squared_norm(place.point - point);
      if (!(gap < least) || !side_.sampler.holds(near.patch, place.point)) continue;
      const bool is_clear = norm(place.point - near.at.point) < near.clearance;
      if (which_ == Which::fitted && !is_clear && !side_.is_fitted(place.point)) continue;
      least = gap;
      found = {place, is_clear};
    }
    return found;
  }

  static Points points(const std::vector<Target>& targets) {
    Points found;
    for (const Target& target : targets) found.push_back(target.at.point);
    return found;
  }

  const SampledSide& side_;
  const Which which_;
  const std::vector<Target> targets_;
  const PointGrid grid_;
};

// Where exp(-w d²) is below 1e-12, S is taken for 0. No S changes by more, so no quantile does.
double farthest(double weight) { return std::sqrt(std::log(1e12) / weight); }

// Sets fit and weight of the samples of one side.
void compare(SampledSide& own, const SampledSide& other, const ComplementarityOptions& options) {
  const NearestPlaces buried(other, NearestPlaces::Which::buried),
      fitted(other, NearestPlaces::Which::fitted);
  const double most = farthest(options.weight);
  const auto weight_at = [&](const SurfacePlace& place, const PatchSample& sample) {
    return std::exp(-options.weight * squared_norm(place.point - sample.point));
  };
  constexpr std::size_t kRun = 512;
  for_each_block(own.buried.size(), kRun, [&](std::size_t, std::size_t first, std::size_t end) {
    NearestPlaces::PlaceSearch among_buried, among_fitted;
    for (std::size_t i = first; i < end; ++i) {
      BuriedSample& sample = own.buried[i];
      const Vec3d& point = sample.at.point;
      auto near = buried.nearest(point, most, among_buried);
      if (near) sample.gap_weight = weight_at(near->place, sample.at);
      if (!sample.is_fitted()) continue;
      if (near && !near->is_fitted && !other.is_fitted(near->place.point))
        near = fitted.nearest(point, most, among_fitted);
      if (!near) continue;
      sample.fit = -dot(sample.at.normal, near->place.normal) * weight_at(near->place, sample.at);
    }
  });
}

struct WeightedValue {
  double value, weight;
};

// The median of values by their weights, in which each value is spread evenly over kWidth on both
// sides. So it is continuous in values and weights, and does not jump from one value to the next
// with the last digits of either. Spreading moves it by the square of the width, about 1e-4.
class SpreadMedian {
 public:
  explicit SpreadMedian(std::vector<WeightedValue>&& values) : values_(std::move(values)) {
    std::ranges::sort(values_, {}, &WeightedValue::value);
    sums_.reserve(values_.size() + 1);
    sums_.push_back({0, 0});
    for (const auto& [value, weight] : values_)
      sums_.push_back({sums_.back().value + value * weight, sums_.back().weight + weight});
    if (values_.empty()) return;
    constexpr double kHalf = 0.5, kSame = 1e-12;
    lower_ = quantile(kHalf - kSame);
    upper_ = quantile(kHalf + kSame);
  }

  double value() const {
    return values_.empty() ? std::numeric_limits<double>::quiet_NaN() : 0.5 * (lower_ + upper_);
  }

  // The least standard error of a median of samples that are spread evenly over an area. Only those
  // of cells are left to chance through which the line of the median runs, each with a variance of
  // 1/6 of its weight squared. The line divides the area, so it is not shorter than a circle of
  // half the area. `around`, the share within kWidth of the median, turns shares into values.
  double least_error() const {
    if (values_.empty()) return std::numeric_limits<double>::quiet_NaN();
    const double count = static_cast<double>(values_.size());
    const double share = std::sqrt(std::sqrt(2 * std::numbers::pi) / 6) * std::pow(count, -0.75);
    const double around = share_below(value() + kWidth) - share_below(value() - kWidth);
    return std::max(0.5 * (upper_ - lower_), share * 2 * kWidth / std::max(around, 1 / count));
  }

 private:
  static constexpr double kWidth = 0.02;

  double share_below(double value) const {
    const auto from = std::ranges::lower_bound(values_, value - kWidth, {}, &WeightedValue::value),
               to = std::ranges::lower_bound(values_, value + kWidth, {}, &WeightedValue::value);
    const WeightedValue &before = sums_[static_cast<std::size_t>(from - values_.begin())],
                        &up_to = sums_[static_cast<std::size_t>(to - values_.begin())];
    const double weight = up_to.weight - before.weight;
    const double spread = weight * (value + kWidth) - (up_to.value - before.value);
    return (before.weight + spread / (2 * kWidth)) / sums_.back().weight;
  }

  double quantile(double share) const {
    double below = values_.front().value - kWidth, above = values_.back().value + kWidth;
    constexpr int kHalvings = 50;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (below + above);
      (share_below(middle) < share ? below : above) = middle;
    }
    return 0.5 * (below + above);
  }

  std::vector<WeightedValue> values_, sums_;  // ascending; of weighted values and of weights
  double lower_ = 0, upper_ = 0;
};

// The fits of one placement, or of all.
SpreadMedian median_of(const std::vector<BuriedSample>& samples,
                       std::optional<std::uint32_t> placement) {
  std::vector<WeightedValue> fits;
  for (const BuriedSample& sample : samples)
    if (sample.is_fitted() && (!placement || *placement == sample.placement))
      fits.push_back({sample.fit, sample.at.weight});
  return SpreadMedian(std::move(fits));
}

// Å² of all placements' mean.
template <class Factor>
double integral(const std::vector<BuriedSample>& samples, const Factor& factor) {
  WideSum sum;
  for (const BuriedSample& sample : samples) sum.add(sample.at.weight * factor(sample));
  return sum.value() / kPlacements;
}

// The standard error of Sc: from the spread of the placements, and not less than samples allow.
double error_of(const std::array<const std::vector<BuriedSample>*, 2>& sides,
                const std::array<SpreadMedian, 2>& medians) {
  std::array<double, kPlacements> found{};
  for (std::uint32_t i = 0; i < kPlacements; ++i)
    for (const auto* side : sides) found[i] += 0.5 * median_of(*side, i).value();
  const double mean = std::accumulate(found.begin(), found.end(), 0.0) / kPlacements;
  double squares = 0;
  for (const double sc : found) squares += (sc - mean) * (sc - mean);
  const double spread = std::sqrt(squares / (kPlacements * (kPlacements - 1)));
  const double least = 0.5 * std::hypot(medians[0].least_error(), medians[1].least_error());
  // A placement may have no sample where others have a few.
  return std::isfinite(spread) ? std::max(spread, least) : 1;
}

Complementarity measure_round(const SideSampler& side_a, const SideSampler& side_b, double density,
                              const ComplementarityOptions& options) {
  SampledSide sampled_a(side_a, density, options), sampled_b(side_b, density, options);
  compare(sampled_a, sampled_b, options);
  compare(sampled_b, sampled_a, options);
  const std::vector<BuriedSample>&a = sampled_a.buried, &b = sampled_b.buried;
  const std::array<SpreadMedian, 2> medians{median_of(a, {}), median_of(b, {})};
  const auto one = [](const BuriedSample&) { return 1.0; };
  const auto fitted = [](const BuriedSample& sample) { return sample.is_fitted() ? 1.0 : 0.0; };
  const auto contact = [](const BuriedSample& sample) { return sample.gap_weight; };
  return {.sc = 0.5 * (medians[0].value() + medians[1].value()),
          .error = error_of({&a, &b}, medians),
          .median_a = medians[0].value(),
          .median_b = medians[1].value(),
          .fitted_a = integral(a, fitted),
          .fitted_b = integral(b, fitted),
          .buried_a = integral(a, one),
          .buried_b = integral(b, one),
          .contact_a = integral(a, contact),
          .contact_b = integral(b, contact),
          .density = density};
}

Points centers_of(const SphereSet& a, const SphereSet& b) {
  Points centers;
  for (const SphereSet* side : {&a, &b})
    for (const Sphere& ball : side->spheres()) centers.push_back(ball.center);
  return centers;
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
  const PointGrid search(centers_of(other, {}), reach / 2);
  std::vector<Sphere> near;
  for (const Sphere& ball : own.spheres())
    if (search.has_within(ball.center, reach)) near.push_back(ball);
  return SphereSet(std::move(near));
}

}  // namespace

Complementarity complementarity(const SphereSet& a, const SphereSet& b,
                                const ComplementarityOptions& options) {
  if (a.empty() || b.empty()) throw InvalidInput("a side without atoms has no surface to fit");
  if (!(options.weight >= 0.01 && std::isfinite(options.weight)))
    throw InvalidInput("the weight of shape complementarity needs to be at least 0.01 Å⁻²");
  const SphereSet grown_a = excluded::grown_by(a, options.probe),
                  grown_b = excluded::grown_by(b, options.probe);
  const CellList list_a = make_ball_list(grown_a), list_b = make_ball_list(grown_b);
  const SphereSet near_a = atoms_near(a, b, options), near_b = atoms_near(b, a, options);
  Complementarity found{};
  found.sc = found.error = found.median_a = found.median_b =
      std::numeric_limits<double>::quiet_NaN();
  if (near_a.empty() || near_b.empty()) return found;
  const Points centers = centers_of(near_a, near_b);
  const AxesSource axes(centers);
  const SideSampler side_a(near_a, list_b.view(), axes, options.probe, options.rim,
                           options.monitor),
      side_b(near_b, list_a.view(), axes, options.probe, options.rim, options.monitor);
  double before = std::numeric_limits<double>::infinity();  // of the round with half the density
  for (double density = options.density; density <= options.most_density; density *= 2) {
    found = measure_round(side_a, side_b, density, options);
    if (!std::isfinite(found.sc)) {
      found.error = found.sc;
      break;
    }
    found.error = std::max(found.error, std::abs(found.sc - before));
    before = found.sc;
    if (found.error <= options.tolerance) break;
  }
  return found;
}

}  // namespace vdwmesh
