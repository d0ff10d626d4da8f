// check_triangles(): one parallel reduction over the triangles finds the first that names a vertex
// that does not exist, the first that names one twice, and the number of half-edges.
#include "surface/triangle_check.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <functional>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kTrianglesPerTask = 1 << 16;

// What a first look at the triangles finds. The first two members are indices of triangles. The sum
// of two surveys keeps the left one's index if it has one, because the left survey is of earlier
// triangles. The sum is associative, so a parallel reduction finds the first index of all for any
// number of threads.
struct IndexSurvey {
  std::optional<std::size_t> invalid_index;   // first triangle with an index too large: an error
  std::optional<std::size_t> repeated_index;  // first that names a vertex twice: no error here
  std::size_t half_edges = 0;                 // half-edges whose ends differ

  IndexSurvey operator+(const IndexSurvey& later) const {
    return {invalid_index ? invalid_index : later.invalid_index,
            repeated_index ? repeated_index : later.repeated_index, half_edges + later.half_edges};
  }
};

IndexSurvey survey_indices(std::span<const Triangle> triangles, std::size_t vertex_count) {
  using Range = tbb::blocked_range<std::size_t>;
  return tbb::parallel_reduce(
      Range(0, triangles.size(), kTrianglesPerTask), IndexSurvey{},
      [&](const Range& range, IndexSurvey found) {
        for (std::size_t t = range.begin(); t < range.end(); ++t) {
          const auto [i, j, k] = triangles[t];
          if (std::max({i, j, k}) >= vertex_count && !found.invalid_index) found.invalid_index = t;
          const unsigned sides = (i != j) + (j != k) + (k != i);
          if (sides < 3 && !found.repeated_index) found.repeated_index = t;
          found.half_edges += sides;
        }
        return found;
      },
      std::plus<>());
}

}  // namespace

void check_array_sizes(const IndexedMesh& mesh) {
  const auto check = [&](std::size_t size, std::size_t wanted, const char* what) {
    if (size != 0 && size != wanted)
      throw InvalidInput(fmt::format("{} {}, where {} are needed", size, what, wanted));
  };
  check(mesh.normals.size(), mesh.vertex_count(), "vertex normals");
  check(mesh.vertex_spheres.size(), mesh.vertex_count(), "vertex labels");
  check(mesh.vertex_spheres.others.size(), mesh.vertex_count(), "labels of creases");
  check(mesh.triangle_spheres.size(), mesh.triangle_count(), "triangle labels");
  check(mesh.opposite.size(), 3 * mesh.triangle_count(), "opposite half-edges");
}

TriangleCheck check_triangles(std::span<const Triangle> triangles, std::size_t vertex_count) {
  const IndexSurvey found = survey_indices(triangles, vertex_count);
  // The vertex that the message names is the largest of the triangle, hence one that is too large.
  if (found.invalid_index)
    throw InvalidInput(
        fmt::format("triangle {} names vertex {}, but there are {} vertices", *found.invalid_index,
                    std::ranges::max(triangles[*found.invalid_index]), vertex_count));
  return {found.repeated_index, found.half_edges};
}

}  // namespace vdwmesh
