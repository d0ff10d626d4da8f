// Ubiquitin against its exact area and volume; the thesis's tables.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "contract/extractor_contract.hpp"
#include "reference/atoms.hpp"
#include "support/shared_files.hpp"

namespace vdwmesh::testing {
namespace {

class ExtractorMolecule : public ExtractorContract {};

SphereSet read_spheres(const std::string& shared_file) {
  std::vector<Sphere> spheres;
  for (const reference::Ball& b : reference::read_xyzr(shared_path(shared_file))) {
    spheres.push_back({{b.center[0], b.center[1], b.center[2]}, b.radius});
  }
  return SphereSet(std::move(spheres));
}

// Union of the Bondi spheres of 1UBQ without waters, by two exact methods that agree to 1e-13.
constexpr double kUbiquitinArea = 7915.58241751;    // Å²
constexpr double kUbiquitinVolume = 6558.60702915;  // Å³

// Creases cut off cost area of order h, so errors halve; volume of order h², so errors quarter.
TEST_P(ExtractorMolecule, UbiquitinConverges) {
  VDWMESH_NEEDS_SHARED("reference/1UBQ.xyzr");
  const SphereSet spheres = read_spheres("reference/1UBQ.xyzr");
  double last_area = 0, last_volume = 0;
  for (const double h : {0.5, 0.25, 0.125}) {
    ExtractOptions options;
    options.grid.spacing = h;
    const ExtractResult result = extract(spheres, options);
    expect_sound(result, "ubiquitin at " + std::to_string(h));
    const reference::MeshFacts facts = facts_of(result);
    const double area = facts.area / kUbiquitinArea - 1;
    const double volume = facts.volume / kUbiquitinVolume - 1;
    if (h == 0.5) {
      EXPECT_GT(area, -0.06);
      EXPECT_LT(area, -0.04);
      EXPECT_GT(volume, -0.01);
      EXPECT_LT(volume, 0);
    } else {
      EXPECT_GE(last_area / area, 1.7) << h;
      EXPECT_LE(last_area / area, 2.2) << h;
      EXPECT_GE(last_volume / volume, 3.0) << h;
      EXPECT_LE(last_volume / volume, 4.3) << h;
    }
    last_area = area;
    last_volume = volume;
  }
}

TEST_P(ExtractorMolecule, UbiquitinsVerticesLieOnTheBoundary) {
  VDWMESH_NEEDS_SHARED("reference/1UBQ.xyzr");
  const SphereSet spheres = read_spheres("reference/1UBQ.xyzr");
  const ExtractResult result = extract(spheres, {});
  const auto balls = to_balls(spheres);
  std::size_t off = 0;
  for (const Vec3d& p : result.mesh.positions) {
    const double away = std::abs(reference::sample_union(balls, to_point(p)).signed_distance);
    if (!(away <= 1e-9)) ++off;
    ASSERT_LE(away, 1e-6);
  }
  EXPECT_LE(off, result.stats.clamped_vertices);
}

struct ExactUnion {
  std::string set;
  double area, volume;  // Å², Å³
};

// As many sets have their spheres in a file of their own that is not packed.
constexpr int kReferenceSets = 24;

// Probe 0 of union_of_balls.csv: set, balls, probe, area, volume ...
std::vector<ExactUnion> exact_unions() {
  std::vector<ExactUnion> rows;
  std::ifstream in(shared_path("reference/union_of_balls.csv"));
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> cells;
    std::istringstream words(line);
    for (std::string cell; std::getline(words, cell, ',');) cells.push_back(cell);
    if (cells.size() < 5 || cells[2] != "0") continue;
    rows.push_back({cells[0], std::stod(cells[3]), std::stod(cells[4])});
  }
  return rows;
}

// Every set of balls whose exact union is known, at 0.5 Å. Creases cut off cost some per cent of
// the area; of the volume a mesh inscribed in balls of radius r loses at most about h² / (2 r²).
TEST_P(ExtractorMolecule, EveryReferenceSetIsSoundAndNearItsExactUnion) {
  VDWMESH_NEEDS_SHARED("reference/union_of_balls.csv");
  int compared = 0;
  for (const ExactUnion& exact : exact_unions()) {
    const std::string file = "reference/" + exact.set + ".xyzr";
    if (!std::filesystem::exists(shared_path(file))) continue;  // large sets are gzipped
    ++compared;
    const SphereSet spheres = read_spheres(file);
    const ExtractResult result = extract(spheres, {});
    expect_sound(result, exact.set);
    double least = std::numeric_limits<double>::infinity();  // Å
    for (const Sphere& s : spheres.spheres()) least = std::min(least, s.radius);
    const reference::MeshFacts facts = facts_of(result);
    EXPECT_LT(facts.area, exact.area) << exact.set;
    EXPECT_GT(facts.area, 0.9 * exact.area) << exact.set;
    EXPECT_NEAR(facts.volume / exact.volume, 1, 0.5 * 0.5 / (2 * least * least)) << exact.set;
  }
  EXPECT_GE(compared, kReferenceSets) << "a table that is cut, or read wrongly";
}

// As printed in Tables 4.1, 4.2 and 4.4 (after one subdivision).
struct Row {
  const char* file;
  std::uint64_t voxels, vdw_voxels;
  double blinn, soft, inverse_squared, vdw;
};
constexpr Row kRows[] = {
    {"110D.pdb", 346580, 132526, 14632, 12584, 12852, 33056},
    {"4PTI.pdb", 1043464, 558888, 60910, 48616, 49036, 117792},
    {"1BK2.pdb", 650160, 309205, 63442, 50514, 48960, 120432},
    {"1HH0.cif", 1632000, 914085, 64816, 66268, 51252, 205344},
    {"1QL2.cif", 4619920, 3187548, 129630, 102288, 111920, 246320},
    {"1IZH.pdb", 2578680, 1639890, 204436, 162554, 176716, 391168},
};
constexpr double kTable42Tolerance = 0.03, kTable44Tolerance = 0.04;  // of the triangle count

TEST_P(ExtractorMolecule, ThesisPresetsGiveTheThesissCounts) {
  for (const Row& row : kRows) {
    const std::string file = std::string("molecules/thesis/") + row.file;
    VDWMESH_NEEDS_SHARED(file);
    std::vector<Sphere> spheres;
    for (const auto& p : reference::read_atom_records(shared_path(file))) {
      spheres.push_back({{p[0], p[1], p[2]}, 1.7});  // the presets use no radius
    }
    const SphereSet set(std::move(spheres));
    const auto run = [&](FieldKind kind, FieldPreset preset, std::uint64_t voxels) {
      ExtractOptions options;
      options.field = {kind, preset, {}, {}};
      options.grid = preset_grid(preset, {}, {});
      const ExtractResult result = extract(set, options);
      expect_sound(result, std::string(row.file) + ": " + field_name(kind));
      EXPECT_EQ(result.grid.cell_count(), voxels) << row.file;
      return static_cast<double>(result.mesh.triangle_count());
    };
    const auto table_4_2 = [&](FieldKind k) { return run(k, FieldPreset::thesis, row.voxels); };
    EXPECT_NEAR(table_4_2(FieldKind::blinn) / row.blinn, 1, kTable42Tolerance) << row.file;
    EXPECT_NEAR(table_4_2(FieldKind::soft_object) / row.soft, 1, kTable42Tolerance) << row.file;
    EXPECT_NEAR(table_4_2(FieldKind::inverse_squared) / row.inverse_squared, 1, kTable42Tolerance)
        << row.file;
    EXPECT_NEAR(
        run(FieldKind::inverse_squared, FieldPreset::thesis_vdw, row.vdw_voxels) / (row.vdw / 4), 1,
        kTable44Tolerance)
        << row.file;
  }
}

VDWMESH_INSTANTIATE_BACKENDS(ExtractorMolecule);

}  // namespace
}  // namespace vdwmesh::testing
