// Reads CIF files of small molecules as their asymmetric unit, and those of chemical components.
// gemmi parses the text, because these files are short (cif_tokens.hpp says why it does not parse
// others), and places the fractional coordinates.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <gemmi/chemcomp_xyz.hpp>
#include <gemmi/cif.hpp>
#include <gemmi/model.hpp>
#include <gemmi/smcif.hpp>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/cif/mmcif.hpp"
#include "structure/molecule/elements.hpp"
#include "structure/read/hierarchy.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

namespace cif = gemmi::cif;

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw FileFormatError(fmt::format("{}: {}", path, what));
}

// The only data block with fractional coordinates. Throws if there is more than one.
cif::Block& block_with_atoms(cif::Document& document, const std::string& path) {
  cif::Block* found = nullptr;
  for (cif::Block& block : document.blocks) {
    if (!block.has_tag("_atom_site_fract_x")) continue;
    if (found) refuse(path, two_blocks_with_atoms(found->name, block.name));
    found = &block;
  }
  if (!found) refuse(path, "has no atom coordinates; are they in a save frame?");
  return *found;
}

// The element in the label of a small molecule's atom, which begins with the symbol. A second
// letter in lower case belongs to the symbol: "Ca1" is calcium. In capitals, "CA1" may be calcium
// or a carbon A1, so the rules for bare atom names decide. They also decide if the symbol is
// unknown, "X".
const char* element_of_label(const std::string& label) {
  const bool two = label.size() > 1 && std::islower(static_cast<unsigned char>(label[1])) != 0;
  const char* element = two ? element_of_symbol(label.substr(0, 2)) : "X";
  return std::string_view(element) != "X" ? element : element_of_bare_name(label, "");
}

// The atom of row `index`. Fractional coordinates become Cartesian ones (Å) by the unit cell. If
// the row has no symbol, its label gives the element. gemmi takes a symbol such as "OW" for two
// letters and knows no such element; the rules for bare atom names then find the first letter.
//
// A disorder group from 1 to 9 becomes the label of an alternate location. A minus sign marks
// disorder about a special position and is ignored. Higher numbers give no label.
gemmi::Atom crystal_atom(const gemmi::SmallStructure& crystal, std::size_t index, bool has_symbol,
                         const std::string& path) {
  const gemmi::SmallStructure::Site& site = crystal.sites[index];
  gemmi::Atom atom;
  atom.name = site.label;
  const std::string& symbol = site.type_symbol;
  if (has_symbol && symbol.size() > 2 && is_letter(symbol[1]) && is_letter(symbol[2]))
    refuse(path, fmt::format("row {} of _atom_site: type_symbol is {}, not the symbol of an "
                             "element, such as C or Zn",
                             index + 1, in_quotes(symbol)));
  atom.element = has_symbol ? site.element : gemmi::Element(element_of_label(site.label));
  if (atom.element == gemmi::El::X)
    atom.element = gemmi::Element(element_of_bare_name(site.type_symbol, ""));
  atom.serial = static_cast<int>(index);
  atom.occ = static_cast<float>(site.occ);
  const int group = std::abs(site.disorder_group);
  if (group > 0 && group < 10) atom.altloc = static_cast<char>('0' + group);
  atom.pos = site.orth(crystal.cell);
  if (!std::isfinite(atom.pos.x) || !std::isfinite(atom.pos.y) || !std::isfinite(atom.pos.z))
    refuse(path, fmt::format("row {} of _atom_site ({}): its fractional coordinates are not finite "
                             "numbers",
                             index + 1, site.label));
  return atom;
}

// All atoms go into one residue UNL ("unknown ligand") of chain A in model 1. Their AtomRecords
// hold the row from 1 twice, as line and as serial, because these files number no atoms.
void read_block(cif::Block& block, ParsedFile& file) {
  const gemmi::SmallStructure crystal = gemmi::make_small_structure_from_block(block);
  if (crystal.sites.empty()) refuse(file.path, "its _atom_site table has no rows");
  if (!crystal.cell.is_crystal())
    refuse(file.path, "gives fractional coordinates but no unit cell to place them in");
  // Without this column gemmi fills type_symbol with the label, which must not count as a symbol.
  const bool has_symbols = block.has_tag("_atom_site_type_symbol");
  gemmi::Residue residue;
  residue.name = "UNL";
  residue.seqid.num = 1;
  for (std::size_t i = 0; i < crystal.sites.size(); ++i) {
    const bool has_symbol = has_symbols && !crystal.sites[i].type_symbol.empty();
    residue.atoms.push_back(crystal_atom(crystal, i, has_symbol, file.path));
    AtomRecord record{};
    record.serial = static_cast<std::int64_t>(i) + 1;
    record.line = static_cast<std::uint32_t>(i) + 1;
    record.element_guessed = !has_symbol;
    file.atoms.push_back(record);
  }
  gemmi::Model model("1");
  model.chains.emplace_back("A");
  model.chains[0].residues.push_back(std::move(residue));
  file.structure->models.push_back(std::move(model));
  take_gemmi_atoms(file);
  file.format = "cif";
}

// The only data block that lists atoms of a chemical component, in a file without a crystal. Null
// if there is none.
const cif::Block* block_with_component(const cif::Document& document, const std::string& path) {
  const cif::Block* found = nullptr;
  for (const cif::Block& block : document.blocks) {
    if (block.has_tag("_atom_site_fract_x")) return nullptr;
    if (!block.has_tag("_chem_comp_atom.atom_id")) continue;
    if (found) refuse(path, two_blocks_with_atoms(found->name, block.name));
    found = &block;
  }
  return found;
}

// The atoms of a component of wwPDB's dictionary or of a library of Refmac, in one residue. Of the
// sets of coordinates that gemmi finds, the first that has all atoms is read: x, y and z of Refmac,
// those of a model, or ideal ones.
void read_component(const cif::Block& block, ParsedFile& file) {
  const auto is_placed = [](const gemmi::Atom& atom) {
    return std::isfinite(atom.pos.x) && std::isfinite(atom.pos.y) && std::isfinite(atom.pos.z);
  };
  gemmi::Structure component = gemmi::make_structure_from_chemcomp_block(block);
  for (gemmi::Model& model : component.models) {
    gemmi::Residue& residue = model.chains.at(0).residues.at(0);
    if (!std::all_of(residue.atoms.begin(), residue.atoms.end(), is_placed)) continue;
    file.warnings.push_back(
        fmt::format("describes a chemical component, {}, of which the coordinates {} are read",
                    residue.name, model.name));
    residue.seqid.num = 1;
    for (std::size_t i = 0; i < residue.atoms.size(); ++i) {
      residue.atoms[i].serial = static_cast<int>(i);
      file.atoms.emplace_back().serial = static_cast<std::int64_t>(i) + 1;
      file.atoms.back().line = static_cast<std::uint32_t>(i) + 1;
    }
    model.name = "1";
    file.structure->models.push_back(std::move(model));
    take_gemmi_atoms(file);
    file.format = "cif";
    return;
  }
  refuse(file.path,
         "describes a chemical component, and has no set of coordinates for all of its "
         "atoms (_chem_comp_atom); get one with ideal coordinates");
}

}  // namespace

void read_small_molecule(std::string_view text, ParsedFile& file) {
  cif::Document document = cif::read_memory(text.data(), text.size(), file.path.c_str());
  if (const cif::Block* const component = block_with_component(document, file.path))
    return read_component(*component, file);
  read_block(block_with_atoms(document, file.path), file);
}

}  // namespace vdwmesh
