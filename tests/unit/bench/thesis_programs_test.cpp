// Tables 4.1, 4.2 and 4.4 of the thesis: voxel counts to the unit, triangle counts as fitted.
#include "thesis/thesis_programs.hpp"

#include <gtest/gtest.h>

#include "reference/atoms.hpp"
#include "reference/mesh_checks.hpp"
#include "support/shared_files.hpp"

namespace vdwmesh {
namespace {

// As printed in the thesis, Tables 4.2 and 4.4.
struct Entry {
  const char* file;
  std::size_t atoms;
  std::int64_t voxels, vdw_voxels;
  double blinn, soft, inverse_squared, vdw;  // triangles; vdw after one subdivision

  friend void PrintTo(const Entry& e, std::ostream* out) { *out << e.file; }
};

constexpr Entry kEntries[] = {
    {"110D.pdb", 120, 346580, 132526, 14632, 12584, 12852, 33056},
    {"4PTI.pdb", 454, 1043464, 558888, 60910, 48616, 49036, 117792},
    {"1BK2.pdb", 468, 650160, 309205, 63442, 50514, 48960, 120432},
    {"1HH0.cif", 691, 1632000, 914085, 64816, 66268, 51252, 205344},
    {"1QL2.cif", 966, 4619920, 3187548, 129630, 102288, 111920, 246320},
    {"1IZH.pdb", 1520, 2578680, 1639890, 204436, 162554, 176716, 391168},
};

constexpr double kTable42Tolerance = 0.03;  // of the triangle count
constexpr double kTable44Tolerance = 0.04;

class ThesisTables : public ::testing::TestWithParam<Entry> {
 protected:
  double triangles(const std::vector<Vec3d>& atoms, const ThesisParameters& p,
                   std::int64_t voxels) {
    const ThesisGrid grid = thesis_grid(atoms, p);
    EXPECT_EQ(grid.voxel_count(), voxels);
    return static_cast<double>(count_triangles(thesis_field(atoms, grid, p), grid, p.threshold));
  }
};

TEST_P(ThesisTables, AreReproduced) {
  const Entry e = GetParam();
  const std::string file = std::string("molecules/thesis/") + e.file;
  VDWMESH_NEEDS_SHARED(file);
  std::vector<Vec3d> atoms;
  for (const auto& p : reference::read_atom_records(testing::shared_path(file))) {
    atoms.push_back({p[0], p[1], p[2]});
  }
  ASSERT_EQ(atoms.size(), e.atoms);
  const auto table_4_2 = [&](ThesisFunction f) {
    return triangles(atoms, thesis_parameters(f), e.voxels);
  };
  EXPECT_NEAR(table_4_2(ThesisFunction::blinn) / e.blinn, 1, kTable42Tolerance);
  EXPECT_NEAR(table_4_2(ThesisFunction::soft_object) / e.soft, 1, kTable42Tolerance);
  EXPECT_NEAR(table_4_2(ThesisFunction::inverse_squared) / e.inverse_squared, 1, kTable42Tolerance);
  EXPECT_NEAR(triangles(atoms, thesis_vdw_parameters(), e.vdw_voxels) / (e.vdw / 4), 1,
              kTable44Tolerance);
}

INSTANTIATE_TEST_SUITE_P(Files, ThesisTables, ::testing::ValuesIn(kEntries));

std::vector<Vec3d> chain() { return {{0, 0, 0}, {1.2, 0.3, 0}, {2.1, 1.2, 0.4}, {3.3, 1.1, -0.5}}; }

TEST(ThesisMarchingCubes, BothVariantsMakeTheSameTriangles) {
  const auto p = thesis_parameters(ThesisFunction::soft_object);
  const ThesisGrid grid = thesis_grid(chain(), p);
  const auto field = thesis_field(chain(), grid, p);
  const auto run = [&](SharedVertices s) {
    return thesis_marching_cubes(chain(), field, grid, p, s);
  };
  const ThesisMesh soup = run(SharedVertices::recomputed), welded = run(SharedVertices::hash_table);
  ASSERT_EQ(soup.triangles.size(), welded.triangles.size());
  EXPECT_EQ(static_cast<std::int64_t>(soup.triangles.size()),
            count_triangles(field, grid, p.threshold));
  EXPECT_GT(soup.positions.size(), 3 * welded.positions.size());
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(soup.positions[soup.triangles[t][k]], welded.positions[welded.triangles[t][k]]);
      ASSERT_EQ(soup.normals[soup.triangles[t][k]], welded.normals[welded.triangles[t][k]]);
    }
  }
}

TEST(ThesisMarchingCubes, TheHashTableVariantIsClosed) {
  for (const auto f :
       {ThesisFunction::blinn, ThesisFunction::soft_object, ThesisFunction::inverse_squared}) {
    const auto p = thesis_parameters(f);
    const ThesisGrid grid = thesis_grid(chain(), p);
    const ThesisMesh mesh = thesis_marching_cubes(chain(), thesis_field(chain(), grid, p), grid, p,
                                                  SharedVertices::hash_table);
    reference::TriangleMesh plain;
    for (const Vec3f& q : mesh.positions) plain.points.push_back({q.x, q.y, q.z});
    plain.triangles = mesh.triangles;
    const reference::MeshFacts facts = inspect(plain);
    EXPECT_TRUE(facts.closed_oriented_manifold()) << facts.summary();
    EXPECT_GT(facts.volume, 0);
  }
}

}  // namespace
}  // namespace vdwmesh
