// Reads mmCIF files of macromolecules. The tokens of the text go by once: rows of the table
// _atom_site are handed to the AtomSiteBuilder as they come, the few other tables that are needed
// are kept in a block of gemmi's, and everything else is only checked for its syntax.
//
// CIF files of small molecules are recognised by their tags: mmCIF writes _atom_site.id with
// Cartesian coordinates, CIF of small molecules writes _atom_site_label with fractional ones.
#include "structure/cif/mmcif.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <gemmi/cifdoc.hpp>
#include <memory>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/cif/atom_site.hpp"
#include "structure/cif/cif_tokens.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

namespace cif = gemmi::cif;
using Column = AtomSiteColumn;

constexpr std::string_view kAtoms = "_atom_site.";
constexpr std::string_view kFractions = "_atom_site_fract_x";

// The table of a tag: "_entity." of "_entity.id". The whole tag if it has no dot.
std::string_view table_of(std::string_view tag) { return tag.substr(0, tag.find('.') + 1); }

// One row of the atom table: its values, and which of them is of which column.
class AtomSiteTokens {
 public:
  AtomSiteTokens(const AtomSiteLayout& layout, const std::vector<std::string_view>& values)
      : layout_(layout), values_(values) {}

  // The row for the builder. `number` is that of the row from 1, for messages.
  AtomSiteRow read(std::size_t number, const std::string& path, AtomSiteBuilder& builder) const {
    AtomSiteRow row;
    row.group = text(Column::group_PDB);
    row.symbol = text(Column::type_symbol);
    row.atom = text(Column::auth_atom_id);
    row.residue = text(Column::auth_comp_id);
    row.chain = text(Column::auth_asym_id);
    row.subchain = text(Column::label_asym_id);
    row.entity = text(Column::label_entity_id);
    row.model = layout_[Column::pdbx_PDB_model_num] < 0 ? "1" : text(Column::pdbx_PDB_model_num);
    row.id = whole_number(text(Column::id));
    row.altloc = altloc_of(text(Column::label_alt_id), number, path);
    row.sequence = builder.sequence_id(text(Column::auth_seq_id), text(Column::pdbx_PDB_ins_code));
    row.position_texts = {raw(Column::Cartn_x), raw(Column::Cartn_y), raw(Column::Cartn_z)};
    row.position = {cif_number(row.position_texts[0]), cif_number(row.position_texts[1]),
                    cif_number(row.position_texts[2])};
    row.occupancy = number_or(Column::occupancy, row.occupancy);
    row.b_iso = number_or(Column::B_iso_or_equiv, row.b_iso);
    return row;
  }

 private:
  // The value as it stands in the file; empty if the table lacks the column.
  std::string_view raw(Column column) const {
    return layout_[column] < 0 ? std::string_view()
                               : values_[static_cast<std::size_t>(layout_[column])];
  }
  std::string_view text(Column column) const { return cif_text(raw(column)); }
  float number_or(Column column, float otherwise) const {
    const double number = cif_number(raw(column));
    return number == number ? static_cast<float>(number) : otherwise;
  }

  const AtomSiteLayout& layout_;
  const std::vector<std::string_view>& values_;
};

// Reads one file: construct, then call run() once.
class MmcifReader {
 public:
  MmcifReader(std::string_view text, ParsedFile& file, Monitor* monitor)
      : tokens_(text, file.path), file_(file), monitor_(monitor), builder_(file) {}

  // Returns false, and leaves the file as it is, if it is of a small molecule or a component.
  bool run() {
    token_ = tokens_.next();
    while (token_.kind != CifKind::end) {
      take_item();
      if (small_molecule_) return false;
    }
    if (!has_atoms_ && component_) return false;
    if (!has_atoms_)
      throw FileFormatError(
          fmt::format("{}: has no atom coordinates (no _atom_site table); get the coordinate file",
                      file_.path));
    take_single_row();
    builder_.finish(block_);
    return true;
  }

 private:
  void take_item() {
    switch (token_.kind) {
      case CifKind::data:
        return open_block();
      case CifKind::save:  // "save_NAME" opens a frame, and "save_" closes it
        in_frame_ = token_.text.size() > 5;
        return advance();
      case CifKind::loop:
        return take_loop();
      case CifKind::tag:
        return take_pair();
      default:
        tokens_.fail(fmt::format("the value {} stands where a name or a loop is expected",
                                 in_quotes(token_.text)));
    }
  }

  void advance() { token_ = tokens_.next(); }

  // Tables are kept of the block that holds the atoms alone.
  void open_block() {
    in_frame_ = false;
    name_ = token_.text.substr(5);
    if (!has_atoms_) block_ = cif::Block(std::string(name_));
    advance();
  }

  bool is_needed(std::string_view tag) const {
    return !in_frame_ && (!has_atoms_ || name_ == atoms_name_) && is_needed_table(table_of(tag));
  }
  bool is_of_atoms(std::string_view tag) const {
    return !in_frame_ && lower_case(table_of(tag)) == kAtoms;
  }
  // Notes a tag with fractional coordinates, and one of the atoms of a chemical component.
  void look_at(std::string_view tag) {
    component_ = component_ || lower_case(table_of(tag)) == "_chem_comp_atom.";
    if (!in_frame_ && lower_case(tag) == kFractions) small_molecule_ = true;
  }

  // The table may stand in one block, and there in one place.
  void note_atoms() {
    if (has_atoms_ && name_ != atoms_name_)
      throw FileFormatError(
          fmt::format("{}: {}", file_.path, two_blocks_with_atoms(atoms_name_, name_)));
    has_atoms_ = true;
    atoms_name_ = name_;
  }

  void add_column(AtomSiteLayout& layout, std::string_view tag, std::size_t index) {
    const std::optional<Column> column = atom_site_column(tag.substr(kAtoms.size()));
    if (!column) return;
    if (layout[*column] >= 0) tokens_.fail(fmt::format("the column {} stands there twice", tag));
    layout[*column] = static_cast<int>(index);
  }

  // An item without a loop: a name and its value.
  void take_pair() {
    const std::string_view tag = token_.text;
    look_at(tag);
    advance();
    if (token_.kind != CifKind::value) tokens_.fail(fmt::format("{} has no value", tag));
    if (is_of_atoms(tag)) {
      note_atoms();
      add_column(single_, tag, single_values_.size());
      single_values_.push_back(token_.text);
    } else if (is_needed(tag)) {
      block_.items.emplace_back(std::string(tag), std::string(token_.text));
    }
    advance();
  }

  void take_loop() {
    advance();
    std::vector<std::string_view> tags;
    for (; token_.kind == CifKind::tag; advance()) {
      look_at(token_.text);
      tags.push_back(token_.text);
    }
    if (tags.empty()) tokens_.fail("a loop without names");
    if (std::any_of(tags.begin(), tags.end(), [this](auto tag) { return is_of_atoms(tag); }))
      return take_atoms(tags);
    cif::Loop* kept = nullptr;
    if (is_needed(tags.front())) {
      kept = &block_.items.emplace_back(cif::LoopArg{}).loop;
      kept->tags.assign(tags.begin(), tags.end());
    }
    std::size_t count = 0;
    for (; token_.kind == CifKind::value; advance(), ++count)
      if (kept) kept->values.emplace_back(token_.text);
    check_rows(tags, count);
  }

  void check_rows(const std::vector<std::string_view>& tags, std::size_t values) const {
    if (values % tags.size() != 0)
      tokens_.fail(fmt::format("{} values in the loop of {}, not a multiple of its {} columns",
                               values, tags.front(), tags.size()));
  }

  void take_atoms(const std::vector<std::string_view>& tags) {
    note_atoms();
    AtomSiteLayout layout;
    for (std::size_t i = 0; i < tags.size(); ++i)
      if (is_of_atoms(tags[i])) add_column(layout, tags[i], i);
    ++parts_;
    refuse_parts();
    if (layout[Column::Cartn_x] < 0) incomplete_ = layout;
    check_rows(tags, incomplete_ ? skip_values() : take_rows(layout, tags.size()));
  }

  // Throws if the columns stand in several loops, because nothing tells which of their rows belong
  // together.
  void refuse_parts() const {
    if (parts_ + (single_values_.empty() ? 0 : 1) > 1)
      throw FileFormatError(fmt::format(
          "{}: the columns of its _atom_site table must stand in one loop, and stand in several",
          file_.path));
  }

  // Both return the number of values in the loop.
  std::size_t skip_values() {
    std::size_t count = 0;
    for (; token_.kind == CifKind::value; advance()) ++count;
    return count;
  }

  std::size_t take_rows(const AtomSiteLayout& found, std::size_t width) {
    const AtomSiteLayout layout = completed_layout(found, file_.path);
    std::vector<std::string_view> values(width);
    const AtomSiteTokens row(layout, values);
    std::size_t count = 0, column = 0;
    CifToken token = token_;  // in registers
    for (; token.kind == CifKind::value; token = tokens_.next(), ++count) {
      values[column] = token.text;
      if (++column < width) continue;
      column = 0;
      if (file_.atoms.size() % kLinesPerCheck == 0) vdwmesh::advance(monitor_, 0);
      builder_.add(row.read(file_.atoms.size() + 1, file_.path, builder_));
    }
    token_ = token;
    return count;
  }

  // A table of one row may be written without a loop.
  void take_single_row() {
    refuse_parts();
    if (incomplete_) completed_layout(*incomplete_, file_.path);
    if (single_values_.empty()) return;
    const AtomSiteLayout layout = completed_layout(single_, file_.path);
    builder_.add(AtomSiteTokens(layout, single_values_).read(1, file_.path, builder_));
  }

  CifTokens tokens_;
  CifToken token_;  // the one to be looked at next
  ParsedFile& file_;
  Monitor* const monitor_;
  AtomSiteBuilder builder_;
  cif::Block block_;             // the tables that are needed beside _atom_site
  std::string_view name_;        // of the current data block
  std::string_view atoms_name_;  // of the block that holds atoms
  bool in_frame_ = false;
  bool has_atoms_ = false;  // atoms_name_ is known
  bool small_molecule_ = false, component_ = false;
  int parts_ = 0;                             // loops of _atom_site so far
  std::optional<AtomSiteLayout> incomplete_;  // of a loop without coordinates
  AtomSiteLayout single_;                     // columns without a loop
  std::vector<std::string_view> single_values_;
};

}  // namespace

std::string two_blocks_with_atoms(std::string_view first, std::string_view second) {
  return fmt::format("holds atoms in two data blocks, {} and {}; keep one of them", first, second);
}

ParsedFile parse_with_gemmi(const std::string& path, const std::function<void(ParsedFile&)>& read) {
  ParsedFile file;
  file.path = path;
  file.structure = std::make_shared<gemmi::Structure>();
  try {
    read(file);
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

ParsedFile parse_mmcif(std::string_view text, const std::string& path, Monitor* monitor) {
  return parse_with_gemmi(path, [text, monitor](ParsedFile& file) {
    // Files of old Macintoshes have CR alone for line ends, which become LF here.
    const bool lone_cr = text.find('\n') == text.npos && text.find('\r') != text.npos;
    std::string lines(lone_cr ? text : std::string_view());
    std::replace(lines.begin(), lines.end(), '\r', '\n');
    const std::string_view read = lone_cr ? std::string_view(lines) : text;
    file.format = "mmcif";
    if (!MmcifReader(read, file, monitor).run()) read_small_molecule(read, file);
  });
}

}  // namespace vdwmesh
