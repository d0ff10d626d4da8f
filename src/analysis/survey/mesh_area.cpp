// The area of a mesh as an interval (MeshArea), and the map from the interval to points.
//
// The subinterval of a triangle begins at the prefix sum of the areas before it. Only one prefix
// sum for each block of 2048 triangles is stored; within a block a cursor adds up the areas. The
// position within the subinterval, as a fraction of its length, selects a point of the triangle by
// point_of_triangle().
#include "analysis/survey/mesh_area.hpp"

#include <algorithm>
#include <array>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/lanes/multiversion.hpp"
#include "core/sum.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kPerBlock = kTrianglesPerAreaBlock;

// Writes the areas of the triangles [first, end).
VDWMESH_MULTIVERSION void fill_areas(const IndexedMesh& mesh, std::size_t first, std::size_t end,
                                     double* areas) {
  for (std::size_t t = first; t < end; ++t) areas[t - first] = area_of(corners_of(mesh, t));
}

}  // namespace

std::vector<double> area_block_starts(std::span<const double> sums) {
  WideSum total;
  std::vector<double> starts;
  starts.reserve(sums.size() + 1);
  for (const double sum : sums) {
    starts.push_back(total.value());
    total.add(sum);
  }
  starts.push_back(total.value());
  if (!(total.value() > 0)) throw InvalidInput("the mesh has no area");
  return starts;
}

MeshArea::MeshArea(const IndexedMesh& mesh) : mesh_(mesh) {
  const std::size_t count = mesh.triangle_count();
  std::vector<double> sums(block_count(count, kPerBlock));
  for_each_block(count, kPerBlock, [&](std::size_t block, std::size_t first, std::size_t last) {
    std::array<double, kPerBlock> areas;
    fill_areas(mesh, first, last, areas.data());
    for (std::size_t i = 0; i < last - first; ++i) sums[block] += areas[i];
  });
  starts_ = area_block_starts(sums);
}

// Enters the first triangle of the block that contains the position: the last block that begins at
// or before it. The end of the last block, starts_.back(), is left out of the search, so that a
// position at the end of the interval is in the last block.
MeshArea::Cursor::Cursor(const MeshArea& area, double place) : area_(area) {
  const auto next = std::upper_bound(area.starts_.begin() + 1, area.starts_.end() - 1, place);
  enter(kPerBlock * static_cast<std::size_t>(next - area.starts_.begin() - 1));
}

// Makes a triangle the current one. Precondition: it is the first of a block, or the next one after
// the current triangle. Its subinterval begins at the stored prefix sum if a block begins there,
// and otherwise at the end of the previous subinterval; it is the same wherever the cursor started.
void MeshArea::Cursor::enter(std::size_t triangle) {
  const std::size_t block = triangle / kPerBlock, place = triangle % kPerBlock;
  if (place == 0) {
    fill_areas(area_.mesh_, triangle, std::min(triangle + kPerBlock, area_.mesh_.triangle_count()),
               areas_.data());
  }
  begin_ = place == 0 ? area_.starts_[block] : end_;
  end_ = end_of_area(begin_, areas_[place], area_.starts_[block + 1]);
  triangle_ = triangle;
}

// Goes on to the first triangle that ends beyond the position. A position beyond the end of the
// last triangle, which rounding can cause, belongs to the last triangle.
Vec3d MeshArea::Cursor::point_at(double place) {
  while (!(place < end_) && triangle_ + 1 < area_.mesh_.triangle_count()) enter(triangle_ + 1);
  return point_at_area(corners_of(area_.mesh_, triangle_), begin_, place);
}

}  // namespace vdwmesh
