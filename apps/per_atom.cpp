// Adds up the measures of atoms by atom, residue or chain. Sums are wide, so that they do not
// depend on the order. Rows stand in the order of the file, whatever the group.
#include "per_atom.hpp"

#include <fmt/format.h>

#include <map>
#include <tuple>

#include "core/sum.hpp"
#include "csv.hpp"

namespace vdwmesh::apps {
namespace {

constexpr const char* kHeader =
    "model,chain,residue_number,residue_name,atom_name,element,serial,atoms,radius,exact_area,"
    "mesh_area,exact_volume,measured\n";

// What the atoms of a row share; empty where they need not.
using Key = std::tuple<std::int32_t, std::string, std::string, std::string>;

Key key_of(const Atom& atom, AtomGroup group) {
  if (group == AtomGroup::chain) return {atom.model, atom.chain, "", ""};
  return {atom.model, atom.chain, atom.residue_number, atom.residue_name};
}

// Sums are over the measured atoms.
struct Row {
  Key key;
  const Atom* atom = nullptr;  // of AtomGroup::atom
  std::uint64_t atoms = 0, measured = 0;
  WideSum exact_area, mesh_area, exact_volume;
};

// Which row each atom adds to; rows in the order of their first atoms.
std::vector<Row> make_rows(const Molecule& molecule, AtomGroup group,
                           std::vector<std::size_t>& row_of_atom) {
  std::vector<Row> rows;
  std::map<Key, std::size_t> known;
  for (const Atom& atom : molecule.atoms) {
    const Key key = key_of(atom, group);
    std::size_t row = rows.size();
    if (group != AtomGroup::atom) row = known.try_emplace(key, row).first->second;
    if (row == rows.size()) {
      rows.push_back({key, group == AtomGroup::atom ? &atom : nullptr, 0, 0, {}, {}, {}});
    }
    row_of_atom.push_back(row);
  }
  return rows;
}

// A sum over no atom has no value.
std::string sum_field(const Row& row, const WideSum& sum) {
  return row.measured > 0 ? fmt::format("{}", sum.value()) : "";
}

// What the atoms of a row do not share has no value for it.
void print(std::string& csv, const Row& row, double probe, bool with_mesh) {
  const auto& [model, chain, residue_number, residue_name] = row.key;
  csv += fmt::format("{},{},{},{},", model, csv_field(chain), csv_field(residue_number),
                     csv_field(residue_name));
  if (row.atom) {
    csv += fmt::format("{},{},{},{},{}", csv_field(row.atom->name), row.atom->element,
                       row.atom->serial, row.atoms, row.atom->radius + probe);
  } else {
    csv += fmt::format(",,,{},", row.atoms);
  }
  csv += fmt::format(",{},{},{},{}\n", sum_field(row, row.exact_area),
                     with_mesh ? sum_field(row, row.mesh_area) : "",
                     sum_field(row, row.exact_volume), row.measured);
}

}  // namespace

std::string per_atom_csv(const Molecule& molecule, double probe, const ExactUnion& exact,
                         const std::vector<double>& mesh_area, AtomGroup group) {
  std::vector<std::size_t> row_of_atom;
  std::vector<Row> rows = make_rows(molecule, group, row_of_atom);
  for (std::size_t i = 0; i < row_of_atom.size(); ++i) {
    Row& row = rows[row_of_atom[i]];
    ++row.atoms;
    if (!molecule.atoms[i].measured) continue;
    ++row.measured;
    row.exact_area.add(exact.per_sphere[i].area);
    row.exact_volume.add(exact.per_sphere[i].volume);
    if (!mesh_area.empty()) row.mesh_area.add(mesh_area[i]);
  }
  std::string csv = kHeader;
  for (const Row& row : rows) print(csv, row, probe, !mesh_area.empty());
  return csv;
}

}  // namespace vdwmesh::apps
