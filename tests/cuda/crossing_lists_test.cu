// The lists of pairs in the device's search for crossings, with so little room that they are filled
// again and again, against the CPU.
//
// A blended field's mesh is projected onto the balls, so vertices move on level 0 too, and
// triangles cross on every level. Some patches have more neighbours in their cells than the
// smallest list has room for.
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "core/workspace.hpp"
#include "cuda/parity.hpp"
#include "cuda/refine/device_refinement.cuh"
#include "extract/field_list.hpp"

namespace vdwmesh::testing {
namespace {

class CrossingLists : public Parity {};

TEST_F(CrossingLists, MeshesDoNotDependOnTheirRoom) {
  const SphereSet spheres = crowd(60, 4, 0.3, 2.0, 12);
  const ExtractOptions extract = options_of(FieldKind::blinn, 0.7);
  const GridSpec grid = make_grid(spheres, extract.grid);
  const FieldModel model = make_field_model(extract.field, grid);
  const CellList list = make_field_list(spheres, model);
  const Stream stream;
  const DeviceCellList device_list(list.view(), stream.get());
  const IndexedMesh mesh = make_extractor(Backend::cpu)->extract(spheres, extract).mesh;
  for (const int subdivisions : {0, 1, 2}) {
    RefineOptions options;
    options.subdivisions = subdivisions;
    const RefineResult cpu = make_refiner(Backend::cpu)->refine(spheres, mesh, options);
    options.crossings = Crossings::allow;
    const RefineResult allowed = make_refiner(Backend::cpu)->refine(spheres, mesh, options);
    EXPECT_GT(cpu.levels.back().undone, allowed.levels.back().undone) << "nothing crosses";
    options.crossings = Crossings::undo;
    Workspace workspace;
    const DeviceSurface surface(spheres, options, TriangleLabels::none, workspace, stream);
    for (const std::uint64_t pairs : {1u, 16u, 1000u, 1u << 25}) {
      DeviceExtraction given = extract_on_device(device_list.view(), model, extract, stream);
      const DeviceRefinement refined =
          refine_on_device(surface.view(), std::move(given.mesh), options, stream, pairs);
      const Connectivity connectivity =
          refined.mesh.opposite.size() > 0 ? Connectivity::half_edges : Connectivity::triangles;
      expect_same(cpu.mesh, download(refined.mesh.view(), connectivity, stream),
                  "x" + std::to_string(subdivisions) + ", " + std::to_string(pairs) + " pairs");
      EXPECT_EQ(taken_back(cpu.levels), taken_back(refined.levels));
    }
  }
}

}  // namespace
}  // namespace vdwmesh::testing
