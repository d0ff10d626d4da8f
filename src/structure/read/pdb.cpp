// Reads PDB files record by record.
//
// Real files do not follow the format strictly: old files carry entry ids in columns 73-80,
// simulation programs leave out elements, models have no end, serial numbers pass 99,999. Therefore
// layout_of() scans the file once and finds out how it uses the disputed columns, before PdbReader
// reads it with messages that name the line.
//
// Models, chains and residues are those that gemmi makes of PDB files: a change of the chain's name
// begins a chain, a residue is looked for among those of the chain before it is added, and TER ends
// a polymer.
// REMARK 350 (assemblies) goes to BiomoleculeReader.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <gemmi/model.hpp>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "core/read_double.hpp"
#include "structure/molecule/elements.hpp"
#include "structure/molecule/residue_elements.hpp"
#include "structure/molecule/standard_names.hpp"
#include "structure/read/biomolecules.hpp"
#include "structure/read/lines.hpp"
#include "structure/read/parsed_file.hpp"
#include "structure/read/pdb_records.hpp"

namespace vdwmesh {
namespace {

// The format has four columns for the number of a model.
constexpr std::size_t kMaxModels = 9999;
// Columns count from 0, while the manual of the format counts them from 1.
constexpr std::size_t kFourthLetter = 20;   // of a residue name, or blank
constexpr std::size_t kTagColumn = 72;      // entry tag or segment id
constexpr std::size_t kChargeColumn = 70;   // of PDBQT
constexpr std::size_t kElementColumn = 76;  // two columns, right-aligned
constexpr std::size_t kLastColumn = 78;     // end of the element; the charge behind it is not used
// Whether the eight characters from column 73 on are the entry tag of files from before 1996: the
// entry id, possibly a revision letter, and the line number ("4PTI  75", "4INSB 12", "1ABC1234").
bool is_entry_tag(std::string_view tag) {
  if (tag.size() < 8 || !is_digit(tag[0]) || !is_digit(tag[7])) return false;
  const auto id = tag.substr(1, 3), number = tag.substr(5, 3);
  return std::all_of(id.begin(), id.end(), [](char c) { return is_digit(c) || is_letter(c); }) &&
         std::all_of(number.begin(), number.end(), [](char c) { return is_digit(c) || c == ' '; });
}

// How the file uses the columns on which programs disagree.
struct PdbLayout {
  bool entry_tags = false;       // columns 73-80 hold entry tags, so there is no element in them
  bool names_at_left = false;    // atom names begin in column 13 even if the element has one letter
  bool pdbqt = false;            // AutoDock's: a charge in columns 71-76, the atom type from 78 on
  bool beads = false;            // the atoms are beads of a coarse-grained (Martini) model
  bool wide_names = false;       // residue names may have four letters, to column 21
  bool is_name_guessed = false;  // that they do is a guess: nothing in the file tells
};

// Whether the name, without blanks, is C, N, O or P with nothing but digits behind it.
bool is_short_name(std::string_view name) {
  return !name.empty() && std::string_view("CNOP").find(name[0]) != std::string_view::npos &&
         std::all_of(name.begin() + 1, name.end(), is_digit);
}

// Whether columns 71-76 hold a number with three digits behind its point.
bool has_charge(std::string_view line) {
  const std::string_view charge = columns(line, kChargeColumn, 6);
  return charge.size() == 6 && charge[2] == '.' && finite_number(charge);
}

// Whether column 21, which has no use in the format, holds the fourth letter of a residue name
// ("POPE" and "NALA" of CHARMM and AMBER), rather than the first of a chain id of two. Positive for
// a name, negative for a chain id, 0 if the line alone cannot tell.
int vote_for_wide_names(std::string_view line) {
  const std::string_view four = columns(line, 17, 4), three = columns(line, 17, 3);
  const std::string name = upper_case(trimmed(four)), shorter = upper_case(trimmed(three));
  const auto is_known = [](const std::string& residue) {
    return is_standard_residue(residue) || standard_residue_name(residue) == "HOH" ||
           residue == "HOH";
  };
  if (is_known(name) && is_known(shorter)) return 0;  // "HISA" of GROMOS, or HIS of a chain "AA"
  if (is_known(name)) return 1;
  // "LYSN" of GROMOS without a chain, or the chain of LYS in the wrong column.
  if (columns(line, kFourthLetter + 1, 1) == " ") return is_known(shorter) ? 0 : 1;
  if (is_known(shorter) || four[0] == ' ' || three.find(' ') != std::string_view::npos) return -1;
  return 1;
}

// Looks at all atom records of the file. Single records are ambiguous, so the majority decides:
// names are at the left if more names such as N, C1, O or P begin in column 13 than in column 14,
// where the format puts elements of one letter. Entry tags must show one and the same entry id in
// more than half of the atoms; a single match could be chance. One bead is enough for `beads`,
// because no real atom has the name of a bead.
PdbLayout layout_of(std::string_view text) {
  PdbLayout layout;
  std::size_t atoms = 0, aligned = 0, at_left = 0, charges = 0;
  std::int64_t wide = 0;                           // votes for wide names, less those against them
  bool in_use = false;                             // whether column 21 holds anything
  std::map<std::string_view, std::size_t> tagged;  // atoms with an entry tag, by entry id
  std::string_view line;
  while (next_line(text, line)) {
    if (!is_atom_record(line)) continue;
    ++atoms;
    const std::string_view tag = columns(line, kTagColumn, 8), name = columns(line, 12, 4);
    if (line.size() > kFourthLetter && line[kFourthLetter] != ' ') {
      wide += vote_for_wide_names(line);
      in_use = true;
    }
    if (is_entry_tag(tag)) ++tagged[tag.substr(0, 4)];
    layout.beads = layout.beads || is_martini_bead(name, columns(line, 17, 3));
    if (is_short_name(trimmed(name)) && name.size() == 4) ++(name[0] != ' ' ? at_left : aligned);
    charges += has_charge(line) ? 1 : 0;
  }
  layout.pdbqt = 2 * charges > atoms;
  layout.names_at_left = at_left > aligned;
  layout.is_name_guessed = wide == 0 && in_use;
  layout.wide_names = wide > 0 || layout.is_name_guessed;
  layout.entry_tags = std::any_of(tagged.begin(), tagged.end(),
                                  [atoms](const auto& entry) { return 2 * entry.second > atoms; });
  return layout;
}

// Reads a serial number in hybrid-36 (R. W. Grosse-Kunstleve, cci.lbl.gov/hybrid_36), which extends
// five decimal columns: 0 to 99999 as usual, then A0000 to ZZZZZ and a0000 to zzzzz in base 36. The
// letters continue the count, so A0000 is 100,000 and a0000 is 100,000 + 26 * 36^4.
std::optional<std::int64_t> serial_number(std::string_view field) {
  const std::string_view digits = trimmed(field);
  if (digits.size() == 5 && is_letter(digits[0])) {
    // What to add to the value in base 36. from_chars() reads capitals and small letters alike, so
    // A0000 and a0000 both are 10 * 36^4 there.
    constexpr std::int64_t kUpper = 100'000 - std::int64_t{10} * 36 * 36 * 36 * 36;
    constexpr std::int64_t kLower = kUpper + std::int64_t{26} * 36 * 36 * 36 * 36;
    std::int64_t value = 0;
    const bool lower = std::islower(static_cast<unsigned char>(digits[0])) != 0;
    const char* begin = digits.data();
    const auto [end, error] = std::from_chars(begin, begin + 5, value, 36);
    if (error != std::errc() || end != begin + 5) return std::nullopt;
    return value + (lower ? kLower : kUpper);
  }
  return whole_number(digits);
}

// Reads a residue's number from four columns: decimal, or in hybrid-36 beyond 9999. Nothing if they
// are blank, and whatever digits stand there otherwise.
gemmi::SeqId::OptionalNum residue_number(std::string_view field) {
  gemmi::SeqId::OptionalNum number;
  const bool is_hybrid = field[0] >= 'A';
  field = trimmed(field);
  if (field.empty()) return number;
  if (field.starts_with('+') && !field.starts_with("+-")) field.remove_prefix(1);
  int value = 0;
  std::from_chars(field.data(), field.data() + field.size(), value, is_hybrid ? 36 : 10);
  number = is_hybrid ? value - 10 * 36 * 36 * 36 + 10'000 : value;
  return number;
}

// The number at the beginning of the field, whatever stands behind it; 0 if there is none.
float leading_number(std::string_view field) {
  field = trimmed(field);
  if (field.starts_with('+')) field.remove_prefix(1);
  double number = 0;
  if (const std::optional<double> found = short_decimal(field))
    number = *found;
  else
    read_double(field.data(), field.data() + field.size(), number);
  return static_cast<float>(number);
}

// The symbol of an atom type of AutoDock: A is carbon, and a capital A, D or S behind N, O, S or H
// says something of hydrogen bonds. The carbons that close rings are CG0, CG1 and so on. What glues
// them (G0), water that docks along (W) and charges about zinc (TZ) are no atoms.
std::string_view symbol_of_autodock(std::string_view type) {
  if (type == "A" || type.starts_with("CG")) return "C";
  const bool is_glue = type.starts_with('G') && (type.size() == 1 || is_digit(type[1]));
  if (is_glue || type == "W" || type == "TZ") return "DU";
  const bool marked = type.size() == 2 && std::string_view("NOSH").find(type[0]) != type.npos &&
                      std::string_view("ADS").find(type[1]) != type.npos;
  return marked ? type.substr(0, 1) : type;
}

// Whether the text is the symbol of two letters by which the name begins; or if the name does not
// begin by its letter `inside` the columns of the symbol, so that the name does not tell this one.
bool is_symbol_of(std::string_view text, std::size_t inside, std::string_view name) {
  const std::string begin = upper_case(trimmed(name));
  return text.size() == 2 && is_letter(text[0]) && is_letter(text[1]) &&
         element_of_symbol(text) != std::string_view("X") &&
         (begin.starts_with(upper_case(text)) || !begin.starts_with(upper_case(text[inside])));
}

// Names the parts of a chain: its polymer, its water, and each other residue. gemmi finds entities
// by these names; its own names are not the same in all its versions.
void name_subchains(gemmi::Chain& chain) {
  for (gemmi::Residue& residue : chain.residues) {
    residue.subchain = chain.name;
    if (residue.entity_type == gemmi::EntityType::Polymer)
      residue.subchain += "poly";
    else if (residue.entity_type == gemmi::EntityType::Water)
      residue.subchain += "wat";
    else if (residue.entity_type == gemmi::EntityType::NonPolymer)
      residue.subchain += residue.seqid.str();
  }
}

// Reads one file: construct, then call run() once.
class PdbReader {
 public:
  PdbReader(std::string_view text, const std::string& path)
      : rest_(text), layout_(layout_of(text)) {
    file_.path = path;
    file_.format = "pdb";
    file_.structure = std::make_shared<gemmi::Structure>();
    file_.coarse_grained = layout_.beads;
    if (layout_.is_name_guessed) {
      file_.warnings.push_back(
          "column 21 is taken for the fourth letter of residue names, as in HISA; nothing in the "
          "file tells it from the letter of a chain id; an mmCIF file has columns for both");
    }
  }

  ParsedFile run(Monitor* monitor) {
    std::string_view line;
    for (number_ = 1; next_line(rest_, line); ++number_) {
      if (number_ % kLinesPerCheck == 0) advance(monitor, 0);
      take(line);
    }
    if (file_.atoms.empty())
      throw FileFormatError(file_.path +
                            ": has no ATOM or HETATM record, so there is nothing to mesh");
    for (gemmi::Model& model : file_.structure->models)
      for (gemmi::Chain& chain : model.chains)
        if (chain.residues.front().entity_type != gemmi::EntityType::Unknown) name_subchains(chain);
    file_.assemblies = biomolecules_.finish();
    return std::move(file_);
  }

 private:
  // Handles one line. Other records than these are passed over.
  void take(std::string_view line) {
    if (is_atom_record(line)) {
      take_atom(line);
    } else if (models_.take(line)) {
      return;
    } else if (is_record(line, "TER") && (line.size() == 3 || !is_digit(line[3]))) {
      end_polymer();
    } else if (starts_with_record(line, "REMARK 350")) {
      biomolecules_.take(line.substr(0, kTagColumn), number_);
    } else if (line.starts_with(' ') && is_atom_record(trimmed(line))) {
      refuse("an atom's record begins behind a blank; it belongs in column 1");
    }
  }

  // Residues behind a TER are no polymer, also where the chain's name comes again. Selections can
  // name these types.
  void end_polymer() {
    if (!chain_ || is_after_ter_) return;
    for (gemmi::Residue& residue : chain_->residues)
      residue.entity_type = gemmi::EntityType::Polymer;
    is_after_ter_ = true;
  }

  // Checks an atom record and adds its AtomRecord. A serial number that cannot be read is replaced
  // by the number of the atom in the file, from 1.
  void take_atom(std::string_view line) {
    if (models_.begins_model()) {
      if (models_.names().size() > kMaxModels)
        refuse(fmt::format("more than {} models; cut the file into smaller ones", kMaxModels));
      file_.structure->models.emplace_back(models_.names().back());
      chain_ = nullptr;
    }
    AtomRecord atom;
    atom.position = position_of(line);
    const std::string_view symbol = symbol_field(line);
    record_ = line.substr(0, width_of(line, symbol));
    record_.resize(kLastColumn, ' ');
    atom.line = number_;
    atom.hetero = starts_with_record(line, "HETATM");
    atom.serial = serial_number(columns(record_, 6, 5))
                      .value_or(static_cast<std::int64_t>(file_.atoms.size()) + 1);
    atom.name = trimmed(columns(record_, 12, 4));
    if (record_[16] != ' ') atom.altloc = record_[16];
    // The atom is meant to be there in full where the occupancy is blank.
    const std::string_view occupancy = columns(record_, 54, 6);
    atom.occupancy = trimmed(occupancy).empty() ? 1 : leading_number(occupancy);
    atom.b_iso = leading_number(columns(record_, 60, 6));
    atom.residue = enter_residue(atom.hetero);
    set_element(symbol, residue_->name, atom);
    file_.atoms.push_back(atom);
  }

  // The number of the residue in record_, which is added where it is new.
  std::uint32_t enter_residue(bool hetero) {
    const std::string_view name = columns(record_, 17, layout_.wide_names ? 4 : 3),
                           chain = layout_.wide_names ? columns(record_, 21, 1)
                                                      : columns(record_, kFourthLetter, 2),
                           segment = columns(record_, kTagColumn, 4);
    gemmi::ResidueId id;
    id.name = trimmed(name);
    id.seqid = {residue_number(columns(record_, 22, 4)), record_[26]};
    if (!is_decimal(segment)) id.segment = trimmed(segment);
    if (!chain_ || chain_->name != trimmed(chain)) open_chain(std::string(trimmed(chain)));
    if (!residue_ || !residue_->matches(id)) {
      const auto [place, is_new] = places_.try_emplace(id, chain_->residues.size());
      if (is_new) add_residue(id, hetero);
      residue_ = &chain_->residues[place->second];
    }
    return first_residue_ + static_cast<std::uint32_t>(residue_ - chain_->residues.data());
  }

  void open_chain(std::string name) {
    gemmi::Model& model = file_.structure->models.back();
    const gemmi::Chain* const before = model.find_chain(name);
    is_after_ter_ = before && before->residues[0].entity_type == gemmi::EntityType::Polymer;
    chain_ = &model.chains.emplace_back(std::move(name));
    residue_ = nullptr;
    places_.clear();
    first_residue_ = residues_;
  }

  void add_residue(const gemmi::ResidueId& id, bool hetero) {
    gemmi::Residue& residue = chain_->residues.emplace_back(id);
    ++residues_;
    residue.het_flag = hetero ? 'H' : 'A';
    if (is_after_ter_)
      residue.entity_type =
          residue.is_water() ? gemmi::EntityType::Water : gemmi::EntityType::NonPolymer;
  }

  // How many columns of the record are read. An entry tag would be read as an element, and a
  // charge or a symbol too far to the left as a segment.
  std::size_t width_of(std::string_view line, std::string_view symbol) const {
    if (layout_.pdbqt) return kChargeColumn - 4;
    if (layout_.entry_tags) return kTagColumn;
    return symbol.data() < line.data() + kElementColumn ? kElementColumn - 1 : kLastColumn;
  }

  // The symbol of the element. It belongs in columns 77-78. A symbol of two letters that stands one
  // column further left or right is read there if the name does not tell the letter in these
  // columns.
  std::string_view symbol_field(std::string_view line) const {
    if (layout_.entry_tags || line.size() <= kElementColumn) return line.substr(line.size());
    if (layout_.pdbqt) return symbol_of_autodock(trimmed(columns(line, kElementColumn, 4)));
    const bool is_one_letter = line[kElementColumn] == ' ' && line.size() > kElementColumn + 1 &&
                               is_letter(line[kElementColumn + 1]) &&
                               (line.size() == kLastColumn || !is_letter(line[kLastColumn]));
    if (is_one_letter) return line.substr(kElementColumn + 1, 1);
    const std::string_view name = columns(line, 12, 4);
    const bool ends_early = line[kElementColumn - 2] == ' ',
               begins_late = line[kElementColumn] == ' ';
    const std::string_view left = columns(line, kElementColumn - 1, 2),
                           right = columns(line, kElementColumn + 1, 2);
    if (ends_early && trimmed(columns(line, kElementColumn, 2)).size() == 1 &&
        line[kElementColumn] != ' ' && is_symbol_of(left, 1, name))
      return left;
    return begins_late && is_symbol_of(right, 0, name) ? right
                                                       : trimmed(columns(line, kElementColumn, 2));
  }

  // Beads have no element.
  void set_element(std::string_view symbol, std::string_view residue, AtomRecord& atom) {
    atom.element = gemmi::find_element(element_of_symbol(symbol));
    if (layout_.beads) {
      atom.element_guessed = atom.element == gemmi::El::X;
      return;
    }
    read_element(symbol, columns(record_, 12, 4),
                 layout_.names_at_left ? NamePlace::word : NamePlace::columns, residue, atom);
    file_.elements_in_doubt |= atom.element_guessed || atom.symbol_overruled || atom.is_virtual ||
                               atom.is_other_ion || atom.element == gemmi::El::D;
  }

  // A number with a point is a charge or a factor, and no segment id.
  static bool is_decimal(std::string_view field) {
    return field.find('.') != std::string_view::npos && finite_number(field).has_value();
  }

  // Shifted columns would give a wrong position if whatever digits are there were read.
  Vec3d position_of(std::string_view line) const {
    static constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
    Vec3d position;
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      const std::size_t first = 30 + 8 * axis;
      const std::string_view field = columns(line, first, 8);
      const std::optional<double> number = finite_number(field);
      if (!number)
        refuse(
            fmt::format("{} in columns {}-{} is {}, not a finite number; "
                        "PDB needs fixed columns (whitespace-separated: --format pqr or xyzr)",
                        kAxes[axis], first + 1, first + 8, in_quotes(field)));
      position[static_cast<int>(axis)] = *number;
    }
    return position;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw FileFormatError(fmt::format("{}:{}: {}", file_.path, number_, what));
  }

  ParsedFile file_;
  std::string_view rest_;  // the lines that are still to be read
  PdbLayout layout_;
  std::string record_;        // of the current atom, of kLastColumn columns
  std::uint32_t number_ = 0;  // of the current line, from 1
  ModelRecords models_;
  BiomoleculeReader biomolecules_;
  gemmi::Chain* chain_ = nullptr;      // of the atom before; null at the beginning of a model
  gemmi::Residue* residue_ = nullptr;  // of the atom before, in chain_
  std::unordered_map<gemmi::ResidueId, std::size_t> places_;  // in chain_
  std::uint32_t residues_ = 0, first_residue_ = 0;            // so far; before chain_
  bool is_after_ter_ = false;
};

}  // namespace

ParsedFile parse_pdb(std::string_view text, const std::string& path, Monitor* monitor) {
  return PdbReader(text, path).run(monitor);
}

}  // namespace vdwmesh
