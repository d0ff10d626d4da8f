// Writes atoms as PDB and mmCIF. Coordinates have the digits of the formats, three decimals; other
// figures of mmCIF have all digits. What a reader left out is left out here, too.
#include "report/atom_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/letters.hpp"
#include "request/refuse.hpp"

namespace vdwmesh::apps {
namespace {

// A name stands from the second of four columns on, so that symbols of one letter, which most are,
// end in the second; names of four letters and symbols of two begin in the first.
std::string atom_name_columns(const Atom& atom) {
  const bool shifted = atom.name.size() < 4 && atom.element.size() < 2;
  return fmt::format("{}{:<{}}", shifted ? " " : "", atom.name.view(), shifted ? 3 : 4);
}

std::string pdb_record(const Atom& atom, std::uint64_t serial, double figure) {
  const Vec3d& p = atom.position;
  const auto [number, code] = number_and_code(atom.residue_number);
  refuse_if(atom.name.size() > 4 || atom.residue_name.size() > 4 || atom.chain.size() > 1 ||
                number.size() > 4 || !fits_in_pdb(p) || !(std::abs(figure) < 999.995),
            "a PDB file has no room for atom {} (chain {}, residue {} {}, at {:.3f}, {:.3f}, "
            "{:.3f}, with the figure {:.2f}); write .cif",
            atom.name.view(), atom.chain.view(), atom.residue_name.view(),
            atom.residue_number.view(), p.x, p.y, p.z, figure);
  // The fourth letter of a residue's name takes the column before the chain.
  return fmt::format(
      "{:<6}{:5} {} {:>3}{}{:1}{:>4}{}   {:8.3f}{:8.3f}{:8.3f}  1.00{:6.2f}      {:<4}{:>2}\n",
      atom.hetero ? "HETATM" : "ATOM", serial, atom_name_columns(atom), atom.residue_name.view(),
      atom.residue_name.size() > 3 ? "" : " ", atom.chain.view(), number, code, p.x, p.y, p.z,
      figure, atom.segment.view().substr(0, 4), upper_case(atom.element.view()));
}

// A value of CIF: unquoted where it may be, "." where there is none.
std::string cif_value(std::string_view text) {
  if (text.empty()) return ".";
  const bool is_plain = std::ranges::all_of(text, [](char c) { return c > ' ' && c < 127; }) &&
                        std::string_view("'\"_#$[];.?").find(text.front()) == text.npos &&
                        !lower_case(text).starts_with("data_") &&
                        !lower_case(text).starts_with("save_") && lower_case(text) != "loop_" &&
                        lower_case(text) != "stop_" && lower_case(text) != "global_";
  if (is_plain) return std::string(text);
  const char quote = text.find('"') == text.npos ? '"' : '\'';
  return fmt::format("{}{}{}", quote, text, quote);
}

std::string cif_figure(double figure, const char* format) {
  return std::isnan(figure) ? "?" : fmt::format(fmt::runtime(format), figure);
}

bool has_models(const Molecule& molecule) {
  const auto& atoms = molecule.atoms;
  return std::ranges::any_of(atoms,
                             [&](const Atom& atom) { return atom.model != atoms.front().model; });
}

}  // namespace

std::string atoms_as_pdb(const Molecule& molecule, const AtomColumns& figures) {
  constexpr std::uint64_t kSerials = 100'000;  // five columns
  const bool models = has_models(molecule);
  std::string text =
      fmt::format("REMARK 999 B FACTORS ARE {} BY VDWMESH\n", upper_case(figures.front().name));
  for (std::size_t i = 0; i < molecule.atoms.size(); ++i) {
    const Atom& atom = molecule.atoms[i];
    if (models && (i == 0 || atom.model != molecule.atoms[i - 1].model))
      text += fmt::format("{}MODEL     {:4}\n", i == 0 ? "" : "ENDMDL\n", atom.model);
    const double figure = figures.front().values[i];
    text += pdb_record(atom, (i + 1) % kSerials, std::isnan(figure) ? -1 : figure);
  }
  return text + (models ? "ENDMDL\nEND\n" : "END\n");
}

std::string atoms_as_cif(const Molecule& molecule, const AtomColumns& figures) {
  std::string text =
      "data_vdwmesh\nloop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.type_symbol\n"
      "_atom_site.label_atom_id\n_atom_site.label_alt_id\n_atom_site.label_comp_id\n"
      "_atom_site.label_asym_id\n_atom_site.label_entity_id\n_atom_site.label_seq_id\n"
      "_atom_site.pdbx_PDB_ins_code\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n"
      "_atom_site.occupancy\n_atom_site.B_iso_or_equiv\n_atom_site.auth_seq_id\n"
      "_atom_site.auth_comp_id\n_atom_site.auth_asym_id\n_atom_site.auth_atom_id\n"
      "_atom_site.pdbx_PDB_model_num\n";
  for (const AtomColumn& column : figures)
    text += fmt::format("_atom_site.vdwmesh_{}\n", column.name);
  for (std::size_t i = 0; i < molecule.atoms.size(); ++i) {
    const Atom& atom = molecule.atoms[i];
    const Vec3d& p = atom.position;
    const auto [number, code] = number_and_code(atom.residue_number);
    const std::string name = cif_value(atom.name), residue = cif_value(atom.residue_name),
                      chain = cif_value(atom.chain), seq = cif_value(number);
    fmt::format_to(std::back_inserter(text),
                   "{} {} {} {} . {} {} ? {} {} {:.3f} {:.3f} {:.3f} 1.00 {} {} {} {} {} {}",
                   atom.hetero ? "HETATM" : "ATOM", i + 1, cif_value(atom.element), name, residue,
                   chain, seq, code == ' ' ? "?" : cif_value({&code, 1}), p.x, p.y, p.z,
                   cif_figure(figures.front().values[i], "{:.2f}"), seq, residue, chain, name,
                   atom.model);
    for (const AtomColumn& column : figures) text += ' ' + cif_figure(column.values[i], "{}");
    text += '\n';
  }
  return text;
}

AtomWriter find_atom_writer(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".pdb" || extension == ".ent") return atoms_as_pdb;
  if (extension == ".cif" || extension == ".mmcif") return atoms_as_cif;
  return nullptr;
}

}  // namespace vdwmesh::apps
