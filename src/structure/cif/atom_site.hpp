// Builds the structure of a ParsedFile from the rows of the table _atom_site, which mmCIF and
// BinaryCIF files share. Each reader turns its rows into AtomSiteRows and hands them over one after
// the other, so no copy of the table is kept. What the formats have in common is decided here:
// which columns stand in for missing ones, what is refused, and how rows become chains and
// residues. Internal header of this folder.
#pragma once

#include <array>
#include <cstdint>
#include <gemmi/model.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "structure/read/parsed_file.hpp"

namespace gemmi::cif {
struct Block;
struct Item;
}  // namespace gemmi::cif

namespace vdwmesh {

// The columns that are read. Files may have others, in any order.
enum class AtomSiteColumn : std::uint8_t {
  group_PDB,
  id,
  type_symbol,
  label_atom_id,
  auth_atom_id,
  label_alt_id,
  label_comp_id,
  auth_comp_id,
  label_asym_id,
  auth_asym_id,
  label_entity_id,
  label_seq_id,
  auth_seq_id,
  pdbx_PDB_ins_code,
  Cartn_x,
  Cartn_y,
  Cartn_z,
  occupancy,
  B_iso_or_equiv,
  pdbx_PDB_model_num,
};
inline constexpr std::size_t kAtomSiteColumns = 20;

// The column of that name, without "_atom_site.", in any case. Nothing if it is not read.
std::optional<AtomSiteColumn> atom_site_column(std::string_view name);

// For each column its index in the table of the file; -1 if the table lacks it.
struct AtomSiteLayout {
  AtomSiteLayout() { indices.fill(-1); }
  int& operator[](AtomSiteColumn column) { return indices[static_cast<std::size_t>(column)]; }
  int operator[](AtomSiteColumn column) const { return indices[static_cast<std::size_t>(column)]; }
  // Whether the table has any of the columns.
  bool any() const;

  std::array<int, kAtomSiteColumns> indices;
};

// Lets columns stand in for others that the table lacks, so that afterwards label_asym_id and the
// author's columns (auth_...) name chains, residues and atoms. Throws FileFormatError if the table
// lacks coordinates, chains, residue numbers, or the names of residues or atoms.
AtomSiteLayout completed_layout(AtomSiteLayout layout, const std::string& path);

// The values of rows in which they are not given: those that gemmi takes for mmCIF.
inline constexpr float kOccupancy = 1, kIsotropicFactor = 50;  // the latter in Å²

// One row. Texts are without quotes, and empty for a value that is not given; they must last as
// long as the AtomSiteBuilder. Chain, residue and atom are named as the author named them.
struct AtomSiteRow {
  std::string_view group, symbol, residue, chain, subchain, entity, model;
  ShortText atom;
  // symbol_element(symbol) if the reader has looked it up. If it is X, add() looks it up.
  gemmi::El element = gemmi::El::X;
  std::optional<std::int64_t> id;  // nothing: not given, or no integer
  char altloc = '\0';              // '\0': none
  gemmi::SeqId sequence;           // the residue's number and insertion code
  Vec3d position{};                // Å; NaN where the value is no number
  float occupancy = kOccupancy, b_iso = kIsotropicFactor;
  std::array<std::string_view, 3> position_texts;  // as they stand in the file, for messages
};

// Adds rows to `file`, whose path must be set, and which must outlast the builder.
class AtomSiteBuilder {
 public:
  explicit AtomSiteBuilder(ParsedFile& file) : file_(file) {}

  // The residue's number and insertion code, of the row to be added next, as gemmi has them. Old
  // files write both into the column auth_seq_id ("15A"); some write the letter in front, which is
  // told in a warning. Throws FileFormatError, with the row from 1, if the number is not an integer
  // of at most nine digits or the code not one character.
  gemmi::SeqId sequence_id(std::string_view number, std::string_view code);

  // Makes room for that many rows, which may be fewer than there are.
  void reserve(std::size_t rows);

  // Adds one row. Throws FileFormatError if its position is not finite.
  void add(const AtomSiteRow& row);
  // The same for a row with model, chain, residue, sequence and group of the row before.
  void add_to_residue(const AtomSiteRow& row);

  // Call once, after the last row: completes file.structure and file.assemblies by the tables in
  // `rest`, of which only those that is_needed_table() names are used. Throws FileFormatError if
  // there were no rows.
  void finish(gemmi::cif::Block& rest);

 private:
  // What decides whether a row is of the same residue as the one before.
  struct RowPlace {
    std::string_view model, chain, residue;
    gemmi::SeqId sequence;
  };
  struct ChainPlace {
    std::size_t model;            // index in models_
    std::uint32_t first_residue;  // how many residues were opened before its first one
  };
  void open_model(const AtomSiteRow& row);
  void open_chain(const AtomSiteRow& row);
  void open_residue(const AtomSiteRow& row);
  void append(const AtomSiteRow& row);
  void set_element(const AtomSiteRow& row, AtomRecord& record);
  void number_residues();
  void note_letter_in_front(std::string_view number, std::size_t row);

  ParsedFile& file_;
  std::vector<gemmi::Model> models_;
  std::vector<ChainPlace> chains_;  // in the order in which they were opened
  std::uint32_t residues_ = 0;      // opened so far
  RowPlace last_;
  gemmi::Model* model_ = nullptr;  // of the last row, as chain_ and residue_
  gemmi::Chain* chain_ = nullptr;
  gemmi::Residue* residue_ = nullptr;
  std::uint32_t residue_index_ = 0;  // of residue_, among all that were opened
  bool hetero_ = false;              // of the last row
  int largest_sequence_ = 0;         // the largest sequence number in chain_
  double farthest_ = 0;              // as in ParsedFile, of the rows so far; so is has_labels_
  bool has_labels_ = false;
  bool has_letters_in_front_ = false, has_letters_behind_ = false;  // of residue numbers
};

// The element of a symbol; X if the symbol is empty or of no element.
gemmi::El symbol_element(std::string_view symbol);

// Whether finish() needs the table whose tags begin with `prefix`, as "_entity.".
bool is_needed_table(std::string_view prefix);

// The label of an alternate location: '\0' for an empty text. Throws FileFormatError, with the row
// from 1, if it has more than one character.
char altloc_of(std::string_view label, std::size_t row, const std::string& path);

}  // namespace vdwmesh
