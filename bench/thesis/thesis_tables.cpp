// Reads the tables as printed in the thesis, which the program carries as CSV, and finds the
// structure files of their entries. Entries that the archive no longer has are stood in for by the
// structures that come closest, and are reported as such.
#include "thesis/thesis_tables.hpp"

#include <fmt/format.h>

#include <sstream>
#include <utility>

#include "core/errors.hpp"
#include "request/refuse.hpp"

namespace vdwmesh::apps {

// The CSV of a table, which the program carries: EmbedAssets.cmake.
std::string_view thesis_asset(std::string_view name);

namespace {

namespace fs = std::filesystem;

// Entries that are withdrawn or too old for the archive's files, and what comes closest to them.
constexpr std::pair<std::string_view, std::string_view> kStandIns[] = {{"1QL1", "1QL2_chainA"},
                                                                       {"2INS", "4INS"},
                                                                       {"1BIJ", "4HHB"},
                                                                       {"1GT0", "1F4K"},
                                                                       {"200D", "133D"}};

// id,atoms,(triangles,seconds) per column,voxels
ThesisEntry parse_entry(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream row(line);
  for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
  ThesisEntry entry{cells.at(0), std::stoull(cells.at(1)), std::stoull(cells.back()), {}};
  for (std::size_t i = 2; i + 2 < cells.size(); i += 2) {
    entry.figures.push_back({std::stoull(cells[i]), std::stod(cells[i + 1])});
  }
  return entry;
}

std::optional<fs::path> find_file(const fs::path& folder, std::string_view id) {
  for (const char* extension : {".pdb", ".cif", ".ent", ".mmcif", ".pdb.gz", ".cif.gz"}) {
    fs::path path = folder / (std::string(id) + extension);
    if (fs::is_regular_file(path)) return path;
  }
  return std::nullopt;
}

}  // namespace

bool is_vdw_table(std::string_view table) { return table == "4.4" || table == "4.5"; }
bool is_gpu_table(std::string_view table) { return table == "4.3" || table == "4.5"; }

ThesisTable thesis_table(std::string_view name) {
  ThesisTable table{std::string(name), {}};
  std::istringstream lines{std::string(thesis_asset(table.name))};
  std::string line;
  std::getline(lines, line);  // the names of the columns
  while (std::getline(lines, line)) table.entries.push_back(parse_entry(line));
  return table;
}

// The entry itself comes before whatever stands in for it.
std::optional<ThesisStructure> find_structure(const fs::path& folder, const std::string& entry) {
  refuse_if(!fs::is_directory(folder), "--structures {}: there is no such folder", folder.string());
  if (const auto path = find_file(folder, entry)) {
    return ThesisStructure{entry, ThesisStructure::Kind::original, *path};
  }
  for (const auto& [original, stand_in] : kStandIns) {
    if (original != entry) continue;
    if (const auto path = find_file(folder, stand_in)) {
      return ThesisStructure{std::string(stand_in), ThesisStructure::Kind::stand_in, *path};
    }
  }
  return std::nullopt;
}

}  // namespace vdwmesh::apps
