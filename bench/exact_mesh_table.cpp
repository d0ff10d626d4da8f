// The tables of docs/exact_mesh.md: crease-exact meshes of the reference sets, checked.
//
//   exact_mesh_table topology [--search N] [--most N] EXACT.csv FILE.xyzr...
//   exact_mesh_table angles   EXACT.csv FILE.xyzr...
//   exact_mesh_table min-angle [--min-angle DEG] [--edge-length H] EXACT.csv FILE.xyzr...
//   exact_mesh_table accuracy [--edge-length H] EXACT.csv FILE.xyzr...
//
// CSV on standard output. --search: self-intersections of meshes up to N triangles; --most: no
// levels beyond N triangles. The edge length is 0.2 Å unless given.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "creases/exact_mesher.hpp"
#include "measures/exact_union.hpp"
#include "refine/refiner.hpp"
#include "structure/reader.hpp"
#include "support/crease_survey.hpp"
#include "support/sharp_corners.hpp"

namespace vdwmesh {
namespace {

struct Row {
  std::string set;
  double probe = 0, area = 0, volume = 0;
  std::uint64_t components = 0, voids = 0;
  long euler_characteristic = 0;
};

// set,balls,probe,area,volume,outer_area,b0,b1,b2,shells,chi
std::vector<Row> read_rows(const std::string& csv, const std::string& set) {
  std::ifstream in(csv);
  std::vector<Row> rows;
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> cells;
    std::stringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells.size() != 11 || cells[0] != set) continue;
    rows.push_back({set, std::stod(cells[2]), std::stod(cells[3]), std::stod(cells[4]),
                    std::stoull(cells[6]), std::stoull(cells[8]), std::stol(cells[10])});
  }
  return rows;
}

SphereSet read_balls(const std::string& file, double probe) {
  std::vector<Sphere> balls;
  for (const Atom& atom : read_structure(file).atoms) {
    balls.push_back({atom.position, atom.radius + probe});
  }
  return SphereSet(std::move(balls));
}

struct Limits {
  std::uint64_t search = 5'000'000, most = 25'000'000;
  double edge_length = 0.2;  // Å, of the tables of accuracy and of bounded angles
  double min_angle = 20;     // degrees
};

IndexedMesh mesh_at(const SphereSet& spheres, double edge_length) {
  ExactMeshOptions options;
  options.edge_length = edge_length;
  return mesh_union(spheres, options).mesh;
}

RefineResult finer(const SphereSet& spheres, const IndexedMesh& mesh) {
  RefineOptions options;
  options.subdivisions = 1;
  return make_cpu_refiner()->refine(spheres, mesh, options);
}

void print_topology(const Row& row, const SphereSet& spheres, double edge_length, int level,
                    const IndexedMesh& mesh, std::uint64_t turned, const Limits& limits) {
  const testing::CreaseSurvey s = testing::survey_creases(spheres, mesh);
  const reference::MeshFacts& f = s.facts;
  const std::string crossings =
      f.triangles <= limits.search ? std::to_string(self_intersections(mesh)) : "";
  std::printf("%s,%g,%g,%d,%zu,%d,%ld,%ld,%ld,%s,%zu,%llu,%llu,%llu,%.1e,%.1e\n", row.set.c_str(),
              row.probe, edge_length, level, f.triangles, f.closed_oriented_manifold() ? 1 : 0,
              static_cast<long>(f.euler_characteristic()) - row.euler_characteristic,
              static_cast<long>(f.positive_shells) - static_cast<long>(row.components),
              static_cast<long>(f.negative_shells) - static_cast<long>(row.voids),
              crossings.c_str(), f.degenerate_triangles, static_cast<unsigned long long>(s.inward),
              static_cast<unsigned long long>(turned),
              static_cast<unsigned long long>(s.bad_labels + s.strange_labels + s.bad_arc_edges),
              s.off_sphere, s.depth);
  std::fflush(stdout);
}

void topology_rows(const Row& row, const std::string& file, const Limits& limits) {
  const SphereSet spheres = read_balls(file, row.probe);
  for (const double h : {0.5, 0.35, 0.25}) {
    IndexedMesh mesh = mesh_at(spheres, h);
    print_topology(row, spheres, h, 0, mesh, 0, limits);
    for (int level = 1; level <= 2 && 4 * mesh.triangle_count() <= limits.most; ++level) {
      RefineResult next = finer(spheres, mesh);
      mesh = std::move(next.mesh);
      print_topology(row, spheres, h, level, mesh, next.levels.back().turned, limits);
    }
  }
}

void angle_rows(const Row& row, const std::string& file, const Limits&) {
  const SphereSet spheres = read_balls(file, row.probe);
  for (const double h : {0.5, 0.35, 0.25}) {
    const IndexedMesh mesh = mesh_at(spheres, h);
    const testing::AngleCensus c = testing::angle_census(spheres, mesh);
    std::printf("%s,%g,%g,%zu,%.2f,%.5f,%.4f,%llu,%llu,%.3f,%.5f\n", row.set.c_str(), row.probe, h,
                mesh.triangle_count(), c.median, c.smallest, 100 * c.below_15,
                static_cast<unsigned long long>(c.below_5_degrees),
                static_cast<unsigned long long>(c.unexplained), c.worst, c.sharpest_corner);
    std::fflush(stdout);
  }
}

// Meshes without and with a bound on the angles. "Below" counts triangles by their definition in
// tests/support/sharp_corners.hpp, "told" by what the mesher says of itself.
void min_angle_rows(const Row& row, const std::string& file, const Limits& limits) {
  const SphereSet spheres = read_balls(file, row.probe);
  ExactMeshOptions options;
  options.edge_length = limits.edge_length;
  const ExactMesh plain = mesh_union(spheres, options);
  options.min_angle = limits.min_angle;
  const ExactMesh bounded = mesh_union(spheres, options);
  const testing::BoundedAngles before =
      testing::bounded_angles(spheres, plain.mesh, limits.min_angle);
  const testing::BoundedAngles after =
      testing::bounded_angles(spheres, bounded.mesh, limits.min_angle);
  const testing::AngleCensus census = testing::angle_census(spheres, bounded.mesh);
  const testing::CreaseSurvey s = testing::survey_creases(spheres, bounded.mesh);
  const auto count = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  std::printf(
      "%s,%g,%g,%zu,%zu,%.1f,%llu,%llu,%.2f,%llu,%llu,%llu,%llu,%.2f,%.2f,%llu,%.1f,%d,%ld\n",
      row.set.c_str(), row.probe, limits.edge_length, plain.mesh.triangle_count(),
      bounded.mesh.triangle_count(),
      100.0 * static_cast<double>(bounded.mesh.triangle_count()) /
              static_cast<double>(plain.mesh.triangle_count()) -
          100,
      count(before.below), count(before.below_excused), after.smallest, count(after.below),
      count(after.below_excused), count(bounded.stats.below_min_angle),
      count(bounded.stats.below_min_angle_at_corners), census.median, census.smallest,
      count(census.unexplained), bounded.stats.seconds / plain.stats.seconds, s.sound() ? 1 : 0,
      static_cast<long>(s.facts.euler_characteristic()) - row.euler_characteristic);
  std::fflush(stdout);
}

// The largest relative error of the area of an atom with more than 1 Å² exposed.
double worst_atom(const SphereSet& spheres, const IndexedMesh& mesh) {
  const ExactUnion exact = exact_union(spheres);
  const std::vector<double> found = mesh_area_by_sphere(mesh, spheres.size());
  double worst = 0;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const double area = exact.per_sphere[i].area;
    if (area > 1) worst = std::max(worst, std::abs(found[i] / area - 1));
  }
  return worst;
}

void accuracy_rows(const Row& row, const std::string& file, const Limits& limits) {
  const SphereSet spheres = read_balls(file, row.probe);
  IndexedMesh mesh = mesh_at(spheres, limits.edge_length);
  MeshMeasures before{};
  for (int level = 0; level <= 3; ++level) {
    const MeshMeasures m = measures(mesh);
    const double area = m.area / row.area - 1, volume = *m.volume / row.volume - 1;
    std::printf("%s,%g,%g,%d,%zu,%.1f,%.4f,%.4f,", row.set.c_str(), row.probe, limits.edge_length,
                level, mesh.triangle_count(), static_cast<double>(mesh.triangle_count()) / row.area,
                100 * area, 100 * volume);
    if (level == 0) {
      std::printf(",,,,%.3f\n", 100 * worst_atom(spheres, mesh));
    } else {
      std::printf("%.3f,%.3f,%.1e,%.1e,\n", (before.area / row.area - 1) / area,
                  (*before.volume / row.volume - 1) / volume,
                  extrapolate_second_order(before.area, m.area) / row.area - 1,
                  extrapolate_second_order(*before.volume, *m.volume) / row.volume - 1);
    }
    std::fflush(stdout);
    if (4 * mesh.triangle_count() > limits.most) return;
    before = m;
    if (level < 3) mesh = finer(spheres, mesh).mesh;
  }
}

struct Table {
  std::string_view name, header;
  std::function<void(const Row&, const std::string&, const Limits&)> print;
};

const std::vector<Table>& tables() {
  static const std::vector<Table> all = {
      {"topology",
       "set,probe,edge_length,level,triangles,sound,chi_difference,component_difference,"
       "void_difference,self_intersections,degenerate,inward,turned,bad_labels,off_sphere,depth",
       topology_rows},
      {"angles",
       "set,probe,edge_length,triangles,median,smallest,percent_below_15,angles_below_5,"
       "unexplained,worst_ratio,sharpest_corner",
       angle_rows},
      {"min-angle",
       "set,probe,edge_length,triangles,triangles_bounded,percent_more,below_before,"
       "excused_before,smallest,below,excused,told,told_excused,median,smallest_of_all,"
       "below_floor,times_as_long,sound,chi_difference",
       min_angle_rows},
      {"accuracy",
       "set,probe,edge_length,level,triangles,per_A2,area_percent,volume_percent,area_ratio,"
       "volume_ratio,extrapolated_area,extrapolated_volume,worst_atom_percent",
       accuracy_rows}};
  return all;
}

int run(int argc, char** argv) {
  Limits limits;
  const auto table = std::find_if(tables().begin(), tables().end(), [&](const Table& t) {
    return argc > 1 && t.name == std::string_view(argv[1]);
  });
  int i = 2;
  for (; i + 1 < argc && argv[i][0] == '-'; i += 2) {
    const std::string_view option = argv[i];
    if (option == "--search") limits.search = std::stoull(argv[i + 1]);
    if (option == "--most") limits.most = std::stoull(argv[i + 1]);
    if (option == "--edge-length") limits.edge_length = std::stod(argv[i + 1]);
    if (option == "--min-angle") limits.min_angle = std::stod(argv[i + 1]);
  }
  if (table == tables().end() || argc - i < 2) {
    std::fputs(
        "usage: exact_mesh_table topology|angles|min-angle|accuracy [options] EXACT.csv "
        "FILE.xyzr...\n",
        stderr);
    return 1;
  }
  std::printf("%s\n", std::string(table->header).c_str());
  for (const std::string csv = argv[i++]; i < argc; ++i) {
    const std::string set = std::filesystem::path(argv[i]).stem().stem().string();
    for (const Row& row : read_rows(csv, set)) table->print(row, argv[i], limits);
  }
  return 0;
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) { return vdwmesh::run(argc, argv); }
