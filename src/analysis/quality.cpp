// Quality of triangles: smallest angles, aspect ratios and edge lengths, as distributions and as
// histograms.
//
// The Shape of a triangle has its three edge lengths and its area, from which its smallest angle
// and its aspect ratio follow. EdgeBuckets (mesh/edge_buckets.hpp) group the half-edges of each
// edge, so that an edge of two triangles counts once. All values are written into arrays in
// parallel; distribution_of() or histogram() evaluates the arrays.
//
// A triangle is degenerate if it has a repeated index or area exactly 0. It has the angle 0 and no
// aspect ratio.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "analysis/distribution.hpp"
#include "analysis/mesh_measures.hpp"
#include "analysis/quality_histograms.hpp"
#include "analysis/quality_parts.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/large_pages.hpp"
#include "core/multiversion.hpp"
#include "mesh/edge_buckets.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kItemsPerTask = 1 << 13;
constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

// The edge lengths a >= b >= c (Å) and the area (Å²) of a triangle.
struct Shape {
  double a, b, c, area;
};

Shape shape_of(const IndexedMesh& mesh, std::size_t t) {
  const auto& [i, j, k] = mesh.triangles[t];
  const Vec3d ij = mesh.positions[j] - mesh.positions[i];
  const Vec3d ik = mesh.positions[k] - mesh.positions[i];
  double a = norm(ij), b = norm(ik), c = norm(mesh.positions[k] - mesh.positions[j]);
  // Three exchanges sort the lengths.
  if (a < b) std::swap(a, b);
  if (b < c) std::swap(b, c);
  if (a < b) std::swap(a, b);
  return {a, b, c, norm(cross(ij, ik)) / 2};
}

// Returns the smallest angle, which lies between the two longer sides a and b. Its sine is
// 2 A / (a b) with the area A, and by the law of cosines its cosine is (a² + b² - c²) / (2 a b).
// The code passes both, multiplied by 2 a b, to atan2(), which needs only their ratio. It writes
// a² - c² as (a - c)(a + c), which keeps its digits if a and c are nearly equal.
double min_angle_deg(const Shape& s) {
  if (s.area == 0) return 0;
  const double twice_ab_cos = s.b * s.b + (s.a - s.c) * (s.a + s.c);
  return std::atan2(4 * s.area, twice_ab_cos) * kDegreesPerRadian;
}

// Returns R / (2 r) = a b c (a + b + c) / (16 A²), from the circumradius R = a b c / (4 A) and the
// inradius r = 2 A / (a + b + c). An overflow becomes the largest double, so every ratio is finite.
// Precondition: the area is above 0.
double aspect_ratio(const Shape& s) {
  const double ratio = (s.a * s.b / (4 * s.area)) * (s.c * (s.a + s.b + s.c) / (4 * s.area));
  return std::min(ratio, std::numeric_limits<double>::max());
}

bool has_repeated_index(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

// Throws InvalidInput if a triangle names a vertex that does not exist.
void require_vertices(const IndexedMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (v >= mesh.vertex_count())
        throw InvalidInput(fmt::format("triangle {} names vertex {}, but there are {} vertices", t,
                                       v, mesh.vertex_count()));
}

// Returns the shape of triangle t; if it has a repeated index, a shape of area 0, even if rounding
// would give another area.
Shape shape_or_none(const IndexedMesh& mesh, std::size_t t) {
  return has_repeated_index(mesh.triangles[t]) ? Shape{} : shape_of(mesh, t);
}

// Returns the aspect ratio, or -1 if the triangle has no area. No aspect ratio is negative, so
// triangle_shapes() can remove exactly these entries.
double aspect_ratio_or_none(const Shape& s) { return s.area > 0 ? aspect_ratio(s) : -1; }

// ---- Loops that are compiled for both processor versions (core/multiversion.hpp) ----

// Writes angle and ratio of the triangles [first, last) into the elements of the same index.
// Returns whether all these triangles have an aspect ratio.
VDWMESH_MULTIVERSION bool fill_shapes(const IndexedMesh& mesh, std::size_t first, std::size_t last,
                                      double* angles, double* ratios) {
  bool all = true;
  for (std::size_t t = first; t < last; ++t) {
    const Shape shape = shape_or_none(mesh, t);
    angles[t] = min_angle_deg(shape);
    ratios[t] = aspect_ratio_or_none(shape);
    all &= shape.area > 0;
  }
  return all;
}

// Writes the lengths of all edges whose smaller vertex index is in [first, last), one after
// another, beginning at `lengths`.
VDWMESH_MULTIVERSION void fill_lengths(const IndexedMesh& mesh, const EdgeBuckets& buckets,
                                       std::size_t first, std::size_t last, double* lengths) {
  for (std::size_t v = first; v < last; ++v)
    for_each_edge(buckets.at(v), [&](std::span<const EdgeEntry> edge) {
      *lengths++ = norm(mesh.positions[edge[0].larger()] - mesh.positions[v]);
    });
}

// Returns the relative position of a value between the bounds of a histogram, on the chosen scale:
// 0 at `lower`, 1 at `upper`.
double place(double value, BinScale scale, double lower, double upper) {
  if (scale == BinScale::linear) return (value - lower) / (upper - lower);
  return std::log(value / lower) / std::log(upper / lower);
}

}  // namespace

TriangleShapes triangle_shapes(const MeshPart& part) {
  TriangleShapes shapes;
  resize_untouched(shapes.min_angles_deg, part.triangles);
  resize_untouched(shapes.aspect_ratios, part.triangles);
  std::atomic<bool> all = true;
  for_each_block(part.triangles, kItemsPerTask,
                 [&](std::size_t, std::size_t first, std::size_t last) {
                   if (!fill_shapes(part.mesh, first, last, shapes.min_angles_deg.data(),
                                    shapes.aspect_ratios.data()))
                     all = false;
                 });
  if (!all) std::erase(shapes.aspect_ratios, -1.0);
  return shapes;
}

// A task is a range of kItemsPerTask own vertices. A first pass counts the edges of every task into
// before[task + 1]; the prefix sums make before[task] the number of edges of all earlier tasks,
// which is where a second pass writes. The last task may be empty.
Buffer<double> edge_lengths(const MeshPart& part, const EdgeBuckets& buckets) {
  const std::size_t vertices = part.end_vertex - part.first_vertex;
  std::vector<std::size_t> before(block_count(vertices, kItemsPerTask) + 1);
  const auto each_task = [&](auto&& body) {
    for_each_block(vertices, kItemsPerTask,
                   [&](std::size_t task, std::size_t first, std::size_t last) {
                     body(task, part.first_vertex + first, part.first_vertex + last);
                   });
  };
  each_task([&](std::size_t task, std::size_t first, std::size_t last) {
    std::size_t edges = 0;
    for (std::size_t v = first; v < last; ++v)
      for_each_edge(buckets.at(v), [&](std::span<const EdgeEntry>) { ++edges; });
    before[task + 1] = edges;
  });
  std::partial_sum(before.begin(), before.end(), before.begin());
  Buffer<double> lengths;
  resize_untouched(lengths, before.back());
  each_task([&](std::size_t task, std::size_t first, std::size_t last) {
    fill_lengths(part.mesh, buckets, first, last, lengths.data() + before[task]);
  });
  return lengths;
}

MeshQuality quality_of_triangles(const IndexedMesh& mesh) {
  MeshQuality result{};
  const TriangleShapes shapes = triangle_shapes(whole(mesh));
  result.min_angle_deg = distribution_of(shapes.min_angles_deg);
  result.aspect_ratio = distribution_of(shapes.aspect_ratios);
  result.degenerate_triangles = mesh.triangle_count() - shapes.aspect_ratios.size();
  return result;
}

MeshQuality quality(const IndexedMesh& mesh) {
  // The edge lengths come first: the buckets end with this statement, before the second step
  // allocates its arrays.
  const Distribution edge_length =
      distribution_of(edge_lengths(whole(mesh), EdgeBuckets(mesh.triangles, mesh.vertex_count())));
  MeshQuality result = quality_of_triangles(mesh);
  result.edge_length = edge_length;
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
    // Written with ! so that NaN counts as below.
    if (!(value >= lower)) {
      ++result.below;
    } else if (value > upper) {
      ++result.above;
    } else {
      // The value `upper` itself would get the number `bins`; it belongs to the last bin.
      const double bin = place(value, scale, lower, upper) * static_cast<double>(bins);
      ++result.counts[std::min(static_cast<std::size_t>(bin), bins - 1)];
    }
  }
  return result;
}

QualityHistograms quality_histograms(const IndexedMesh& mesh) {
  QualityHistograms result;
  result.edge_length =
      histogram(edge_lengths(whole(mesh), EdgeBuckets(mesh.triangles, mesh.vertex_count())),
                BinScale::logarithmic, 0x1p-10, 4, 48);
  // The smallest angle of a triangle is at most 60 degrees and its aspect ratio at least 1. Values
  // that rounding put beyond these bounds are moved to the bound, so that they count in a bin.
  TriangleShapes shapes = triangle_shapes(whole(mesh));
  for (double& angle : shapes.min_angles_deg) angle = std::min(angle, 60.0);
  result.min_angle_deg = histogram(shapes.min_angles_deg, BinScale::linear, 0, 60, 30);
  for (double& ratio : shapes.aspect_ratios) ratio = std::max(ratio, 1.0);
  result.aspect_ratio = histogram(shapes.aspect_ratios, BinScale::logarithmic, 1, 1024, 40);
  return result;
}

std::vector<float> min_angles_deg(const IndexedMesh& mesh) {
  require_vertices(mesh);
  const Buffer<double> angles = triangle_shapes(whole(mesh)).min_angles_deg;
  return {angles.begin(), angles.end()};
}

}  // namespace vdwmesh
