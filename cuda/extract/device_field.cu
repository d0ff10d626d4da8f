// Prepares the spheres of a field for searches on the device: float4 copies of centre and reach
// (RoughSpheres), relative to the grid's origin. With them gather_by_warp() rules out spheres that
// do not reach a box. The copies take half the memory of the spheres in double. The reach is
// widened by more than all rounding errors, so no sphere that reaches a box is ruled out.
#include <algorithm>

#include "cuda/extract/extract_stages.cuh"
#include "cuda/memory/launch.cuh"
#include "extract/blended/field_formulas.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;

// Writes the float4 copy of each sphere. A thread per sphere of the list.
__global__ void round_spheres(CellListView list, FieldModel model, float margin, Vec3d origin,
                              float4* rough) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= list.size) return;
  const Sphere& s = list.spheres[i];
  const Vec3d c = s.center - origin;
  // With sub-grids the distance of an atom does not decide, as in reaches_box(): its reach is made
  // endless, so that it is never ruled out. 1e18 still has a finite square in float32.
  const bool endless = model.kind != FieldKind::vdw && model.truncation == Truncation::subgrid;
  const auto reach = static_cast<float>(field_reach(model, s.radius));
  rough[i] = {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z),
              endless ? 1e18f : reach * (1 + 1e-5f) + margin};
}

// A bound, Å, on the rounding error of float32 distances between points of the grid and the spheres
// near it. All coordinates involved are at most about `extent`: the longest side of the grid plus
// the largest reach of every level. 1e-6 is 17 units of 2^-24, the relative rounding error; a
// distance takes fewer roundings.
float rounding_margin(const CellListView& list, const GridSpec& grid) {
  double extent = 0;
  for (int axis = 0; axis < 3; ++axis) {
    extent = std::max(extent, static_cast<double>(grid.cells[axis] + 2) * grid.spacing);
  }
  for (int l = 0; l < list.level_count; ++l) extent += list.levels[l].reach;
  return static_cast<float>(1e-6 * extent);
}

}  // namespace

DeviceField::DeviceField(const CellListView& list, const FieldModel& model, const Stream& stream)
    : rough_(list.size, stream.get()), context_{list, model, {rough_.data(), model.grid.origin}} {
  launch("round_spheres", round_spheres, over(list.size, kThreads), stream, list, model,
         rounding_margin(list, model.grid), model.grid.origin, rough_.data());
}

}  // namespace vdwmesh
