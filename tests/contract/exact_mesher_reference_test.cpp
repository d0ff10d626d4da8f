// The published sets, probes 0 and 1.4 Å: topology of the reference, sound before and after
// subdivision.
#include "contract/exact_mesher_contract.hpp"
#include "unit/arrangement/union_reference_sets.hpp"

namespace vdwmesh::testing {
namespace {

class ExactMesherReference : public ExactMesherContract {};
VDWMESH_INSTANTIATE_BACKENDS(ExactMesherReference);

// 25 sets with two probes each; a table that lost its rows would test nothing.
std::vector<ReferenceRow> all_rows() {
  std::vector<ReferenceRow> rows = reference_rows();
  EXPECT_EQ(rows.size(), 50u);
  return rows;
}

void expect_reference(const ReferenceRow& row, double edge_length, int levels) {
  SCOPED_TRACE(row.set + ", probe " + std::to_string(row.probe) + ", edge length " +
               std::to_string(edge_length));
  const SphereSet spheres(reference_balls(row.set, row.probe));
  const ExactUnion exact = exact_union(spheres);
  const IndexedMesh mesh = mesh_at(spheres, edge_length).mesh;
  for (int level = 0; level <= levels; ++level) {
    SCOPED_TRACE("level " + std::to_string(level));
    const IndexedMesh finer = subdivided(spheres, mesh, level);
    expect_union_mesh(spheres, finer, exact, {});
    const MeshTopology found = topology(finer);
    EXPECT_EQ(found.euler_characteristic, row.euler_characteristic);
    EXPECT_EQ(found.components, row.components);
    EXPECT_EQ(found.voids, row.voids);
    EXPECT_EQ(found.genus, row.tunnels);
  }
}

TEST_P(ExactMesherReference, SmallSets) {
  VDWMESH_NEEDS_SHARED("reference/union_of_balls.csv");
  for (const ReferenceRow& row : all_rows()) {
    if (row.balls <= 330) expect_reference(row, 0.35, row.balls <= 40 ? 2 : 0);
  }
}

TEST_P(ExactMesherReference, AllSetsButTheRibosome) {
  VDWMESH_NEEDS_SHARED("reference/union_of_balls.csv");
  for (const ReferenceRow& row : all_rows()) {
    if (row.set != "6ZU5") expect_reference(row, 0.5, row.balls <= 330 ? 1 : 0);
  }
}

}  // namespace
}  // namespace vdwmesh::testing
