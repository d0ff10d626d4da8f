// The table of docs/refinement.md: what midpoint subdivision with projection onto the union cures.
//
//   refine_table [--spacing H] [--levels L] [--crossings allow|undo] EXACT.csv FILE.xyzr...
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "core/sum.hpp"
#include "extract/extractor.hpp"
#include "refine/refiner.hpp"
#include "refine/sphere_formulas.hpp"
#include "spheres/cell_list.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {
namespace {

struct Exact {
  double area = 0, volume = 0;
  long euler_characteristic = 0;
};

// set,balls,probe,area,volume,outer_area,b0,b1,b2,shells,chi
Exact read_exact(const std::string& csv, const std::string& set) {
  std::ifstream in(csv);
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> cells;
    std::stringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells.size() == 11 && cells[0] == set && std::stod(cells[2]) == 0) {
      return {std::stod(cells[3]), std::stod(cells[4]), std::stol(cells[10])};
    }
  }
  std::fprintf(stderr, "%s has no row for %s without a probe\n", csv.c_str(), set.c_str());
  std::exit(1);
}

struct Distance {
  double rms, max;
};

// |min(d - r)| at the centroids, weighted by area: the distance to the union's boundary outside it,
// a lower bound inside.
Distance centroid_distance(const CellList& list, const IndexedMesh& mesh) {
  WideSum squares, areas;
  double max = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const Vec3d centroid = (1.0 / 3) * ((a + b) + c);
    const double area = 0.5 * norm(cross(b - a, c - a));
    const double d = std::abs(nearest_ball(list.view(), centroid, 0.1, 10).gap);
    squares.add(area * d * d);
    areas.add(area);
    max = std::max(max, d);
  }
  return {std::sqrt(squares.value() / areas.value()), max};
}

void print_row(const std::string& set, int level, const CellList& list, const RefineResult& result,
               const Exact& exact) {
  const MeshSummary summary = summarize(result.mesh);
  const MeshQuality q = quality(result.mesh);
  const Distance distance = centroid_distance(list, result.mesh);
  const ProjectionStats& s = result.levels.back();
  std::printf(
      "| %s | %d | %zu | %+.2f | %+.3f | %+ld | %.2f / %.1f | %.4f | %.3f | %llu | %llu / %llu | "
      "%llu | %llu | %d | %.1e | %.2f |\n",
      set.c_str(), level, result.mesh.triangle_count(),
      100 * (summary.measures.area / exact.area - 1),
      100 * (summary.measures.volume.value() / exact.volume - 1),
      static_cast<long>(summary.topology.euler_characteristic) - exact.euler_characteristic,
      q.min_angle_deg.p01, q.min_angle_deg.median, distance.rms, distance.max,
      static_cast<unsigned long long>(self_intersections(result.mesh)),
      static_cast<unsigned long long>(s.unconverged),
      static_cast<unsigned long long>(s.out_of_reach), static_cast<unsigned long long>(s.undone),
      static_cast<unsigned long long>(s.turned), s.iterations_max, s.residual_max, result.seconds);
  std::fflush(stdout);
}

void run(const std::string& csv, const std::string& file, double spacing, int levels,
         Crossings crossings) {
  const std::string set = std::filesystem::path(file).stem().string();
  std::vector<Sphere> balls;
  for (const Atom& atom : read_structure(file).atoms) balls.push_back({atom.position, atom.radius});
  const SphereSet spheres(std::move(balls));
  const CellList list = make_ball_list(spheres);
  ExtractOptions extract;
  extract.grid.spacing = spacing;
  const ExtractResult extracted = make_cpu_extractor()->extract(spheres, extract);
  for (int level = 0; level <= levels; ++level) {
    RefineOptions options;
    options.crossings = crossings;
    options.subdivisions = level;
    options.grid = extracted.grid;
    const RefineResult result = make_cpu_refiner()->refine(spheres, extracted.mesh, options);
    print_row(set, level, list, result, read_exact(csv, set));
  }
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  double spacing = 0.5;
  int levels = 3, i = 1;
  vdwmesh::Crossings crossings = vdwmesh::Crossings::undo;
  for (; i + 1 < argc && argv[i][0] == '-'; i += 2) {
    if (std::string_view(argv[i]) == "--spacing") spacing = std::stod(argv[i + 1]);
    if (std::string_view(argv[i]) == "--levels") levels = std::stoi(argv[i + 1]);
    if (std::string_view(argv[i]) == "--crossings" && std::string_view(argv[i + 1]) == "allow") {
      crossings = vdwmesh::Crossings::allow;
    }
  }
  if (argc - i < 2) {
    std::fprintf(stderr,
                 "usage: refine_table [--spacing H] [--levels L] [--crossings allow|undo] "
                 "EXACT.csv FILE.xyzr...\n");
    return 1;
  }
  std::puts(
      "| set | level | triangles | area % | volume % | χ − exact | min angle p01 / median | "
      "centroid "
      "distance rms | max | self-intersections | unconverged / out of reach | undone | turned | "
      "steps | residual | s |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  for (const std::string csv = argv[i++]; i < argc; ++i) {
    vdwmesh::run(csv, argv[i], spacing, levels, crossings);
  }
}
