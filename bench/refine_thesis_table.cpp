// Table 4.4 of Dias's thesis, rerun: triangles and seconds of the van der Waals stage with one and
// two subdivisions, preset `thesis-vdw`, inverse squared field.
//
//   refine_thesis_table TABLE_4_4.csv FILE.pdb|.cif...
//
// The CSV holds the thesis's columns: id, atoms, triangles and seconds after one and after two
// subdivisions, voxels. Ours are CPU seconds of extraction and refinement on one thread.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "extract/extractor.hpp"
#include "reference/atoms.hpp"
#include "refine/refiner.hpp"

namespace vdwmesh {
namespace {

using Cells = std::vector<std::string>;

std::map<std::string, Cells> read_table(const std::string& path) {
  std::map<std::string, Cells> table;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    Cells cells;
    std::istringstream words(line);
    for (std::string cell; std::getline(words, cell, ',');) cells.push_back(cell);
    if (cells.size() == 7) table[cells[0]] = cells;
  }
  return table;
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void run(const std::string& file, const std::map<std::string, Cells>& table) {
  const std::string id = std::filesystem::path(file).stem().string();
  std::vector<Sphere> balls;
  for (const auto& p : reference::read_atom_records(file)) {
    balls.push_back({{p[0], p[1], p[2]}, 1.7});  // the preset uses no radius
  }
  const SphereSet spheres(std::move(balls));
  for (int level = 1; level <= 2; ++level) {
    const double begin = cpu_seconds();
    ExtractOptions extract;
    extract.field = {FieldKind::inverse_squared, FieldPreset::thesis_vdw, {}, {}};
    extract.grid = preset_grid(FieldPreset::thesis_vdw, {}, {});
    const ExtractResult extracted = make_cpu_extractor()->extract(spheres, extract);
    RefineOptions options;
    options.subdivisions = level;
    options.projection = Projection::field;
    options.field = extract.field;
    options.grid = extracted.grid;
    const RefineResult result = make_cpu_refiner()->refine(spheres, extracted.mesh, options);
    const double seconds = cpu_seconds() - begin;
    const double printed = std::stod(table.at(id)[level == 1 ? 2 : 4]);
    const ProjectionStats& s = result.levels.back();
    fmt::print("| {} | {} | {} | {} | {:.0f} | {:.3f} | {} | {:.3f} | {} | {} | {} |\n", id, level,
               extracted.grid.cell_count(), result.mesh.triangle_count(), printed,
               static_cast<double>(result.mesh.triangle_count()) / printed,
               table.at(id)[level == 1 ? 3 : 5], seconds, s.unconverged, s.out_of_reach, s.undone);
  }
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: refine_thesis_table TABLE_4_4.csv FILE.pdb|.cif...\n");
    return 1;
  }
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const auto table = vdwmesh::read_table(argv[1]);
  fmt::print(
      "| entry | level | voxels | triangles | thesis | ratio | thesis's seconds | ours | "
      "unconverged | out of reach | undone |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (int i = 2; i < argc; ++i) vdwmesh::run(argv[i], table);
}
