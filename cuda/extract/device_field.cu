#include <algorithm>

#include "cuda/extract/extract_stages.cuh"
#include "extract/blended/field_formulas.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;

__global__ void round_spheres(CellListView list, FieldModel model, float margin, Vec3d origin,
                              float4* rough) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= list.size) return;
  const Sphere& s = list.spheres[i];
  const Vec3d c = s.center - origin;
  // Under a sub-grid all atoms of the cells near a box are taken.
  const bool endless = model.kind != FieldKind::vdw && model.truncation == Truncation::subgrid;
  const auto reach = static_cast<float>(field_reach(model, s.radius));
  rough[i] = {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z),
              endless ? 1e18f : reach * (1 + 1e-5f) + margin};
}

// More than the rounding of distances between points of the grid and of spheres near it, Å.
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
  if (list.size == 0) return;
  round_spheres<<<blocks_for(list.size, kThreads), kThreads, 0, stream.get()>>>(
      list, model, rounding_margin(list, model.grid), model.grid.origin, rough_.data());
  check_launch("round_spheres");
}

}  // namespace vdwmesh
