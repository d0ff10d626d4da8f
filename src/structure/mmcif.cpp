// Reads mmCIF files of macromolecules, and CIF files of small molecules as their asymmetric unit.
//
// gemmi parses the text and builds the structure, but it is silent about much that is wrong or
// missing. Before gemmi builds the structure, this file adds the columns to the table _atom_site
// that gemmi requires and that are not needed here, checks the integers, and replaces the atom ids
// by row indices from 0, so that gemmi::Atom::serial is the index of an AtomRecord. Afterwards it
// checks that all rows became atoms and that positions are finite, and derives missing elements.
//
// The two kinds of file differ in their tags: mmCIF writes _atom_site.id with Cartesian
// coordinates, CIF of small molecules writes _atom_site_label with fractional ones.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <gemmi/cif.hpp>
#include <gemmi/mmcif.hpp>
#include <gemmi/select.hpp>
#include <gemmi/smcif.hpp>

#include "core/errors.hpp"
#include "structure/elements.hpp"
#include "structure/lines.hpp"
#include "structure/mmcif_assembly.hpp"
#include "structure/parsed_file.hpp"

namespace vdwmesh {
namespace {

namespace cif = gemmi::cif;

constexpr const char* kAtoms = "_atom_site.";

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw FileFormatError(fmt::format("{}: {}", path, what));
}

// Parses the CIF syntax. CR line ends become LF first if the file has no LF.
cif::Document parse(std::string_view text, const std::string& path) {
  // gemmi's parser (PEGTL) recognises line ends by LF; files of old Macintoshes have only CR.
  const bool lone_cr =
      text.find('\n') == std::string_view::npos && text.find('\r') != std::string_view::npos;
  if (!lone_cr) return cif::read_memory(text.data(), text.size(), path.c_str());
  std::string lines(text);
  std::replace(lines.begin(), lines.end(), '\r', '\n');
  return cif::read_memory(lines.data(), lines.size(), path.c_str());
}

// The only data block with an atom table. Throws if there is none or more than one.
cif::Block& block_with_atoms(cif::Document& document, const std::string& path) {
  cif::Block* found = nullptr;
  for (cif::Block& block : document.blocks) {
    if (!block.has_tag("_atom_site.id") && !block.has_tag("_atom_site.Cartn_x") &&
        !block.has_tag("_atom_site_fract_x"))
      continue;
    if (found)
      refuse(path, fmt::format("holds atoms in two data blocks, {} and {}; keep one of them",
                               found->name, block.name));
    found = &block;
  }
  if (!found)
    refuse(path, "has no atom coordinates (no _atom_site table); get the coordinate file");
  return *found;
}

// A column that the atom table lacks. It becomes a copy of another column, or the value "?"
// (unknown) in every row.
struct AddedColumn {
  std::string tag;
  int source;  // index of the column to copy; -1: the value is "?"
};

// The columns to add. gemmi ignores a table without them, but their values can be done without: the
// author's chain ids replace label_asym_id, elements are derived from names later, and gemmi takes
// "?" for no alternate location and an occupancy of 1.
std::vector<AddedColumn> columns_to_add(const cif::Loop& loop) {
  std::vector<AddedColumn> added;
  const auto index_of = [&loop](const char* tag) {
    return loop.find_tag(std::string(kAtoms) + tag);
  };
  for (const char* tag : {"label_alt_id", "occupancy", "B_iso_or_equiv", "id", "type_symbol"})
    if (index_of(tag) < 0) added.push_back({std::string(kAtoms) + tag, -1});
  const int author = index_of("auth_asym_id");
  if (index_of("label_asym_id") < 0 && author >= 0)
    added.push_back({std::string(kAtoms) + "label_asym_id", author});
  return added;
}

// Adds the missing columns to the atom table. A loop stores its values row by row in one array, so
// the whole array is rewritten. A table of one row may be written as single items without a loop;
// such a table is left as it is, and refused later if a column is missing.
void complete_columns(cif::Block& block) {
  cif::Loop* loop = block.find_loop("_atom_site.Cartn_x").get_loop();
  if (!loop) return;
  // gemmi requires auth_seq_id. If it is missing, the column label_seq_id gets that tag. `sequence`
  // is the index of the column to rename: -1 if auth_seq_id exists or if there is no label_seq_id.
  const int sequence =
      loop->has_tag("_atom_site.auth_seq_id") ? -1 : loop->find_tag("_atom_site.label_seq_id");
  if (sequence >= 0) loop->tags[static_cast<std::size_t>(sequence)] = "_atom_site.auth_seq_id";
  const std::vector<AddedColumn> added = columns_to_add(*loop);
  if (added.empty()) return;
  const std::size_t rows = loop->length(), width = loop->width();
  std::vector<std::string> values;
  values.reserve(rows * (width + added.size()));
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t first = values.size();
    for (std::size_t column = 0; column < width; ++column)
      values.push_back(std::move(loop->values[row * width + column]));
    for (const AddedColumn& column : added)
      values.push_back(column.source < 0 ? "?"
                                         : values[first + static_cast<std::size_t>(column.source)]);
  }
  loop->values = std::move(values);
  for (const AddedColumn& column : added) loop->tags.push_back(column.tag);
}

// Throws if the table still lacks one of these columns after complete_columns(). Coordinates have
// no substitute. label_asym_id and auth_seq_id are missing if the table lacks their substitutes
// too, and type_symbol if the table is not a loop.
void check_columns(cif::Block& block, const std::string& path) {
  for (const char* tag :
       {"type_symbol", "label_asym_id", "Cartn_x", "Cartn_y", "Cartn_z", "auth_seq_id"})
    if (!block.has_tag(std::string(kAtoms) + tag))
      refuse(path, fmt::format("its _atom_site table lacks the column {}", tag));
}

// gemmi converts integers without a check for overflow, so numbers that might not fit an int are
// refused. Nine digits always fit: 2^31 - 1 has ten. A sign counts as a digit here, so the check is
// stricter than necessary; values that are no integers pass it.
void check_whole_numbers(cif::Block& block, const std::string& path) {
  constexpr std::size_t kMostDigits = 9;
  for (const char* tag : {"label_seq_id", "auth_seq_id", "pdbx_formal_charge"}) {
    const cif::Column column = block.find_values(std::string(kAtoms) + tag);
    for (int row = 0; row < column.length(); ++row) {
      const std::string& value = column.at(row);
      if (value.size() > kMostDigits && value.find_first_not_of("+-0123456789") == value.npos)
        refuse(path, fmt::format("row {} of _atom_site: {} is {}, a number of more than {} digits",
                                 row + 1, tag, in_quotes(value), kMostDigits));
    }
  }
}

// Makes the AtomRecord of every row, and overwrites the column `id`, from which gemmi reads
// gemmi::Atom::serial, with the index of the row from 0. The id of the file goes into
// AtomRecord::serial. AtomRecord::line is the row from 1, and replaces an id that is no integer.
std::vector<AtomRecord> number_rows(cif::Block& block, const std::string& path) {
  cif::Table table = block.find(kAtoms, {"id", "?group_PDB"});
  std::vector<AtomRecord> atoms;
  atoms.reserve(table.length());
  for (cif::Table::Row row : table) {
    AtomRecord atom;
    atom.line = static_cast<std::uint32_t>(atoms.size()) + 1;
    atom.serial = whole_number(row[0]).value_or(atom.line);
    // The value is HETATM or ATOM, and there may be a quote before its first letter. npos is larger
    // than 1.
    if (row.has2(1)) atom.hetero = row[1].find_first_of("Hh") <= 1;
    row[0] = std::to_string(atoms.size());
    atoms.push_back(atom);
  }
  if (atoms.empty()) refuse(path, "its _atom_site table has no rows, so there is nothing to mesh");
  return atoms;
}

// Throws for an atom whose position is not finite, and names the coordinate that is at fault. gemmi
// converts the fields with the same as_number(), so the last refuse() is a safeguard only.
[[noreturn]] void refuse_position(cif::Block& block, const ParsedFile& file,
                                  const gemmi::Atom& atom) {
  for (const char axis : {'x', 'y', 'z'}) {
    const std::string field =
        block.find_values(fmt::format("{}Cartn_{}", kAtoms, axis)).at(atom.serial);
    if (!std::isfinite(cif::as_number(field)))
      refuse(file.path,
             fmt::format("row {} of _atom_site (id {}): Cartn_{} is {}, not a finite number",
                         atom.serial + 1, file.atoms[static_cast<std::size_t>(atom.serial)].serial,
                         axis, in_quotes(field)));
  }
  refuse(file.path, fmt::format("row {} of _atom_site has no position", atom.serial + 1));
}

// Sets the element of an atom for which gemmi found none. The file may give a symbol with a charge
// that gemmi does not read ("O2-"). If it gives no symbol (as_string() makes "?" and "." empty),
// the names of atom and residue decide. `symbols` is the column type_symbol.
void complete_element(const cif::Column& symbols, const gemmi::Residue& residue, gemmi::Atom& atom,
                      ParsedFile& file) {
  AtomRecord& record = file.atoms[static_cast<std::size_t>(atom.serial)];
  const std::string symbol = cif::as_string(symbols.at(atom.serial));
  record.element_guessed = symbol.empty();
  if (symbol.empty() && is_martini_bead(atom.name, residue.name)) file.coarse_grained = true;
  atom.element = gemmi::Element(symbol.empty() ? element_of_bare_name(atom.name, residue.name)
                                               : element_of_symbol(symbol));
}

// Checks the position of every atom, and completes its element if necessary. gemmi turns a
// coordinate that is not a number into NaN, and an element that it does not know into X, without an
// error.
void complete_atoms(cif::Block& block, ParsedFile& file) {
  const cif::Column symbols = block.find_values("_atom_site.type_symbol");
  for (gemmi::Model& model : file.structure->models)
    for (gemmi::Chain& chain : model.chains)
      for (gemmi::Residue& residue : chain.residues)
        for (gemmi::Atom& atom : residue.atoms) {
          if (!std::isfinite(atom.pos.x) || !std::isfinite(atom.pos.y) ||
              !std::isfinite(atom.pos.z))
            refuse_position(block, file, atom);
          if (atom.element == gemmi::El::X) complete_element(symbols, residue, atom, file);
        }
}

// Throws if gemmi read fewer atoms than the table has rows. gemmi ignores the whole table if a
// required column is not among its columns. check_columns() does not see that if the column stands
// in another loop of the block.
void check_all_rows_read(const ParsedFile& file) {
  std::size_t read = 0;
  for (const gemmi::Model& model : file.structure->models) read += gemmi::count_atom_sites(model);
  if (read != file.atoms.size())
    refuse(file.path, fmt::format("{} of {} rows of _atom_site could be read as atoms; are all its "
                                  "columns in one loop?",
                                  read, file.atoms.size()));
}

// The order matters. complete_columns() must precede check_columns(). take_assembly_tables() must
// remove the tables before gemmi sees the block: gemmi would expand their operator expressions at
// once, and a few characters can stand for billions of copies.
void read_macromolecule(cif::Block& block, ParsedFile& file) {
  complete_columns(block);
  check_columns(block, file.path);
  check_whole_numbers(block, file.path);
  file.atoms = number_rows(block, file.path);
  // Anisotropic displacements are not needed, and gemmi would match them with the atoms by id,
  // which number_rows() has overwritten.
  for (cif::Item& item : block.items)
    if (item.has_prefix("_atom_site_anisotrop.")) item.erase();
  file.assemblies = take_assembly_tables(block);
  *file.structure = gemmi::make_structure_from_block(block);
  check_all_rows_read(file);
  complete_atoms(block, file);
  file.format = "mmcif";
}

// The element in the label of a small molecule's atom, which begins with the symbol. A second
// letter in lower case belongs to the symbol: "Ca1" is calcium. In capitals, "CA1" may be calcium
// or a carbon A1, so the rules for bare atom names decide. They also decide if the symbol is
// unknown, "X". The test for "X" catches xenon, "Xe", too, which these rules find as well.
const char* element_of_label(const std::string& label) {
  const bool two = label.size() > 1 && std::islower(static_cast<unsigned char>(label[1])) != 0;
  const char* element = two ? element_of_symbol(label.substr(0, 2)) : "X";
  return element[0] != 'X' ? element : element_of_bare_name(label, "");
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
void read_small_molecule(cif::Block& block, ParsedFile& file) {
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
    AtomRecord record;
    record.serial = static_cast<std::int64_t>(i) + 1;
    record.line = static_cast<std::uint32_t>(i) + 1;
    record.element_guessed = !has_symbol;
    file.atoms.push_back(record);
  }
  gemmi::Model model("1");
  model.chains.emplace_back("A");
  model.chains[0].residues.push_back(std::move(residue));
  file.structure->models.push_back(std::move(model));
  file.format = "cif";
}

}  // namespace

ParsedFile parse_mmcif(std::string_view text, const std::string& path) {
  ParsedFile file;
  file.path = path;
  file.structure = std::make_shared<gemmi::Structure>();
  try {
    cif::Document document = parse(text, path);
    cif::Block& block = block_with_atoms(document, path);
    if (block.has_tag("_atom_site_fract_x"))
      read_small_molecule(block, file);
    else
      read_macromolecule(block, file);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {  // from gemmi; most of its messages begin with the path
    const std::string what = one_line(error.what());
    throw FileFormatError(what.rfind(path, 0) == 0 ? what : fmt::format("{}: {}", path, what));
  }
  return file;
}

}  // namespace vdwmesh
