// The hierarchy is the one that gemmi makes of mmCIF files: a change of the chain's name begins a
// chain, and a residue is looked for among those of the chain before it is added, so rows of one
// residue may stand apart. Residues are numbered as they are opened. That is their order in the
// hierarchy unless rows go back to an earlier model; then finish() numbers them anew.
#include "structure/cif/atom_site.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <gemmi/mmcif.hpp>
#include <limits>
#include <numeric>
#include <utility>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "core/letters.hpp"
#include "structure/cif/mmcif_assembly.hpp"
#include "structure/molecule/elements.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

using Column = AtomSiteColumn;

// In the order of AtomSiteColumn.
constexpr std::array<std::string_view, kAtomSiteColumns> kNames{
    "group_PDB",       "id",
    "type_symbol",     "label_atom_id",
    "auth_atom_id",    "label_alt_id",
    "label_comp_id",   "auth_comp_id",
    "label_asym_id",   "auth_asym_id",
    "label_entity_id", "label_seq_id",
    "auth_seq_id",     "pdbx_PDB_ins_code",
    "Cartn_x",         "Cartn_y",
    "Cartn_z",         "occupancy",
    "B_iso_or_equiv",  "pdbx_PDB_model_num"};

// Tables beside _atom_site: assemblies for --assembly, entities for selections by their type.
constexpr std::array<std::string_view, 5> kNeededTables{"_pdbx_struct_assembly_gen.",
                                                        "_pdbx_struct_oper_list.", "_entity.",
                                                        "_entity_poly.", "_struct_asym."};

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw FileFormatError(fmt::format("{}: {}", path, what));
}

bool same_letters(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower_case(x) == lower_case(y); });
}

bool is_finite(const Vec3d& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// Throws, and names the coordinate that is at fault. `number` of the row, from 1.
[[noreturn]] void refuse_position(const AtomSiteRow& row, std::size_t number,
                                  const std::string& path) {
  std::size_t axis = 0;
  while (axis < 2 && std::isfinite(row.position[static_cast<int>(axis)])) ++axis;
  refuse(path, fmt::format("row {} of _atom_site (id {}): Cartn_{} is {}, not a finite number",
                           number, row.id.value_or(static_cast<std::int64_t>(number)), "xyz"[axis],
                           in_quotes(row.position_texts[axis])));
}

// Texts of BinaryCIF are the same bytes in all rows with this text.
bool same_text(std::string_view a, std::string_view b) {
  return a.size() == b.size() && (a.data() == b.data() || a == b);
}

// gemmi's element of a symbol. gemmi looks at two letters alone, so longer texts are of none.
gemmi::El element_of(std::string_view symbol) {
  if (symbol.size() > 2) return gemmi::El::X;
  std::array<char, 3> letters{};
  symbol.substr(0, 2).copy(letters.data(), 2);
  return gemmi::find_element(letters.data());
}

// The subchains of each entity. gemmi fills in the table _struct_asym; if the file lacks it, the
// column label_entity_id tells.
void list_subchains(gemmi::Structure& structure) {
  for (const gemmi::Chain& chain : structure.models.front().chains)
    for (const gemmi::Residue& residue : chain.residues)
      if (gemmi::Entity* entity = structure.get_entity(residue.entity_id))
        if (!gemmi::in_vector(residue.subchain, entity->subchains))
          entity->subchains.push_back(residue.subchain);
}

// Gives the residues of each subchain the type of its entity; where the file names none, water, a
// polymer if there are several residues, else a ligand.
void fill_entity_types(gemmi::Structure& structure) {
  for (gemmi::Model& model : structure.models) {
    for (gemmi::Chain& chain : model.chains) {
      for (gemmi::ResidueSpan& part : chain.subchains()) {
        const gemmi::Entity* const entity = structure.get_entity_of(part);
        gemmi::EntityType type = entity ? entity->entity_type : gemmi::EntityType::Unknown;
        if (type == gemmi::EntityType::Unknown) {
          type = part[0].is_water()  ? gemmi::EntityType::Water
                 : part.length() > 1 ? gemmi::EntityType::Polymer
                                     : gemmi::EntityType::NonPolymer;
        }
        for (gemmi::Residue& residue : part) residue.entity_type = type;
      }
    }
  }
}

}  // namespace

std::optional<AtomSiteColumn> atom_site_column(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (same_letters(kNames[i], name)) return static_cast<Column>(i);
  return std::nullopt;
}

bool AtomSiteLayout::any() const {
  return std::any_of(indices.begin(), indices.end(), [](int index) { return index >= 0; });
}

AtomSiteLayout completed_layout(AtomSiteLayout layout, const std::string& path) {
  const auto complete = [&](Column lacking, Column substitute) {
    if (layout[lacking] < 0) layout[lacking] = layout[substitute];
  };
  complete(Column::label_asym_id, Column::auth_asym_id);
  complete(Column::auth_asym_id, Column::label_asym_id);
  complete(Column::auth_seq_id, Column::label_seq_id);
  complete(Column::auth_comp_id, Column::label_comp_id);
  complete(Column::auth_atom_id, Column::label_atom_id);
  const std::array<std::pair<Column, std::string_view>, 7> needed{{
      {Column::label_asym_id, "label_asym_id"},
      {Column::Cartn_x, "Cartn_x"},
      {Column::Cartn_y, "Cartn_y"},
      {Column::Cartn_z, "Cartn_z"},
      {Column::auth_seq_id, "auth_seq_id"},
      {Column::auth_comp_id, "label_comp_id"},
      {Column::auth_atom_id, "label_atom_id"},
  }};
  for (const auto& [column, name] : needed)
    if (layout[column] < 0)
      refuse(path, fmt::format("its _atom_site table lacks the column {}", name));
  return layout;
}

void AtomSiteBuilder::reserve(std::size_t rows) {
  file_.atoms.reserve(rows);
  advise_large_pages(file_.atoms.data(), rows);
}

void AtomSiteBuilder::open_model(const AtomSiteRow& row) {
  const auto found = std::find_if(models_.begin(), models_.end(),
                                  [&row](const gemmi::Model& m) { return m.name == row.model; });
  model_ = found != models_.end() ? &*found : &models_.emplace_back(std::string(row.model));
  chain_ = nullptr;
}

void AtomSiteBuilder::open_chain(const AtomSiteRow& row) {
  chain_ = &model_->chains.emplace_back(std::string(row.chain));
  residue_ = nullptr;
  largest_sequence_ = std::numeric_limits<int>::min();
  chains_.push_back({static_cast<std::size_t>(model_ - models_.data()), residues_});
}

// A number above all others of the chain is that of a new residue. Chains that count up, as nearly
// all do, are therefore never searched, which would take time quadratic in their length.
void AtomSiteBuilder::open_residue(const AtomSiteRow& row) {
  const int number = row.sequence.num.value;
  gemmi::ResidueId id;
  id.seqid = row.sequence;
  id.name = row.residue;
  residue_ = number > largest_sequence_ ? nullptr : chain_->find_residue(id);
  largest_sequence_ = std::max(largest_sequence_, number);
  if (residue_) return;
  ++residues_;
  residue_ = &chain_->residues.emplace_back(id);
  residue_->subchain = row.subchain;
  residue_->entity_id = row.entity;
  const char kind = row.group.empty() ? '\0' : upper_case(row.group.front());
  if (kind == 'A' || kind == 'H') residue_->het_flag = kind;
}

// A symbol of three letters or more is refused unless it is the atom's name: its first two letters
// would be those of another element ("Carbon").
void AtomSiteBuilder::set_element(const AtomSiteRow& row, AtomRecord& record) {
  record.element = row.element != gemmi::El::X ? row.element : symbol_element(row.symbol);
  if (record.element == gemmi::El::X && row.symbol.size() > 2 && is_letter(row.symbol[2]) &&
      is_letter(row.symbol[1]) && !same_letters(row.symbol, row.atom))
    refuse(file_.path, fmt::format("row {} of _atom_site: type_symbol is {}, not the symbol of an "
                                   "element, such as C or ZN",
                                   file_.atoms.size(), in_quotes(row.symbol)));
  if (row.symbol.empty() && is_martini_bead(row.atom, row.residue)) file_.coarse_grained = true;
  if (file_.coarse_grained && row.symbol.empty()) {
    record.element_guessed = true;
    record.element = element_of(element_of_bare_name(row.atom, row.residue));
    return;
  }
  read_element(row.symbol, row.atom, NamePlace::word, row.residue, record);
  file_.elements_in_doubt |= record.element_guessed || record.symbol_overruled ||
                             record.is_other_ion || record.is_virtual ||
                             record.element == gemmi::El::D;
}

void AtomSiteBuilder::add(const AtomSiteRow& row) {
  if (!is_finite(row.position)) refuse_position(row, file_.atoms.size() + 1, file_.path);
  if (!model_ || !same_text(last_.model, row.model)) open_model(row);
  if (!chain_ || !same_text(last_.chain, row.chain)) open_chain(row);
  if (!residue_ || last_.sequence != row.sequence || !same_text(last_.residue, row.residue))
    open_residue(row);
  last_ = {row.model, row.chain, row.residue, row.sequence};
  residue_index_ =
      chains_.back().first_residue + static_cast<std::uint32_t>(residue_ - chain_->residues.data());
  hetero_ = !row.group.empty() && upper_case(row.group.front()) == 'H';
  append(row);
}

void AtomSiteBuilder::add_to_residue(const AtomSiteRow& row) {
  if (!is_finite(row.position)) refuse_position(row, file_.atoms.size() + 1, file_.path);
  append(row);
}

void AtomSiteBuilder::append(const AtomSiteRow& row) {
  AtomRecord& record = file_.atoms.emplace_back();
  record.line = static_cast<std::uint32_t>(file_.atoms.size());
  record.serial = row.id.value_or(record.line);
  record.hetero = hetero_;
  record.position = row.position;
  const Vec3d& p = row.position;
  farthest_ = std::max({farthest_, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  has_labels_ |= row.altloc != '\0';
  record.residue = residue_index_;
  record.name = row.atom;
  record.altloc = row.altloc;
  record.occupancy = row.occupancy;
  record.b_iso = row.b_iso;
  set_element(row, record);
}

gemmi::SeqId AtomSiteBuilder::sequence_id(std::string_view number, std::string_view code) {
  constexpr std::size_t kMostDigits = 9;  // always fit an int, because 2^31 - 1 has ten
  const std::size_t row = file_.atoms.size() + 1;
  gemmi::SeqId id;
  if (code.size() > 1)
    refuse(file_.path, fmt::format("row {} of _atom_site: pdbx_PDB_ins_code is {}, not one "
                                   "character",
                                   row, in_quotes(code)));
  if (!code.empty()) id.icode = code.front();
  if (number.empty()) return id;
  std::string_view digits = number;
  if (digits.back() >= 'A') {
    if (code.empty()) id.icode = digits.back();
    digits.remove_suffix(1);
    if (id.icode != number.back())
      refuse(file_.path,
             fmt::format("row {} of _atom_site: auth_seq_id is {}, but pdbx_PDB_ins_code {}", row,
                         in_quotes(number), in_quotes(code)));
    has_letters_behind_ = true;
  } else if (is_letter(digits.front()) && code.empty()) {
    id.icode = digits.front();
    digits.remove_prefix(1);
    note_letter_in_front(number, row);
  }
  has_letters_behind_ |= !code.empty();
  const std::optional<std::int64_t> value = whole_number(digits);
  if (digits.size() > kMostDigits || !value)
    refuse(file_.path,
           fmt::format("row {} of _atom_site: auth_seq_id is {}, not a whole number of at most "
                       "{} digits",
                       row, in_quotes(number), kMostDigits));
  id.num = static_cast<int>(*value);
  return id;
}

// "A46" becomes "46A", so no other residue may be called so.
void AtomSiteBuilder::note_letter_in_front(std::string_view number, std::size_t row) {
  if (has_letters_in_front_) return;
  has_letters_in_front_ = true;
  file_.warnings.push_back(
      fmt::format("residue numbers have a letter in front, the first in row {} of _atom_site: {}; "
                  "here it stands behind the number, as insertion codes do",
                  row, in_quotes(number)));
}

// Numbers residues in the order of the hierarchy. Those of a chain have consecutive numbers.
void AtomSiteBuilder::number_residues() {
  const auto by_model = [](const ChainPlace& a, const ChainPlace& b) { return a.model < b.model; };
  if (std::is_sorted(chains_.begin(), chains_.end(), by_model)) return;
  std::vector<std::size_t> order(chains_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return by_model(chains_[a], chains_[b]); });
  std::vector<std::uint32_t> number_of(residues_);  // by the number so far
  std::uint32_t next = 0;
  for (const std::size_t chain : order) {
    const std::uint32_t end =
        chain + 1 < chains_.size() ? chains_[chain + 1].first_residue : residues_;
    for (std::uint32_t i = chains_[chain].first_residue; i < end; ++i) number_of[i] = next++;
  }
  for (AtomRecord& atom : file_.atoms) atom.residue = number_of[atom.residue];
}

void AtomSiteBuilder::finish(gemmi::cif::Block& rest) {
  if (file_.atoms.empty())
    refuse(file_.path, "its _atom_site table has no rows, so there is nothing to mesh");
  if (has_letters_in_front_ && has_letters_behind_)
    refuse(
        file_.path,
        "its auth_seq_id has numbers with a letter in front and insertion codes, which cannot be "
        "told apart");
  file_.farthest = farthest_;
  file_.has_labels = has_labels_;
  number_residues();
  file_.assemblies = take_assembly_tables(rest);
  gemmi::Structure& structure = *file_.structure;
  structure = gemmi::make_structure_from_block(rest);
  structure.models = std::move(models_);
  if (!rest.has_tag("_struct_asym.id")) list_subchains(structure);
  fill_entity_types(structure);
}

// gemmi knows no element for a symbol with a charge ("O2-"), and none for tritium.
gemmi::El symbol_element(std::string_view symbol) {
  const gemmi::El element = element_of(symbol);
  if (element != gemmi::El::X || symbol.empty()) return element;
  return element_of(element_of_symbol(symbol));
}

bool is_needed_table(std::string_view prefix) {
  return std::any_of(kNeededTables.begin(), kNeededTables.end(),
                     [prefix](std::string_view table) { return same_letters(table, prefix); });
}

char altloc_of(std::string_view label, std::size_t row, const std::string& path) {
  if (label.size() > 1)
    refuse(path, fmt::format("row {} of _atom_site: label_alt_id is {}, not one character", row,
                             in_quotes(label)));
  return label.empty() ? '\0' : label.front();
}

}  // namespace vdwmesh
