// Tables 4.1 and 4.2 of Dias's thesis, rerun: its two CPU programs (dense grid, one thread) beside
// ours with the preset `thesis`, on the same grids and fields.
//
//   thesis_tables [--repeat N] [--table-4-1 FILE.csv --table-4-2 FILE.csv] FILE.pdb|.cif...
//
// The CSV files hold the thesis's own columns (id, atoms, triangles and seconds per function); with
// them its seconds of 2009 (Q9550, 2.83 GHz) are printed too. Seconds are CPU seconds, the least of
// the repeats; ours runs on one thread.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "extract/extractor.hpp"
#include "reference/atoms.hpp"
#include "reference/thesis_mc.hpp"

namespace vdwmesh {
namespace {

using reference::SharedVertices;
using reference::ThesisFunction;

struct Function {
  const char* name;
  ThesisFunction theirs;
  FieldKind ours;
};
constexpr std::array kFunctions{
    Function{"Blinn", ThesisFunction::blinn, FieldKind::blinn},
    Function{"soft object", ThesisFunction::soft_object, FieldKind::soft_object},
    Function{"inverse sq.", ThesisFunction::inverse_squared, FieldKind::inverse_squared}};

using Cells = std::vector<std::string>;
using Table = std::map<std::string, Cells>;  // by entry id

Table read_table(const std::string& path) {
  Table table;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    Cells cells;
    std::istringstream words(line);
    for (std::string cell; std::getline(words, cell, ',');) cells.push_back(cell);
    if (!cells.empty()) table[cells[0]] = cells;
  }
  return table;
}

// Column `offset` (0: triangles, 1: seconds) of a function.
std::string printed(const Table& table, const std::string& id, std::size_t function,
                    std::size_t offset) {
  const auto row = table.find(id);
  const std::size_t column = 2 + 2 * function + offset;
  if (row == table.end() || row->second.size() <= column) return "-";
  return row->second[column];
}

struct Options {
  std::vector<std::string> files;
  Table table_4_1, table_4_2;
  int repeat = 3;
};

template <class Work>
double least_seconds(int repeat, Work&& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repeat; ++i) {
    const std::clock_t start = std::clock();
    work();
    least = std::min(least, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return least;
}

struct Timed {
  double seconds;
  std::size_t triangles;
};

Timed run_thesis(const std::vector<reference::Point>& atoms, ThesisFunction function,
                 SharedVertices shared, int repeat) {
  const auto parameters = reference::thesis_parameters(function);
  Timed timed{};
  timed.seconds = least_seconds(repeat, [&] {
    const auto grid = reference::thesis_grid(atoms, parameters);
    const auto field = reference::thesis_field(atoms, grid, parameters);
    timed.triangles =
        reference::thesis_marching_cubes(atoms, field, grid, parameters, shared).triangles.size();
  });
  return timed;
}

Timed run_ours(const std::vector<reference::Point>& atoms, FieldKind kind, int repeat) {
  std::vector<Sphere> spheres;
  for (const auto& p : atoms) spheres.push_back({{p[0], p[1], p[2]}, 1.7});  // radii play no part
  const SphereSet set(std::move(spheres));
  ExtractOptions options;
  options.field.kind = kind;
  options.field.preset = FieldPreset::thesis;
  options.grid = preset_grid(FieldPreset::thesis, {}, {});
  const auto extractor = make_cpu_extractor();
  Timed timed{};
  timed.seconds = least_seconds(
      repeat, [&] { timed.triangles = extractor->extract(set, options).mesh.triangle_count(); });
  return timed;
}

void print_header() {
  fmt::print("{:<6} {:>5} {:<12} | {:>17} | {:>8} {:>8} | {:>9} {:>9} {:>9} | {:>7} {:>7}\n", "",
             "", "", "triangles", "thesis", "2009, s", "thesis", "its code", "ours", "", "");
  fmt::print("{:<6} {:>5} {:<12} | {:>8} {:>8} | {:>8} {:>8} | {:>9} {:>9} {:>9} | {:>7} {:>7}\n",
             "id", "atoms", "function", "thesis", "ours", "T. 4.1", "T. 4.2", "4.1, s", "4.2, s",
             "1 core, s", "4.1/our", "4.2/our");
}

void run_file(const std::string& file, const Options& options) {
  const auto atoms = reference::read_atom_records(file);
  const std::string id = std::filesystem::path(file).stem().string();
  for (std::size_t f = 0; f < kFunctions.size(); ++f) {
    const Function& function = kFunctions[f];
    const Timed soup =
        run_thesis(atoms, function.theirs, SharedVertices::recomputed, options.repeat);
    const Timed hashed =
        run_thesis(atoms, function.theirs, SharedVertices::hash_table, options.repeat);
    const Timed ours = run_ours(atoms, function.ours, options.repeat);
    fmt::print(
        "{:<6} {:>5} {:<12} | {:>8} {:>8} | {:>8} {:>8} | {:>9.3f} {:>9.3f} {:>9.4f} | {:>7.1f} "
        "{:>7.1f}\n",
        id, atoms.size(), function.name, printed(options.table_4_2, id, f, 0), ours.triangles,
        printed(options.table_4_1, id, f, 1), printed(options.table_4_2, id, f, 1), soup.seconds,
        hashed.seconds, ours.seconds, soup.seconds / ours.seconds, hashed.seconds / ours.seconds);
    std::fflush(stdout);
  }
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::string value = i + 1 < argc ? argv[i + 1] : "";
    if (argument == "--repeat") {
      options.repeat = std::max(1, std::stoi(value));
    } else if (argument == "--table-4-1") {
      options.table_4_1 = read_table(value);
    } else if (argument == "--table-4-2") {
      options.table_4_2 = read_table(value);
    } else {
      options.files.push_back(argument);
      continue;
    }
    ++i;
  }
  return options;
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  const vdwmesh::Options options = vdwmesh::parse(argc, argv);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  vdwmesh::print_header();
  for (const std::string& file : options.files) vdwmesh::run_file(file, options);
  return options.files.empty() ? 1 : 0;
}
