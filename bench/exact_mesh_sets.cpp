// Crease-exact meshes of seeded sets of balls against the exact union: the table of
// docs/exact_mesh.md.
//
//   exact_mesh_sets COUNT SEED [--first N] [--verbose]
//
// Makes the sets SEED + N to SEED + N + COUNT - 1 of tests/support/sphere_recipes, so that several
// processes can share the work. CSV on standard output, one row for each recipe; each set that is
// refused or differs is named on standard error, with --verbose every set before it is meshed.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "creases/exact_mesher.hpp"
#include "support/sphere_recipes.hpp"
#include "support/union_verdict.hpp"

namespace vdwmesh {
namespace {

struct Row {
  std::uint64_t sets = 0, triangles = 0, meshed = 0, refused = 0, failed = 0, unsound = 0;
  std::uint64_t reduced = 0;  // meshes with features that were reduced to points
  std::uint64_t silent = 0;   // another topology than the mesher announced
  std::uint64_t euler_characteristic = 0, components = 0, voids = 0;  // meshes that differ in it
  double area = 0, volume = 0, off_sphere = 0, depth = 0;             // the largest
  double seconds = 0, slowest = 0;
};

void keep_largest(double& largest, double value) {
  if (!(value <= largest)) largest = value;
}

void look(unsigned seed, const testing::SeededSet& set, const ExactMesh& made, Row& row) {
  const testing::CreaseSurvey survey = testing::survey_creases(set.spheres, made.mesh);
  const ExactUnion exact = exact_union(set.spheres);
  const testing::TopologyDifference topology =
      testing::topology_difference(set.spheres, survey.facts, *exact.topology);
  const testing::MeasureDifference measures =
      testing::measure_difference(set.spheres, made.mesh, survey.facts, exact);
  ++row.meshed;
  row.triangles += made.mesh.triangle_count();
  row.unsound += !survey.sound();
  row.euler_characteristic += topology.euler_characteristic != 0;
  row.components += topology.components != 0;
  row.voids += topology.voids != 0;
  const std::uint64_t reduced = made.stats.points + made.stats.contacts + made.stats.joins;
  row.reduced += reduced > 0;
  row.silent += topology.euler_characteristic != made.stats.euler_difference ||
                topology.components + topology.voids != made.stats.shell_difference;
  keep_largest(row.area, measures.area);
  keep_largest(row.volume, measures.volume);
  keep_largest(row.off_sphere, survey.off_sphere);
  keep_largest(row.depth, survey.depth);
  if (survey.sound() && topology.none() && measures.area < 1e-6) return;
  std::fprintf(stderr, "%u %s: chi %+ld, components %+ld, voids %+ld; area %.1e, volume %.1e; %s\n",
               seed, std::string(testing::sphere_recipes()[set.recipe].name).c_str(),
               static_cast<long>(topology.euler_characteristic),
               static_cast<long>(topology.components), static_cast<long>(topology.voids),
               measures.area, measures.volume, survey.text().c_str());
}

void mesh_set(unsigned seed, std::vector<Row>& rows) {
  const testing::SeededSet set = testing::seeded_set(seed);
  Row& row = rows[set.recipe];
  ++row.sets;
  const auto begin = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  try {
    ExactMeshOptions options;
    options.edge_length = set.edge_length;
    const ExactMesh made = mesh_union(set.spheres, options);
    const double seconds = elapsed();
    row.seconds += seconds;
    keep_largest(row.slowest, seconds);
    if (seconds > 5) std::fprintf(stderr, "%u: %.1f s\n", seed, seconds);
    look(seed, set, made, row);
    return;
  } catch (const LimitExceeded& error) {
    ++row.refused;
    std::fprintf(stderr, "%u refused after %.1f s: %s\n", seed, elapsed(), error.what());
  } catch (const std::exception& error) {
    ++row.failed;
    std::fprintf(stderr, "%u failed after %.1f s: %s\n", seed, elapsed(), error.what());
  }
  row.seconds += elapsed();
  keep_largest(row.slowest, elapsed());
}

void print(const std::vector<Row>& rows) {
  std::puts(
      "recipe,sets,meshed,refused,failed,triangles,unsound,reduced,chi_differs,components_differ,"
      "voids_differ,differs_unannounced,area,volume,off_sphere,depth,seconds,slowest");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& r = rows[i];
    const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
    std::printf(
        "\"%s\",%llu,%llu,%llu,%llu,%llu,%llu,%llu,%llu,%llu,%llu,%llu,%.1e,%.1e,%.1e,%.1e,%.2f,%."
        "2f\n",
        std::string(testing::sphere_recipes()[i].name).c_str(), number(r.sets), number(r.meshed),
        number(r.refused), number(r.failed), number(r.triangles), number(r.unsound),
        number(r.reduced), number(r.euler_characteristic), number(r.components), number(r.voids),
        number(r.silent), r.area, r.volume, r.off_sphere, r.depth, r.seconds, r.slowest);
  }
}

int run(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("usage: exact_mesh_sets COUNT SEED [--first N] [--verbose]\n", stderr);
    return 1;
  }
  const auto count = static_cast<unsigned>(std::stoul(argv[1]));
  unsigned seed = static_cast<unsigned>(std::stoul(argv[2]));
  bool verbose = false;
  for (int i = 3; i < argc; ++i) {
    const std::string_view option = argv[i];
    if (option == "--first" && i + 1 < argc) {
      seed += static_cast<unsigned>(std::stoul(argv[++i]));
    } else if (option == "--verbose") {
      verbose = true;
    } else {
      std::fprintf(stderr, "exact_mesh_sets: %s is not an option\n", argv[i]);
      return 1;
    }
  }
  std::vector<Row> rows(testing::sphere_recipes().size());
  for (unsigned i = 0; i < count; ++i) {
    if (verbose) std::fprintf(stderr, "%u\n", seed + i);
    mesh_set(seed + i, rows);
  }
  print(rows);
  return 0;
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  try {
    return vdwmesh::run(argc, argv);
  } catch (const std::exception&) {
    std::fputs("exact_mesh_sets: COUNT, SEED and N are whole numbers\n", stderr);
    return 1;
  }
}
