// Adds up the measures of atoms by atom, residue or chain. Sums are wide, so that they do not
// depend on the order. Rows stand in the order of the file, whatever the group.
#include "report/per_atom.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>

#include "analysis/exposure.hpp"
#include "core/sum.hpp"
#include "report/atom_file.hpp"
#include "report/csv.hpp"

namespace vdwmesh::apps {
namespace {

constexpr const char* kHeader =
    "model,chain,residue_number,residue_name,atom_name,element,serial,atoms,radius,exact_area,"
    "mesh_area,exact_volume,measured,polarity,polar_area,apolar_area,unclassified_area,"
    "relative_area,relative_main_chain,relative_side_chain,relative_polar,relative_apolar,"
    "segment\n";

// What tells rows apart. Residues of one number and name are told by their place in the file. A
// chain without an id is told by its segment.
using Key = std::tuple<std::int32_t, std::string_view, std::uint32_t, std::string_view>;

Key key_of(const Atom& atom, AtomGroup group) {
  if (group == AtomGroup::residue) return {atom.model, atom.chain, atom.residue, {}};
  return {atom.model, atom.chain, 0, atom.chain.empty() ? atom.segment.view() : std::string_view()};
}

// Sums are over the measured atoms.
struct AtomRow {
  const Atom* first;  // of its atoms
  AtomGroup group;
  bool one_segment = true;
  std::uint64_t atoms = 0, measured = 0;
  WideSum exact_area, mesh_area, exact_volume;
  ResidueSum parts;  // of the exact area
};

// Makes the rows, in the order of their first atoms, and appends to `row_of_atom` the row of each
// atom.
std::vector<AtomRow> make_rows(const Molecule& molecule, AtomGroup group,
                               std::vector<std::size_t>& row_of_atom) {
  std::vector<AtomRow> rows;
  std::map<Key, std::size_t> known;
  for (const Atom& atom : molecule.atoms) {
    std::size_t row = rows.size();
    if (group != AtomGroup::atom) row = known.try_emplace(key_of(atom, group), row).first->second;
    if (row == rows.size()) rows.push_back({&atom, group, true, 0, 0, {}, {}, {}, {}});
    rows[row].one_segment &= atom.segment == rows[row].first->segment;
    row_of_atom.push_back(row);
  }
  return rows;
}

// A sum over no atom has no value.
std::string sum_field(const AtomRow& row, const WideSum& sum) {
  return row.measured > 0 ? fmt::format("{}", sum.value()) : "";
}

const char* polarity_field(Polarity polarity) {
  switch (polarity) {
    case Polarity::polar:
      return "polar";
    case Polarity::apolar:
      return "apolar";
    case Polarity::unknown:
      return "";
  }
  return "";
}

// The parts of the area by polarity, each after a comma.
std::string polarity_fields(const AtomRow& row, const PerAtomTable& table) {
  if (!table.molecule.has_polarity || row.measured == 0) return ",,,";
  const ResidueAreas areas = row.parts.areas();
  return fmt::format(",{},{},{}", areas.polar, areas.apolar, row.parts.unclassified_area());
}

// The areas as shares of the reference. There are none unless the row is a residue that has a
// reference for this probe, and all of its atoms were measured.
std::optional<ResidueAreas> shares_of(const AtomRow& row, const PerAtomTable& table) {
  const bool comparable = row.group == AtomGroup::residue && table.probe == kReferenceProbe &&
                          row.measured == row.atoms;
  const auto reference = comparable
                             ? reference_areas(table.molecule.radius_set, row.first->residue_name)
                             : std::nullopt;
  if (!reference) return std::nullopt;
  return relative_areas(row.parts.areas(), *reference);
}

// The same, each after a comma.
std::string relative_fields(const AtomRow& row, const PerAtomTable& table) {
  const auto relative = shares_of(row, table);
  if (!relative) return ",,,,,";
  return fmt::format(",{},{},{},{},{}", csv_number(relative->total),
                     csv_number(relative->main_chain), csv_number(relative->side_chain),
                     csv_number(relative->polar), csv_number(relative->apolar));
}

// Appends what and where the atoms of a row are. Fields in which they differ are empty.
void print_place(std::string& csv, const AtomRow& row, double probe) {
  const Atom& atom = *row.first;
  const bool of_chain = row.group == AtomGroup::chain;
  csv += fmt::format("{},{},{},{},", atom.model, csv_field(atom.chain),
                     of_chain ? "" : csv_field(atom.residue_number),
                     of_chain ? "" : csv_field(atom.residue_name));
  if (row.group == AtomGroup::atom) {
    csv += fmt::format("{},{},{},{},{}", csv_field(atom.name), atom.element.view(), atom.serial,
                       row.atoms, atom.radius + probe);
  } else {
    csv += fmt::format(",,,{},", row.atoms);
  }
}

// The segment behind a comma; empty where a chain has several.
std::string segment_field(const AtomRow& row) {
  return fmt::format(",{}", row.one_segment ? csv_field(row.first->segment) : std::string());
}

void print(std::string& csv, const AtomRow& row, const PerAtomTable& table) {
  print_place(csv, row, table.probe);
  csv += fmt::format(",{},{},{},{},{}", sum_field(row, row.exact_area),
                     table.mesh_area.empty() ? "" : sum_field(row, row.mesh_area),
                     sum_field(row, row.exact_volume), row.measured,
                     row.group == AtomGroup::atom ? polarity_field(row.first->polarity) : "");
  csv += polarity_fields(row, table) + relative_fields(row, table) + segment_field(row) + '\n';
}

// The rows with their sums; `row_of_atom` as of make_rows().
std::vector<AtomRow> summed_rows(const PerAtomTable& table, AtomGroup group,
                                 std::vector<std::size_t>& row_of_atom) {
  const std::vector<Atom>& atoms = table.molecule.atoms;
  std::vector<AtomRow> rows = make_rows(table.molecule, group, row_of_atom);
  for (std::size_t i = 0; i < row_of_atom.size(); ++i) {
    AtomRow& row = rows[row_of_atom[i]];
    ++row.atoms;
    if (!atoms[i].measured) continue;
    ++row.measured;
    const SphereMeasures& measures = table.exact.per_sphere[i];
    row.exact_area.add(measures.area);
    row.exact_volume.add(measures.volume);
    row.parts.add(atoms[i], measures.area);
    if (!table.mesh_area.empty()) row.mesh_area.add(table.mesh_area[i]);
  }
  return rows;
}

// In the order of NACCESS: all atoms, side chain, main chain, apolar, polar.
std::array<double, 5> in_order(const ResidueAreas& a) {
  return {a.total, a.side_chain, a.main_chain, a.apolar, a.polar};
}

// One residue: areas, and percentages of those of an extended one.
std::string residue_line(const AtomRow& row, const PerAtomTable& table) {
  const auto [number, code] = number_and_code(row.first->residue_number);
  std::string line = fmt::format("RES {:>3} {:1}{:>4}{} ", row.first->residue_name.view(),
                                 row.first->chain.view(), number, code);
  const auto areas = in_order(row.parts.areas());
  const auto relative = shares_of(row, table);
  for (std::size_t k = 0; k < areas.size(); ++k) {
    const double percent = relative ? 100 * in_order(*relative)[k] : std::nan("");
    line += std::isnan(percent) ? fmt::format("{:7.2f}   N/A", areas[k])
                                : fmt::format("{:7.2f}{:6.1f}", areas[k], percent);
  }
  return line + '\n';
}

std::string sum_line(const std::string& begin, std::size_t width, const ResidueSum& sum) {
  const auto [total, side, main, apolar, polar] = in_order(sum.areas());
  return fmt::format("{}{:{}.1f}{:13.1f}{:13.1f}{:13.1f}{:13.1f}\n", begin, total, width, side,
                     main, apolar, polar);
}

}  // namespace

std::string per_atom_csv(const PerAtomTable& table) {
  std::vector<std::size_t> row_of_atom;
  std::string csv = kHeader;
  for (const AtomRow& row : summed_rows(table, table.group, row_of_atom)) print(csv, row, table);
  return csv;
}

std::vector<double> residue_exposure(const PerAtomTable& table) {
  std::vector<std::size_t> row_of_atom;
  const std::vector<AtomRow> rows = summed_rows(table, AtomGroup::residue, row_of_atom);
  std::vector<double> exposure;
  for (const std::size_t row : row_of_atom) {
    const auto relative = shares_of(rows[row], table);
    exposure.push_back(relative ? 100 * relative->total : std::nan(""));
  }
  return exposure;
}

std::string residue_areas_text(const PerAtomTable& table) {
  std::vector<std::size_t> row_of_atom;
  std::string text = fmt::format(
      "REM  Relative accessible areas by vdwmesh, exact\n"
      "REM  Radii and extended residues: {}\n"
      "REM RES _ NUM      All-atoms   Total-Side   Main-Chain    Non-polar    All polar\n"
      "REM                ABS   REL    ABS   REL    ABS   REL    ABS   REL    ABS   REL\n",
      table.molecule.radius_set);
  for (const AtomRow& row : summed_rows(table, AtomGroup::residue, row_of_atom))
    text += residue_line(row, table);
  text += "END  Absolute sums over single chains surface\n";
  row_of_atom.clear();
  int chain = 0;
  for (const AtomRow& row : summed_rows(table, AtomGroup::chain, row_of_atom))
    text +=
        sum_line(fmt::format("CHAIN{:3} {:1}", ++chain, row.first->chain.view()), 11, row.parts);
  text += "END  Absolute sums over all chains\n";
  ResidueSum sum;
  for (std::size_t i = 0; i < table.molecule.atoms.size(); ++i) {
    const Atom& atom = table.molecule.atoms[i];
    if (atom.measured) sum.add(atom, table.exact.per_sphere[i].area);
  }
  return text + sum_line("TOTAL", 16, sum);
}

std::string excluded_atoms_csv(const Molecule& molecule, const std::vector<ExcludedAtom>& shares,
                               AtomGroup group) {
  std::vector<std::size_t> row_of_atom;
  std::vector<AtomRow> rows = make_rows(molecule, group, row_of_atom);
  std::vector<std::array<WideSum, 4>> sums(rows.size());  // contact, saddle, concave, volume
  for (std::size_t i = 0; i < row_of_atom.size(); ++i) {
    ++rows[row_of_atom[i]].atoms;
    std::array<WideSum, 4>& sum = sums[row_of_atom[i]];
    sum[0].add(shares[i].area.contact);
    sum[1].add(shares[i].area.saddle);
    sum[2].add(shares[i].area.concave);
    sum[3].add(shares[i].volume);
  }
  std::string csv =
      "model,chain,residue_number,residue_name,atom_name,element,serial,atoms,radius,contact_area,"
      "saddle_area,concave_area,excluded_area,excluded_volume,segment\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    print_place(csv, rows[r], 0);
    const auto& [contact, saddle, concave, volume] = sums[r];
    csv += fmt::format(",{},{},{},{},{}", contact.value(), saddle.value(), concave.value(),
                       contact.value() + saddle.value() + concave.value(), volume.value());
    csv += segment_field(rows[r]) + '\n';
  }
  return csv;
}

std::string depth_csv(const Molecule& molecule, double probe, const AtomDepths& depths,
                      AtomGroup group) {
  std::vector<std::size_t> row_of_atom;
  std::vector<AtomRow> rows = make_rows(molecule, group, row_of_atom);
  std::vector<std::array<WideSum, 2>> sums(rows.size());  // complete, exterior
  for (std::size_t i = 0; i < row_of_atom.size(); ++i) {
    ++rows[row_of_atom[i]].atoms;
    sums[row_of_atom[i]][0].add(depths.complete[i]);
    sums[row_of_atom[i]][1].add(depths.exterior[i]);
  }
  std::string csv =
      "model,chain,residue_number,residue_name,atom_name,element,serial,atoms,radius,"
      "depth_accessible,depth_excluded,depth_exterior,segment\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    print_place(csv, rows[r], 0);
    const auto atoms = static_cast<double>(rows[r].atoms);
    const double complete = sums[r][0].value() / atoms, exterior = sums[r][1].value() / atoms;
    csv +=
        fmt::format(",{},{},{}{}\n", complete + probe, complete, exterior, segment_field(rows[r]));
  }
  return csv;
}

std::string interface_csv(const InterfaceTable& table) {
  const auto& [molecule, probe, sides, side_of_atom, found, group] = table;
  struct Loss {
    WideSum buried, contact;
  };
  std::vector<std::size_t> row_of_atom;
  std::vector<AtomRow> rows = make_rows(molecule, group, row_of_atom);
  std::vector<std::array<WideSum, 2>> areas(rows.size());  // alone, among all
  for (std::size_t i = 0; i < row_of_atom.size(); ++i) {
    ++rows[row_of_atom[i]].atoms;
    if (side_of_atom[i] < 0) continue;
    areas[row_of_atom[i]][0].add(found.alone[i]);
    areas[row_of_atom[i]][1].add(found.in_whole[i]);
  }
  std::string csv =
      "side,other_side,model,chain,residue_number,residue_name,atom_name,element,serial,atoms,"
      "radius,area,area_in_pair,area_in_whole,buried_area,contact_area,segment\n";
  for (const Interface& pair : found.pairs) {
    std::map<std::pair<std::int32_t, std::size_t>, Loss> losses;  // by side and row
    const auto loss_of = [&](SphereId id) -> Loss& {
      return losses[{side_of_atom[id], row_of_atom[id]}];
    };
    for (const InterfaceAtom& atom : pair.atoms) loss_of(atom.sphere).buried.add(atom.buried());
    for (const AtomContact& contact : pair.contacts) {
      loss_of(contact.a).contact.add(contact.area);
      loss_of(contact.b).contact.add(contact.area);
    }
    for (const auto& [place, loss] : losses) {
      const auto& [side, row] = place;
      const double buried = loss.buried.value(), contact = loss.contact.value();
      if (buried == 0 && contact == 0) continue;
      const std::int32_t other = side == pair.a ? pair.b : pair.a;
      csv += fmt::format("{},{},", csv_field(sides[static_cast<std::size_t>(side)]),
                         csv_field(sides[static_cast<std::size_t>(other)]));
      print_place(csv, rows[row], probe);
      const double area = areas[row][0].value();
      csv += fmt::format(",{},{},{},{},{}{}\n", area, area - buried, areas[row][1].value(), buried,
                         contact, segment_field(rows[row]));
    }
  }
  return csv;
}

std::string gradient_csv(const std::vector<BallGradient>& gradients) {
  std::string csv = "dA_dx,dA_dy,dA_dz,dA_dr,dV_dx,dV_dy,dV_dz,dV_dr\n";
  for (const BallGradient& g : gradients) {
    const auto& [area, by_radius, volume, exposed] = g;
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{}\n", area.x, area.y, area.z,
                   by_radius, volume.x, volume.y, volume.z, exposed);
  }
  return csv;
}

}  // namespace vdwmesh::apps
