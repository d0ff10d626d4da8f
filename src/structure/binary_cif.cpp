// Reads BinaryCIF files (https://github.com/molstar/BinaryCIF): the tables of an mmCIF file, column
// by column, in MessagePack. Rows go to the AtomSiteBuilder, as those of mmCIF do. Only the columns
// that are needed are decoded.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <gemmi/cifdoc.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/atom_site.hpp"
#include "structure/binary_arrays.hpp"
#include "structure/lines.hpp"
#include "structure/mmcif.hpp"

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
struct Category {
  std::string_view name;  // as "_atom_site"
  std::size_t rows = 0;
  std::vector<std::pair<std::string_view, PackedValue>> columns;
};

class Reader {
 public:
  Reader(std::string_view bytes, std::uint64_t limit, ParsedFile& file)
      : file_(file),
        nodes_(parse_message_pack(bytes, file.path)),
        most_rows_(std::min(limit / kLeastBytesOfRow, bytes.size() * kMostRowsPerByte)) {}

  void run() {
    cif::Block rest;
    const std::vector<Category> categories = block_with_atoms();
    for (const Category& category : categories)
      if (is_needed_table(fmt::format("{}.", category.name))) add_table(category, rest);
    AtomSiteBuilder builder(file_);
    for (const Category& category : categories)
      if (is_atom_site(category)) add_atoms(category, builder);
    builder.finish(rest);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw FileFormatError(fmt::format("{}: {}", file_.path, what));
  }

  static bool is_atom_site(const Category& category) {
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
  std::vector<Category> block_with_atoms() const {
    std::optional<std::vector<Category>> found;
    std::string_view found_name;
    for (const PackedValue& block : list(PackedValue(nodes_, 0), "dataBlocks")) {
      std::vector<Category> categories;
      for (const PackedValue& value : list(block, "categories"))
        categories.push_back(category(value));
      const auto tables = std::count_if(categories.begin(), categories.end(), is_atom_site);
      if (tables == 0) continue;
      const std::string_view name = name_of(block, "header");
      if (tables > 1) fail(fmt::format("has {} tables _atom_site in one data block", tables));
      if (found) fail(two_blocks_with_atoms(found_name, name));
      found = std::move(categories);
      found_name = name;
    }
    if (!found) fail("has no atom coordinates (no _atom_site table); get the coordinate file");
    return std::move(*found);
  }

  Category category(const PackedValue& value) const {
    Category category;
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
  void check_size(const Category& category, std::uint64_t rows) const {
    if (rows <= most_rows_) return;
    throw LimitExceeded(fmt::format(
        "{}: table {} claims {} rows, more than fit into the file or the memory allowed (up to {})",
        file_.path, in_quotes(category.name), category.rows, most_rows_));
  }

  BinaryColumn decode(const Category& category, std::size_t column) const {
    const auto& [name, value] = category.columns[column];
    const std::string tag = fmt::format("{}.{}", category.name, name);
    return decode_column(value, category.rows, fmt::format("{}: {}", file_.path, in_quotes(tag)));
  }

  // Adds the table to the block as a loop of CIF values.
  void add_table(const Category& category, cif::Block& block) const {
    const std::size_t width = category.columns.size();
    if (width == 0) return;
    // Each of `width` columns may be no longer than all of the table.
    check_size(category, category.rows > most_rows_ ? category.rows : category.rows * width);
    cif::Loop& loop = block.items.emplace_back(cif::LoopArg{}).loop;
    loop.values.resize(category.rows * width);
    for (std::size_t i = 0; i < width; ++i) {
      loop.tags.push_back(fmt::format("{}.{}", category.name, category.columns[i].first));
      const BinaryColumn column = decode(category, i);
      std::string scratch;
      for (std::size_t row = 0; row < category.rows; ++row)
        loop.values[row * width + i] =
            column.is_given(row) ? cif::quote(std::string(column.text(row, scratch))) : "?";
    }
  }

  void add_atoms(const Category& category, AtomSiteBuilder& builder) {
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
    for (std::size_t row = 0; row < category.rows; ++row) builder.add(read(row));
  }

  // Whether read() asks for the column. These three only stand in for the author's columns.
  static constexpr bool is_read(Column column) {
    return column != Column::label_atom_id && column != Column::label_comp_id &&
           column != Column::label_seq_id;
  }

  void decode_columns(const Category& category, const AtomSiteLayout& layout) {
    decoded_.resize(category.columns.size());
    for (std::size_t i = 0; i < kAtomSiteColumns; ++i) {
      const int index = layout.indices[i];
      if (index < 0 || !is_read(static_cast<Column>(i))) continue;
      BinaryColumn& column = decoded_[static_cast<std::size_t>(index)];
      if (column.size() != category.rows)
        column = decode(category, static_cast<std::size_t>(index));
      columns_[i] = &column;
      texts_[i] = std::get_if<TextArray>(&column.values);
      if (texts_[i]) leave_masked(column);
      const Reals* const reals = std::get_if<Reals>(&column.values);
      reals_[i] = reals && column.mask.empty() ? reals->data() : nullptr;
    }
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
    LastText& last = last_[static_cast<std::size_t>(of)];
    const std::optional<std::int32_t> number = integer(of, row);
    if (!number || last.number != number) {
      std::string scratch;
      last = {number, kept(column(of)->text(row, scratch))};
    }
    return last.text;
  }
  // The text in memory that lasts as long as the file.
  std::string_view kept(std::string_view text) {
    return text.empty() ? text : file_.texts.emplace_back(text);
  }
  double number(Column of, std::size_t row) const {
    const double* const reals = reals_[static_cast<std::size_t>(of)];
    return reals ? reals[row] : column(of)->number(row);
  }
  float number_or(Column of, std::size_t row, float otherwise) const {
    const double found = column(of) ? number(of, row) : std::nan("");
    return std::isnan(found) ? otherwise : static_cast<float>(found);
  }

  AtomSiteRow read(std::size_t index) {
    AtomSiteRow row;
    row.group = text(Column::group_PDB, index);
    row.symbol = text(Column::type_symbol, index);
    row.atom = text(Column::auth_atom_id, index);
    row.residue = text(Column::auth_comp_id, index);
    row.chain = text(Column::auth_asym_id, index);
    row.subchain = text(Column::label_asym_id, index);
    row.entity = text(Column::label_entity_id, index);
    row.model = column(Column::pdbx_PDB_model_num) ? text(Column::pdbx_PDB_model_num, index) : "1";
    row.id = id(index);
    row.altloc = altloc_of(text(Column::label_alt_id, index), index + 1, file_.path);
    row.sequence = sequence(index);
    row.position = {number(Column::Cartn_x, index), number(Column::Cartn_y, index),
                    number(Column::Cartn_z, index)};
    row.occupancy = number_or(Column::occupancy, index, row.occupancy);
    row.b_iso = number_or(Column::B_iso_or_equiv, index, row.b_iso);
    return row;
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

  gemmi::SeqId sequence(std::size_t row) {
    const std::string_view code = text(Column::pdbx_PDB_ins_code, row);
    const std::optional<std::int32_t> number = integer(Column::auth_seq_id, row);
    if (!number) return sequence_id(text(Column::auth_seq_id, row), code, row + 1, file_.path);
    gemmi::SeqId id = sequence_id({}, code, row + 1, file_.path);
    id.num = *number;
    return id;
  }

  ParsedFile& file_;
  std::vector<PackedNode> nodes_;
  std::uint64_t most_rows_;
  std::vector<BinaryColumn> decoded_;                            // by index in the table
  std::array<const BinaryColumn*, kAtomSiteColumns> columns_{};  // nullptr: not there
  std::array<const TextArray*, kAtomSiteColumns> texts_{};       // of those that hold texts
  std::array<const double*, kAtomSiteColumns> reals_{};  // of those that hold reals, all given
  struct LastText {
    std::optional<std::int32_t> number;
    std::string_view text;
  };
  std::array<LastText, kAtomSiteColumns> last_;
};

}  // namespace

ParsedFile parse_binary_cif(std::string_view bytes, const std::string& path, std::uint64_t limit) {
  return parse_with_gemmi(path, [&](ParsedFile& file) {
    file.format = "bcif";
    Reader(bytes, limit, file).run();
  });
}

}  // namespace vdwmesh
