// Reads BinaryCIF files (https://github.com/molstar/BinaryCIF): the tables of an mmCIF file, column
// by column, in MessagePack. Columns are decoded whole. Rows go to the AtomSiteBuilder, as those of
// mmCIF do. Only the columns that are needed are decoded.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <gemmi/cifdoc.hpp>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/cif/atom_site.hpp"
#include "structure/cif/binary_arrays.hpp"
#include "structure/cif/mmcif.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

namespace cif = gemmi::cif;
using Column = AtomSiteColumn;

// Run-length encoding can announce any number of rows in a few bytes, but the positions of atoms
// differ: packed, they take one or two bytes for each coordinate. Tables of more rows than this for
// each byte of the file are therefore refused.
constexpr std::uint64_t kMostRowsPerByte = 16;

// A row of mmCIF has at least so many bytes. Tables with more rows than the limit on text has room
// for are refused, so the same limit on memory holds for both formats.
constexpr std::uint64_t kLeastBytesOfRow = 40;

// A table of the file, in which columns are looked up by name.
struct BinaryTable {
  std::string_view name;  // as "_atom_site"
  std::size_t rows = 0;
  std::vector<std::pair<std::string_view, PackedValue>> columns;
};

class BinaryCifReader {
 public:
  BinaryCifReader(std::string_view bytes, std::uint64_t limit, ParsedFile& file)
      : file_(file),
        nodes_(parse_message_pack(bytes, file.path)),
        most_rows_(std::min(limit / kLeastBytesOfRow, bytes.size() * kMostRowsPerByte)) {}

  void run() {
    cif::Block rest;
    const std::vector<BinaryTable> categories = block_with_atoms();
    for (const BinaryTable& category : categories)
      if (is_needed_table(fmt::format("{}.", category.name))) add_table(category, rest);
    AtomSiteBuilder builder(file_);
    for (const BinaryTable& category : categories)
      if (is_atom_site(category)) add_atoms(category, builder);
    builder.finish(rest);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw FileFormatError(fmt::format("{}: {}", file_.path, what));
  }

  static bool is_atom_site(const BinaryTable& category) {
    return lower_case(category.name) == "_atom_site";
  }

  // The elements of the array under a key of a map.
  std::vector<PackedValue> list(const PackedValue& map, std::string_view key) const {
    const std::optional<PackedValue> value = map.find(key);
    const auto elements = value ? value->elements() : std::nullopt;
    if (!elements) fail(fmt::format("is not BinaryCIF, or damaged: it has no list {}", key));
    return *elements;
  }

  std::string_view name_of(const PackedValue& map, std::string_view key) const {
    const std::optional<PackedValue> value = map.find(key);
    const auto name = value ? value->text() : std::nullopt;
    if (!name) fail(fmt::format("is not BinaryCIF, or damaged: {} is no text", key));
    return *name;
  }

  // The tables of the only data block with an atom table.
  std::vector<BinaryTable> block_with_atoms() const {
    std::optional<std::vector<BinaryTable>> found;
    bool has_component = false;
    std::string_view found_name;
    for (const PackedValue& block : list(PackedValue(nodes_, 0), "dataBlocks")) {
      std::vector<BinaryTable> categories;
      for (const PackedValue& value : list(block, "categories"))
        categories.push_back(category(value));
      has_component |= std::any_of(categories.begin(), categories.end(), [](const BinaryTable& c) {
        return lower_case(c.name) == "_chem_comp_atom";
      });
      const auto tables = std::count_if(categories.begin(), categories.end(), is_atom_site);
      if (tables == 0) continue;
      const std::string_view name = name_of(block, "header");
      if (tables > 1) fail(fmt::format("has {} tables _atom_site in one data block", tables));
      if (found) fail(two_blocks_with_atoms(found_name, name));
      found = std::move(categories);
      found_name = name;
    }
    if (!found && has_component)
      fail("describes a chemical component (_chem_comp_atom), which is read from .cif alone");
    if (!found) fail("has no atom coordinates (no _atom_site table); get the coordinate file");
    return std::move(*found);
  }

  BinaryTable category(const PackedValue& value) const {
    BinaryTable category;
    category.name = name_of(value, "name");
    const std::optional<PackedValue> count = value.find("rowCount");
    const auto rows = count ? count->integer() : std::nullopt;
    if (!rows || *rows < 0)
      fail(fmt::format("rowCount of {} is no number of rows", in_quotes(category.name)));
    category.rows = static_cast<std::size_t>(*rows);
    for (const PackedValue& column : list(value, "columns"))
      category.columns.emplace_back(name_of(column, "name"), column);
    return category;
  }

  // Throws unless a table of that many values can be in a file of this size.
  void check_size(const BinaryTable& category, std::uint64_t rows) const {
    if (rows <= most_rows_) return;
    throw LimitExceeded(fmt::format(
        "{}: table {} claims {} rows, more than fit into the file or the memory allowed (up to {})",
        file_.path, in_quotes(category.name), category.rows, most_rows_));
  }

  BinaryColumn decoded(const BinaryTable& category, std::size_t column) const {
    const auto& [name, value] = category.columns[column];
    const std::string tag = fmt::format("{}.{}", category.name, name);
    return decoded_column(value, category.rows, fmt::format("{}: {}", file_.path, in_quotes(tag)));
  }

  // Adds the table to the block as a loop of CIF values.
  void add_table(const BinaryTable& category, cif::Block& block) const {
    const std::size_t width = category.columns.size();
    if (width == 0) return;
    // Each of `width` columns may be no longer than all of the table.
    check_size(category, category.rows > most_rows_ ? category.rows : category.rows * width);
    cif::Loop& loop = block.items.emplace_back(cif::LoopArg{}).loop;
    loop.values.resize(category.rows * width);
    for (std::size_t i = 0; i < width; ++i) {
      loop.tags.push_back(fmt::format("{}.{}", category.name, category.columns[i].first));
      const BinaryColumn column = decoded(category, i);
      std::string scratch;
      for (std::size_t row = 0; row < category.rows; ++row)
        loop.values[row * width + i] =
            column.is_given(row) ? cif::quote(std::string(column.text(row, scratch))) : "?";
    }
  }

  void add_atoms(const BinaryTable& category, AtomSiteBuilder& builder) {
    check_size(category, category.rows);
    AtomSiteLayout layout;
    for (std::size_t i = 0; i < category.columns.size(); ++i)
      if (const std::optional<Column> column = atom_site_column(category.columns[i].first)) {
        if (layout[*column] >= 0)
          fail(fmt::format("the column {} stands there twice",
                           in_quotes(category.columns[i].first)));
        layout[*column] = static_cast<int>(i);
      }
    decode_columns(category, completed_layout(layout, file_.path));
    builder.reserve(category.rows);
    AtomSiteRow row;  // keeps the place of the row before where rows are of the same residue
    const Flags begins = rows_that_begin(category.rows);
    for (std::size_t i = 0; i < category.rows; ++i) {
      if (begins[i] != 0) read_place(i, row, builder);
      read_atom(i, row);
      if (begins[i] != 0)
        builder.add(row);
      else
        builder.add_to_residue(row);
    }
  }

  using Flags = Buffer<std::uint8_t>;

  // Marks the rows of the table that differ from the row before in what read_place() reads, and its
  // first row. In columns of texts it is enough to compare their numbers, and few rows are marked:
  // most have the residue of the row before. The columns of subchains and entities need no look,
  // for which the first row of a residue decides.
  Flags rows_that_begin(std::size_t rows) const {
    Flags begins(rows, 0);
    if (rows > 0) begins.front() = 1;
    for (const Column of :
         {Column::group_PDB, Column::label_alt_id, Column::auth_comp_id, Column::auth_asym_id,
          Column::auth_seq_id, Column::pdbx_PDB_ins_code, Column::pdbx_PDB_model_num}) {
      if (!column(of)) continue;
      const TextArray* const texts = texts_[static_cast<std::size_t>(of)];
      const Integers* const numbers =
          texts ? &texts->indices : std::get_if<Integers>(&column(of)->values);
      if (numbers)
        mark_changes(*numbers, begins);
      else
        std::fill(begins.begin(), begins.end(), std::uint8_t{1});
      mark_changes(column(of)->mask, begins);
    }
    return begins;
  }

  static void mark_changes(const Integers& numbers, Flags& begins) {
    for (std::size_t i = 1; i < numbers.size(); ++i) begins[i] |= numbers[i] != numbers[i - 1];
  }

  // The names of atoms, and the elements of symbols, by the numbers of their texts.
  void list_names() {
    const auto texts_of = [this](Column of) {
      const TextArray* const array = texts_[static_cast<std::size_t>(of)];
      return array ? array->texts : std::vector<std::string_view>();
    };
    for (const std::string_view name : texts_of(Column::auth_atom_id)) names_.emplace_back(name);
    for (const std::string_view symbol : texts_of(Column::type_symbol))
      elements_.push_back(symbol_element(symbol));
  }

  // The number of a row's text; -1 if it has none or the column has no texts.
  std::int32_t text_number(Column of, std::size_t row) const {
    const TextArray* const array = texts_[static_cast<std::size_t>(of)];
    return array ? array->indices[row] : -1;
  }

  // Whether read() asks for the column. These three only stand in for the author's columns.
  static constexpr bool is_read(Column column) {
    return column != Column::label_atom_id && column != Column::label_comp_id &&
           column != Column::label_seq_id;
  }

  void decode_columns(const BinaryTable& category, const AtomSiteLayout& layout) {
    // A column may stand in for another, and is decoded once.
    std::map<int, const BinaryColumn*> known;
    for (std::size_t i = 0; i < kAtomSiteColumns; ++i) {
      const int index = layout.indices[i];
      if (index < 0 || !is_read(static_cast<Column>(i))) continue;
      const BinaryColumn*& found = known[index];
      if (!found) {
        BinaryColumn& column =
            decoded_.emplace_back(decoded(category, static_cast<std::size_t>(index)));
        if (std::holds_alternative<TextArray>(column.values)) leave_masked(column);
        found = &column;
      }
      columns_[i] = found;
      texts_[i] = std::get_if<TextArray>(&found->values);
      const Reals* const reals = std::get_if<Reals>(&found->values);
      reals_[i] = reals && found->mask.empty() ? reals->data() : nullptr;
    }
    list_names();
  }

  // Lets the rows whose value is not given have no text, so that nobody asks the mask again.
  static void leave_masked(BinaryColumn& column) {
    Integers& indices = std::get<TextArray>(column.values).indices;
    for (std::size_t row = 0; row < column.mask.size(); ++row)
      if (column.mask[row] != 0) indices[row] = -1;
    column.mask.clear();
  }

  const BinaryColumn* column(Column column) const {
    return columns_[static_cast<std::size_t>(column)];
  }
  std::string_view text(Column of, std::size_t row) {
    const TextArray* const texts = texts_[static_cast<std::size_t>(of)];
    if (!texts) return column(of) ? text_of_number(of, row) : std::string_view();
    const std::int32_t index = texts->indices[row];
    return index < 0 ? std::string_view() : texts->texts[static_cast<std::size_t>(index)];
  }
  // The text of a number. That of an integer, as models and entities have them, is made only where
  // the row before has another integer.
  std::string_view text_of_number(Column of, std::size_t row) {
    auto& [last_number, last_text] = last_[static_cast<std::size_t>(of)];
    const std::optional<std::int32_t> number = integer(of, row);
    if (!number || last_number != number) {
      std::string scratch;
      last_text = kept(column(of)->text(row, scratch));
      last_number = number;
    }
    return last_text;
  }
  // The text in memory that lasts as long as the reader.
  std::string_view kept(std::string_view text) {
    return text.empty() ? text : kept_.emplace_back(text);
  }
  double number(Column of, std::size_t row) const {
    const double* const reals = reals_[static_cast<std::size_t>(of)];
    return reals ? reals[row] : column(of)->number(row);
  }
  float number_or(Column of, std::size_t row, float otherwise) const {
    const double found = column(of) ? number(of, row) : std::nan("");
    return std::isnan(found) ? otherwise : static_cast<float>(found);
  }

  // What rows of a residue have in common.
  void read_place(std::size_t index, AtomSiteRow& row, AtomSiteBuilder& builder) {
    row.group = text(Column::group_PDB, index);
    row.residue = text(Column::auth_comp_id, index);
    row.chain = text(Column::auth_asym_id, index);
    row.subchain = text(Column::label_asym_id, index);
    row.entity = text(Column::label_entity_id, index);
    row.model = column(Column::pdbx_PDB_model_num) ? text(Column::pdbx_PDB_model_num, index) : "1";
    row.altloc = altloc_of(text(Column::label_alt_id, index), index + 1, file_.path);
    row.sequence = sequence(index, builder);
  }

  void read_atom(std::size_t index, AtomSiteRow& row) {
    const std::int32_t symbol = text_number(Column::type_symbol, index);
    row.symbol = text(Column::type_symbol, index);
    row.element = symbol < 0 ? gemmi::El::X : elements_[static_cast<std::size_t>(symbol)];
    const std::int32_t name = text_number(Column::auth_atom_id, index);
    row.atom = name < 0 ? ShortText(text(Column::auth_atom_id, index))
                        : names_[static_cast<std::size_t>(name)];
    row.id = id(index);
    row.position = {number(Column::Cartn_x, index), number(Column::Cartn_y, index),
                    number(Column::Cartn_z, index)};
    row.occupancy = number_or(Column::occupancy, index, kOccupancy);
    row.b_iso = number_or(Column::B_iso_or_equiv, index, kIsotropicFactor);
  }

  // The integer of a row in a column of integers; nothing in any other column.
  std::optional<std::int32_t> integer(Column of, std::size_t row) const {
    const BinaryColumn* const found = column(of);
    const Integers* const values = found ? std::get_if<Integers>(&found->values) : nullptr;
    if (!values || !found->is_given(row)) return std::nullopt;
    return (*values)[row];
  }

  std::optional<std::int64_t> id(std::size_t row) {
    if (const std::optional<std::int32_t> number = integer(Column::id, row)) return *number;
    return whole_number(text(Column::id, row));
  }

  gemmi::SeqId sequence(std::size_t row, AtomSiteBuilder& builder) {
    const std::string_view code = text(Column::pdbx_PDB_ins_code, row);
    const std::optional<std::int32_t> number = integer(Column::auth_seq_id, row);
    if (!number) return builder.sequence_id(text(Column::auth_seq_id, row), code);
    gemmi::SeqId id = builder.sequence_id({}, code);
    id.num = *number;
    return id;
  }

  ParsedFile& file_;
  std::vector<PackedNode> nodes_;
  std::uint64_t most_rows_;
  std::deque<BinaryColumn> decoded_;                             // those that are read
  std::array<const BinaryColumn*, kAtomSiteColumns> columns_{};  // nullptr: not there
  std::array<const TextArray*, kAtomSiteColumns> texts_{};       // of those that hold texts
  std::array<const double*, kAtomSiteColumns> reals_{};  // of those that hold reals, all given
  // The integer of the row before, and its text.
  std::array<std::pair<std::optional<std::int32_t>, std::string_view>, kAtomSiteColumns> last_;
  std::deque<std::string> kept_;
  std::vector<ShortText> names_;     // by the number of the text, as elements_
  std::vector<gemmi::El> elements_;  // X: of no element
};

}  // namespace

ParsedFile parse_binary_cif(std::string_view bytes, const std::string& path, std::uint64_t limit) {
  return parse_with_gemmi(path, [&](ParsedFile& file) {
    file.format = "bcif";
    BinaryCifReader(bytes, limit, file).run();
  });
}

}  // namespace vdwmesh
