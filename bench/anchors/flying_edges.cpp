#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "anchors/anchors.hpp"

namespace vdwmesh::anchors {
namespace {

constexpr double kBand = 2;  // spacings on either side of the surface where distances are wanted

struct DistanceGrid {
  double origin[3], spacing;  // Å
  int nodes[3];
  vtkNew<vtkFloatArray> values;
};

void make_grid(const std::vector<Sphere>& spheres, double spacing, DistanceGrid& grid) {
  const Box box = bounding_box(SphereSet(spheres));
  grid.spacing = spacing;
  vtkIdType count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double padding = 3 * spacing;
    grid.origin[axis] = box.lower[axis] - padding;
    const double length = box.upper[axis] + padding - grid.origin[axis];
    grid.nodes[axis] = static_cast<int>(std::ceil(length / spacing)) + 1;
    count *= grid.nodes[axis];
  }
  grid.values->SetNumberOfValues(count);
  std::fill_n(grid.values->GetPointer(0), count, static_cast<float>(kBand * spacing));
}

struct Nodes {
  int first, last;
};

// Nodes along one axis within `reach` of the centre.
Nodes nodes_within(const DistanceGrid& grid, int axis, double center, double reach) {
  const double at = (center - grid.origin[axis]) / grid.spacing;
  return {std::max(0, static_cast<int>(std::ceil(at - reach / grid.spacing))),
          std::min(grid.nodes[axis] - 1, static_cast<int>(std::floor(at + reach / grid.spacing)))};
}

// The row loop is plain enough for the compiler to use all lanes.
void lower_row(float* row, int count, float x, float step, float rest, float radius) {
  for (int i = 0; i < count; ++i) {
    const float dx = x + step * static_cast<float>(i);
    const float distance = std::sqrt(dx * dx + rest) - radius;
    row[i] = distance < row[i] ? distance : row[i];
  }
}

// Each sphere visits the nodes of the rows that cross its ball and band, and no others.
void add_sphere(DistanceGrid& grid, const Sphere& sphere) {
  const double reach = sphere.radius + kBand * grid.spacing;
  float* values = grid.values->GetPointer(0);
  const Nodes zs = nodes_within(grid, 2, sphere.center.z, reach);
  for (int z = zs.first; z <= zs.last; ++z) {
    const double dz = grid.origin[2] + z * grid.spacing - sphere.center.z;
    const double in_plane = std::sqrt(std::max(0.0, reach * reach - dz * dz));
    const Nodes ys = nodes_within(grid, 1, sphere.center.y, in_plane);
    for (int y = ys.first; y <= ys.last; ++y) {
      const double dy = grid.origin[1] + y * grid.spacing - sphere.center.y;
      const double rest = dy * dy + dz * dz;
      const Nodes xs =
          nodes_within(grid, 0, sphere.center.x, std::sqrt(std::max(0.0, reach * reach - rest)));
      const vtkIdType row =
          (static_cast<vtkIdType>(z) * grid.nodes[1] + y) * grid.nodes[0] + xs.first;
      lower_row(values + row, xs.last - xs.first + 1,
                static_cast<float>(grid.origin[0] + xs.first * grid.spacing - sphere.center.x),
                static_cast<float>(grid.spacing), static_cast<float>(rest),
                static_cast<float>(sphere.radius));
    }
  }
}

}  // namespace

std::uint64_t flying_edges(const std::vector<Sphere>& spheres, double spacing) {
  // Not by vtkSMPTools, whose header is not C++20.
  setenv("VTK_SMP_MAX_THREADS", "1", 1);
  setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", 1);
  DistanceGrid grid;
  make_grid(spheres, spacing, grid);
  for (const Sphere& sphere : spheres) add_sphere(grid, sphere);
  vtkNew<vtkImageData> image;
  image->SetDimensions(grid.nodes);
  image->SetOrigin(grid.origin);
  image->SetSpacing(spacing, spacing, spacing);
  image->GetPointData()->SetScalars(grid.values);
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(image);
  contour->SetValue(0, 0);
  contour->ComputeNormalsOn();
  contour->ComputeScalarsOff();
  contour->Update();
  return static_cast<std::uint64_t>(contour->GetOutput()->GetNumberOfPolys());
}

}  // namespace vdwmesh::anchors
