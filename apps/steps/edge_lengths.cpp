// Edge lengths atom by atom: first what holds for all, then groups, then the table.
#include "steps/edge_lengths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "command_line/parse.hpp"
#include "report/csv.hpp"
#include "request/refuse.hpp"

namespace vdwmesh::apps {
namespace {

// The column `serial` is looked at too where the table has it, as that of --per-atom does: a table
// of other atoms would be read without a word if there are as many of them.
void read_table(const std::string& path, const Molecule& molecule, std::vector<double>& lengths) {
  const CsvFile file(path);
  const std::vector<std::string> column = file.column("edge_length");
  refuse_if(column.size() != lengths.size(), "{}: has {} rows for {} atoms", path, column.size(),
            lengths.size());
  const bool has_serials = file.has_column("serial");
  const std::vector<std::string> serials =
      has_serials ? file.column("serial") : std::vector<std::string>();
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const std::string serial = std::to_string(molecule.atoms[i].serial);
    refuse_if(has_serials && serials[i] != serial,
              "{}: row {} is of the atom with serial {}, but atom {} in use has {}", path, i + 1,
              serials[i], i + 1, serial);
    if (column[i].empty()) continue;
    const std::string place = fmt::format("{}: edge_length of row {}", path, i + 1);
    lengths[i] = parse_number(place, column[i], Range::positive, "0.35");
  }
}

}  // namespace

std::vector<double> edge_lengths_of(const SurfaceOptions& surface, const Molecule& molecule,
                                    const SphereSet& spheres) {
  const EdgeGrading& grading = surface.grading;
  std::vector<double> lengths;
  if (surface.mesher != Mesher::exact || grading.is_uniform()) return lengths;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const double share = grading.relative.value_or(kNone);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const std::int32_t group = molecule.atoms[i].group;
    const double for_all = std::min(surface.edge_length.value_or(kNone), share * spheres[i].radius);
    lengths.push_back(group == kNoGroup ? for_all
                                        : grading.of_groups[static_cast<std::size_t>(group)]);
  }
  if (!grading.table.empty()) read_table(grading.table, molecule, lengths);
  return lengths;
}

Options with_edge_lengths(Options options, const Structure& structure) {
  options.surface.edge_lengths =
      edge_lengths_of(options.surface, structure.molecule, structure.spheres);
  return options;
}

}  // namespace vdwmesh::apps
