// Quality of triangles: smallest angles, aspect ratios and edge lengths, as distributions and as
// histograms.
//
//  1. The corners of a block of triangles are gathered into arrays of coordinates.
//  2. Loops that the compiler makes vectors of compute the edge lengths and the area of each
//     triangle, and from these its smallest angle and its aspect ratio.
//  3. While the values of a block are in the cache, they go to BracketedValues or into a histogram.
//     Only the histogram of edge lengths needs all values in one array.
//
// A sample of the triangles gives a first guess of each percentile; a bracket is a narrow interval
// around it. Only values in brackets are stored, all others are counted
// (analysis/distances/distribution.hpp). If a percentile lies in no bracket, a second pass stores
// all values.
//
// The edge lengths come from survey_part(), which sees each edge once.
//
// A triangle is degenerate if it has a repeated index or area exactly 0. It has the angle 0 and no
// aspect ratio.
#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "analysis/distances/distribution.hpp"
#include "analysis/mesh_measures.hpp"
#include "analysis/quality_histograms.hpp"
#include "analysis/survey/quality_parts.hpp"
#include "analysis/survey/vertex_survey.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/lanes/multiversion.hpp"
#include "surface/triangle_check.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kTrianglesPerTask = 1 << 12;
constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

// The corners of up to kSize triangles, coordinate by coordinate, and what follows from them.
struct ShapeBlock {
  static constexpr std::size_t kSize = 256;
  using Column = std::array<double, kSize>;

  std::array<Vec3<Column>, 3> corners;  // Å
  Column is_proper;                     // 0 if the triangle has a repeated index, else 1
  Column sine, cosine;                  // of the smallest angle, both times the same factor
  Column ratio;                         // the aspect ratio, or -1 if the triangle has no area
};

bool has_repeated_index(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

void gather(const IndexedMesh& mesh, std::size_t first, std::size_t count, ShapeBlock& block) {
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle& triangle = mesh.triangles[first + i];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& p = mesh.positions[triangle[k]];
      block.corners[k].x[i] = p.x, block.corners[k].y[i] = p.y, block.corners[k].z[i] = p.z;
    }
    block.is_proper[i] = has_repeated_index(triangle) ? 0 : 1;
  }
}

// With the edge lengths a >= b >= c and the area A, the smallest angle lies between a and b. Its
// sine is 2 A / (a b), and by the law of cosines its cosine is (a² + b² - c²) / (2 a b). The block
// gets both multiplied by 2 a b. The code writes a² - c² as (a - c)(a + c), which keeps its digits
// if a and c are nearly equal.
//
// The aspect ratio is R / (2 r) = a b c (a + b + c) / (16 A²), from the circumradius
// R = a b c / (4 A) and the inradius r = 2 A / (a + b + c). An overflow becomes the largest double,
// so the ratio of a triangle of finite area is finite. A triangle with a repeated index has area 0,
// even if rounding would give another one.
VDWMESH_MULTIVERSION void compute(std::size_t count, ShapeBlock& block) {
  const auto& [first, second, third] = block.corners;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d p{first.x[i], first.y[i], first.z[i]}, q{second.x[i], second.y[i], second.z[i]},
        r{third.x[i], third.y[i], third.z[i]};
    const Vec3d pq = q - p, pr = r - p;
    const double l = norm(pq), m = norm(pr), n = norm(r - q);
    const double larger = std::max(l, m), smaller = std::min(l, m);
    const double longest = std::max(larger, n), rest = std::min(larger, n);
    const double middle = std::max(smaller, rest), shortest = std::min(smaller, rest);
    const double area = block.is_proper[i] != 0 ? norm(cross(pq, pr)) / 2 : 0;
    block.sine[i] = 4 * area;
    block.cosine[i] = middle * middle + (longest - shortest) * (longest + shortest);
    const double ratio =
        (longest * middle / (4 * area)) * (shortest * (longest + middle + shortest) / (4 * area));
    const double finite = std::min(ratio, std::numeric_limits<double>::max());
    block.ratio[i] = area > 0 ? finite : -1;
  }
}

// A thread's memory for the shapes of the triangles of one task, computed block by block. The
// result of of() is valid until the next call.
struct Shapes {
  ShapeBlock block;
  std::vector<double> angles, ratios;

  TriangleShapes of(const IndexedMesh& mesh, std::size_t first, std::size_t last) {
    angles.resize(last - first);
    ratios.resize(last - first);
    std::size_t with_area = 0;
    for (std::size_t from = first; from < last; from += ShapeBlock::kSize) {
      const std::size_t count = std::min(ShapeBlock::kSize, last - from);
      gather(mesh, from, count, block);
      compute(count, block);
      for (std::size_t i = 0; i < count; ++i) {
        const double angle = std::atan2(block.sine[i], block.cosine[i]) * kDegreesPerRadian;
        // A degenerate triangle has the angle 0 even if its cosine is NaN.
        angles[from - first + i] = block.sine[i] == 0 ? 0 : angle;
        ratios[with_area] = block.ratio[i];  // kept, without a branch, if the triangle has an area
        with_area += block.ratio[i] != -1;
      }
    }
    return {angles, std::span<const double>(ratios).first(with_area)};
  }
};

// Returns the relative position of a value between the bounds of a histogram, on the chosen scale:
// 0 at `lower`, 1 at `upper`.
double place(double value, BinScale scale, double lower, double upper) {
  if (scale == BinScale::linear) return (value - lower) / (upper - lower);
  return std::log(value / lower) / std::log(upper / lower);
}

// Adds the counts of `other` to `sum`. Precondition: both have the same bins.
void add(Histogram& sum, const Histogram& other) {
  sum.below += other.below;
  sum.above += other.above;
  for (std::size_t i = 0; i < sum.counts.size(); ++i) sum.counts[i] += other.counts[i];
}

}  // namespace

// `visit` is called by several threads at once, as BracketedValues::add() may be.
void visit_shapes(const MeshPart& part,
                  const std::function<void(std::size_t, const TriangleShapes&)>& visit) {
  tbb::enumerable_thread_specific<Shapes> threads;
  for_each_block(part.triangles, kTrianglesPerTask,
                 [&](std::size_t, std::size_t first, std::size_t last) {
                   visit(first, threads.local().of(part.mesh, first, last));
                 });
}

std::size_t usual_sample_step(std::uint64_t triangles) {
  constexpr std::uint64_t kSample = 1 << 13;  // triangles
  // An odd step, since meshes often store triangles in pairs.
  return static_cast<std::size_t>(triangles / kSample + 1) | 1;
}

QualitySample sample_quality(const MeshPart& part, std::size_t step) {
  QualitySample sample;
  if (part.triangles < kFewTriangles) return sample;  // without a sample, all values are stored
  Shapes shapes;
  for (std::size_t t = 0; t < part.triangles; t += step) {
    const auto& [a, b, c] = part.mesh.triangles[t];
    if (std::max({a, b, c}) >= part.mesh.vertex_count()) continue;  // survey_part() refuses it
    const TriangleShapes found = shapes.of(part.mesh, t, t + 1);
    sample.min_angles_deg.push_back(found.min_angles_deg[0]);
    if (!found.aspect_ratios.empty()) sample.aspect_ratios.push_back(found.aspect_ratios[0]);
    const Buffer<Vec3d>& p = part.mesh.positions;
    sample.edge_lengths.insert(sample.edge_lengths.end(),
                               {norm(p[b] - p[a]), norm(p[c] - p[b]), norm(p[a] - p[c])});
  }
  return sample;
}

// The first try takes brackets from the sample. If a percentile is in none of them, the second one
// stores all values.
MeshQuality quality_of_triangles(const IndexedMesh& mesh, QualitySample sample) {
  MeshQuality result{};
  const auto fill = [&](const Brackets& of_angles, const Brackets& of_ratios) {
    BracketedValues all_angles(of_angles), all_ratios(of_ratios);
    visit_shapes(whole(mesh), [&](std::size_t, const TriangleShapes& shapes) {
      all_angles.add(shapes.min_angles_deg);
      all_ratios.add(shapes.aspect_ratios);
    });
    const auto angles = distribution_of(all_angles), ratios = distribution_of(all_ratios);
    if (!angles || !ratios) return false;
    result.min_angle_deg = *angles;
    result.aspect_ratio = *ratios;
    result.degenerate_triangles = mesh.triangle_count() - all_ratios.summary().count;
    return true;
  };
  if (!fill(brackets_from_sample(std::move(sample.min_angles_deg)),
            brackets_from_sample(std::move(sample.aspect_ratios))))
    (void)fill(bracket_of_everything(), bracket_of_everything());
  return result;
}

MeshQuality quality(const IndexedMesh& mesh) {
  const MeshPart part = whole(mesh);
  QualitySample sample = sample_quality(part, usual_sample_step(mesh.triangle_count()));
  const Distribution edge_length = distribution_by_sample(
      std::move(sample.edge_lengths),
      [&](BracketedValues& lengths) { survey_part(part, {.edge_lengths = &lengths}); });
  MeshQuality result = quality_of_triangles(mesh, std::move(sample));
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
  Histogram result{.scale = scale,
                   .lower = lower,
                   .upper = upper,
                   .below = 0,
                   .above = 0,
                   .counts = std::vector<std::uint64_t>(bins)};
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
  const MeshPart part = whole(mesh);
  BracketedValues lengths(bracket_of_everything());
  survey_part(part, {.edge_lengths = &lengths});
  // All values are in the only bracket. Edge lengths have four bins for each factor of 2, Å.
  result.edge_length = histogram(lengths.inside(0), BinScale::logarithmic, 0x1p-10, 4, 48);
  // The smallest angle of a triangle is at most 60 degrees and its aspect ratio at least 1. Values
  // that rounding put beyond these bounds are clamped, so that they count in a bin. A bin of angles
  // has 2 degrees; ratios have four bins for each factor of 2.
  const auto of_angles = [](std::span<const double> angles) {
    return histogram(angles, BinScale::linear, 0, 60, 30);
  };
  const auto of_ratios = [](std::span<const double> ratios) {
    return histogram(ratios, BinScale::logarithmic, 1, 1024, 40);
  };
  struct ThreadQuality {
    Histogram angles, ratios;
    std::vector<double> clamped;
  };
  tbb::enumerable_thread_specific<ThreadQuality> threads(
      ThreadQuality{of_angles({}), of_ratios({}), {}});
  visit_shapes(part, [&](std::size_t, const TriangleShapes& shapes) {
    ThreadQuality& mine = threads.local();
    mine.clamped.assign(shapes.min_angles_deg.begin(), shapes.min_angles_deg.end());
    for (double& angle : mine.clamped) angle = std::min(angle, 60.0);
    add(mine.angles, of_angles(mine.clamped));
    mine.clamped.assign(shapes.aspect_ratios.begin(), shapes.aspect_ratios.end());
    for (double& ratio : mine.clamped) ratio = std::max(ratio, 1.0);
    add(mine.ratios, of_ratios(mine.clamped));
  });
  result.min_angle_deg = of_angles({});
  result.aspect_ratio = of_ratios({});
  for (const ThreadQuality& mine : threads) {
    add(result.min_angle_deg, mine.angles);
    add(result.aspect_ratio, mine.ratios);
  }
  return result;
}

std::vector<float> min_angles_deg(const IndexedMesh& mesh) {
  check_triangles(mesh.triangles, mesh.vertex_count());
  std::vector<float> angles(mesh.triangle_count());
  visit_shapes(whole(mesh), [&](std::size_t first, const TriangleShapes& shapes) {
    std::ranges::transform(shapes.min_angles_deg, &angles[first],
                           [](double angle) { return static_cast<float>(angle); });
  });
  return angles;
}

}  // namespace vdwmesh
