#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/mesh_measures.hpp"
#include "analysis/quality_histograms.hpp"
#include "core/errors.hpp"
#include "core/sum.hpp"
#include "mesh/edge_buckets.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kTrianglesPerTask = 1 << 13;
constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

// Edge lengths a >= b >= c and area of one triangle.
struct Shape {
  double a, b, c, area;
};

Shape shape_of(const IndexedMesh& mesh, std::size_t t) {
  const auto& [i, j, k] = mesh.triangles[t];
  const Vec3d ij = mesh.positions[j] - mesh.positions[i];
  const Vec3d ik = mesh.positions[k] - mesh.positions[i];
  double a = norm(ij), b = norm(ik), c = norm(mesh.positions[k] - mesh.positions[j]);
  if (a < b) std::swap(a, b);
  if (b < c) std::swap(b, c);
  if (a < b) std::swap(a, b);
  return {a, b, c, norm(cross(ij, ik)) / 2};
}

// The angle between the two longer sides: sin = 2A / ab, cos by the law of cosines, written as a
// sum of products that cannot cancel badly when the angle is small.
double min_angle_deg(const Shape& s) {
  if (s.area == 0) return 0;
  const double twice_ab_cos = s.b * s.b + (s.a - s.c) * (s.a + s.c);
  return std::atan2(4 * s.area, twice_ab_cos) * kDegreesPerRadian;
}

// R / 2r = abc (a + b + c) / 16 A².
double aspect_ratio(const Shape& s) {
  const double ratio = (s.a * s.b / (4 * s.area)) * (s.c * (s.a + s.b + s.c) / (4 * s.area));
  return std::min(ratio, std::numeric_limits<double>::max());
}

Distribution distribution(Buffer<double>& values) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (values.empty()) return {kNone, kNone, kNone, kNone, kNone, kNone};
  WideSum sum;
  for (const double value : values) sum.add(value);
  const auto [min, max] = std::minmax_element(values.begin(), values.end());
  Distribution result{*min, 0, 0, 0, *max, sum.value() / static_cast<double>(values.size())};
  // Rank ceil(hundredths n / 100), in whole numbers.
  const auto at = [&](std::size_t hundredths) {
    const std::size_t rank = (values.size() * hundredths + 99) / 100;
    return values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  };
  const auto low = at(1), middle = at(50), high = at(99);
  std::nth_element(values.begin(), middle, values.end());
  result.median = *middle;
  if (low != middle) std::nth_element(values.begin(), low, middle);
  result.p01 = *low;
  if (high != middle) std::nth_element(middle + 1, high, values.end());
  result.p99 = *high;
  return result;
}

bool has_repeated_index(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

void require_vertices(const IndexedMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (v >= mesh.vertex_count())
        throw InvalidInput(fmt::format("triangle {} names vertex {}, but there are {} vertices", t,
                                       v, mesh.vertex_count()));
}

template <class Value>
void fill(const IndexedMesh& mesh, Buffer<double>& values, Value&& value) {
  values.resize(mesh.triangle_count());
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, mesh.triangle_count(), kTrianglesPerTask),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t t = range.begin(); t < range.end(); ++t)
          values[t] = value(has_repeated_index(mesh.triangles[t]) ? Shape{} : shape_of(mesh, t));
      });
}

void fill_edge_lengths(const IndexedMesh& mesh, Buffer<double>& lengths) {
  const EdgeBuckets buckets(mesh.triangles, mesh.vertex_count());
  lengths.clear();
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    for_each_edge(buckets.at(v), [&](std::span<const EdgeEntry> edge) {
      lengths.push_back(norm(mesh.positions[edge[0].larger()] - mesh.positions[v]));
    });
}

// -1 where there is none.
double aspect_ratio_or_none(const Shape& s) { return s.area > 0 ? aspect_ratio(s) : -1; }

void fill_aspect_ratios(const IndexedMesh& mesh, Buffer<double>& values) {
  fill(mesh, values, aspect_ratio_or_none);
  std::erase(values, -1.0);
}

// From 0 at `lower` to 1 at `upper`.
double place(double value, BinScale scale, double lower, double upper) {
  if (scale == BinScale::linear) return (value - lower) / (upper - lower);
  return std::log(value / lower) / std::log(upper / lower);
}

}  // namespace

MeshQuality quality(const IndexedMesh& mesh) {
  MeshQuality result{};
  Buffer<double> values;  // one array for all three, the largest thing here
  fill_edge_lengths(mesh, values);
  result.edge_length = distribution(values);
  fill(mesh, values, min_angle_deg);
  result.min_angle_deg = distribution(values);
  fill_aspect_ratios(mesh, values);
  result.degenerate_triangles = mesh.triangle_count() - values.size();
  result.aspect_ratio = distribution(values);
  return result;
}

Histogram histogram(std::span<const double> values, BinScale scale, double lower, double upper,
                    std::size_t bins) {
  if (bins == 0) throw InvalidInput("a histogram needs at least one bin");
  if (!(lower < upper) || (scale == BinScale::logarithmic && !(lower > 0))) {
    throw InvalidInput(
        "the bounds of a histogram must rise, those of logarithmic bins from above 0");
  }
  Histogram result{scale, lower, upper, 0, 0, std::vector<std::uint64_t>(bins)};
  for (const double value : values) {
    if (!(value >= lower)) {
      ++result.below;
    } else if (value > upper) {
      ++result.above;
    } else {
      const double bin = place(value, scale, lower, upper) * static_cast<double>(bins);
      ++result.counts[std::min(static_cast<std::size_t>(bin), bins - 1)];
    }
  }
  return result;
}

QualityHistograms quality_histograms(const IndexedMesh& mesh) {
  QualityHistograms result;
  Buffer<double> values;
  fill_edge_lengths(mesh, values);
  result.edge_length = histogram(values, BinScale::logarithmic, 0x1p-10, 4, 48);
  // No smallest angle is above 60 degrees and no aspect ratio below 1, but for rounding.
  fill(mesh, values, [](const Shape& s) { return std::min(min_angle_deg(s), 60.0); });
  result.min_angle_deg = histogram(values, BinScale::linear, 0, 60, 30);
  fill_aspect_ratios(mesh, values);
  for (double& value : values) value = std::max(value, 1.0);
  result.aspect_ratio = histogram(values, BinScale::logarithmic, 1, 1024, 40);
  return result;
}

std::vector<float> min_angles_deg(const IndexedMesh& mesh) {
  require_vertices(mesh);
  Buffer<double> values;
  fill(mesh, values, min_angle_deg);
  return {values.begin(), values.end()};
}

}  // namespace vdwmesh
