// Lines are counted where they are read, so that each message names its line. read_symbol() weighs
// words in capitals or small letters against the rules for names (elements.hpp).
#include "structure/plain/atom_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <gemmi/model.hpp>
#include <memory>
#include <system_error>
#include <utility>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/molecule/elements.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

// Splits "52A" into the number 52 and the insertion code A.
gemmi::SeqId sequence_id(std::string_view number) {
  gemmi::SeqId id;
  int value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc()) return id;
  id.num = value;
  if (end != number.data() + number.size()) id.icode = *end;
  return id;
}

// Signs for an atom of which the file does not say the element, in queries and in places of
// substituents.
bool is_any_atom(std::string_view word) {
  constexpr std::array<std::string_view, 9> kSigns{"X", "*", "A", "Q", "L", "R", "R#", "M", "Bq"};
  return std::find(kSigns.begin(), kSigns.end(), word) != kSigns.end() || word.starts_with('[');
}

bool is_doubtful(const AtomRecord& atom) {
  return atom.element_guessed || atom.symbol_overruled || atom.is_virtual || atom.is_other_ion ||
         atom.element == gemmi::El::D;
}

}  // namespace

bool NumberedLines::next() {
  if (!next_line(rest_, line_)) return false;
  if (++number_ % kLinesPerCheck == 0) advance(monitor_, 0);
  return true;
}

std::string_view NumberedLines::expect(std::string_view what) {
  if (!next())
    throw FileFormatError(
        fmt::format("{}: ends behind line {}, where {} should follow", path_, number_, what));
  return line_;
}

// Looks at the front alone: the text may end in many blanks, and frames ask often.
bool NumberedLines::is_at_end() const {
  return rest_.find_first_not_of(" \t\r\n\v\f") == rest_.npos;
}

void NumberedLines::refuse(const std::string& what) const {
  throw FileFormatError(fmt::format("{}:{}: {}", path_, number_, what));
}

std::uint64_t NumberedLines::count_in(std::string_view field, std::string_view what) const {
  const std::optional<std::int64_t> count = whole_number(field);
  if (!count || *count < 0)
    refuse(fmt::format("{} stands where {} should be", in_quotes(trimmed(field)), what));
  return static_cast<std::uint64_t>(*count);
}

Vec3d NumberedLines::position_in(std::string_view x, std::string_view y, std::string_view z) const {
  return {number_or_refuse(x, "x", path_, number_), number_or_refuse(y, "y", path_, number_),
          number_or_refuse(z, "z", path_, number_)};
}

StructureBuilder::StructureBuilder(const std::string& path, const char* format) {
  file_.path = path;
  file_.format = format;
  file_.structure = std::make_shared<gemmi::Structure>();
  file_.has_labels = false;
}

void StructureBuilder::begin_model(const std::string& name) {
  file_.structure->models.emplace_back(name);
  chain_ = nullptr;
}

AtomRecord& StructureBuilder::add(const ResidueLabel& residue, const Vec3d& position,
                                  std::uint32_t line) {
  const std::uint32_t number = enter_residue(residue);
  AtomRecord& atom = file_.atoms.emplace_back();
  atom.position = position;
  atom.residue = number;
  atom.line = line;
  atom.serial = static_cast<std::int64_t>(file_.atoms.size());
  atom.hetero = residue.hetero;
  return atom;
}

std::uint32_t StructureBuilder::enter_residue(const ResidueLabel& label) {
  if (!chain_ || chain_->name != label.chain) {
    std::vector<gemmi::Chain>& chains = file_.structure->models.back().chains;
    chains.emplace_back(std::string(label.chain));
    chain_ = &chains.back();
    number_.clear();
  }
  std::vector<gemmi::Residue>& residues = chain_->residues;
  if (residues.empty() || number_ != label.number || residues.back().name != label.name) {
    number_ = label.number;
    gemmi::Residue residue;
    residue.name = std::string(label.name);
    residue.seqid = sequence_id(number_);
    residue.het_flag = label.hetero ? 'H' : 'A';
    residues.push_back(std::move(residue));
    ++residues_;
  }
  return residues_ - 1;
}

ParsedFile StructureBuilder::finish() {
  if (file_.atoms.empty())
    throw FileFormatError(file_.path + ": has no atoms, so there is nothing to mesh");
  file_.elements_in_doubt = std::any_of(file_.atoms.begin(), file_.atoms.end(), is_doubtful);
  return std::move(file_);
}

void read_symbol(std::string_view word, const NumberedLines& at, AtomRecord& atom) {
  atom.name = word;
  if (is_any_atom(word)) return;
  const auto* const end = std::find_if_not(word.begin(), word.end(), is_letter);
  const std::string_view letters = word.substr(0, static_cast<std::size_t>(end - word.begin()));
  constexpr std::string_view kBehind = "0123456789+-";
  const bool is_word = word.find_first_not_of(kBehind, letters.size()) == word.npos;
  if (is_word) {
    atom.element = gemmi::find_element(element_of_symbol(letters));
    const gemmi::El by_letters = gemmi::find_element(element_of_bare_name(letters, ""));
    read_element(letters, letters, NamePlace::word, "", atom);
    if (atom.is_virtual) return;
    const bool is_spelled =
        letters.size() == 2 && !is_small_letter(letters[0]) && is_small_letter(letters[1]);
    if (!atom.element_guessed && (letters.size() == 1 || is_spelled || by_letters == atom.element))
      return;
    if (!atom.element_guessed)
      at.refuse(fmt::format(
          "{0} may be the element {1} or the name of an atom of {2}; write {1} "
          "or {2}",
          in_quotes(word), gemmi::element_name(atom.element), gemmi::element_name(by_letters)));
  }
  at.refuse(fmt::format("{} is no symbol of an element", in_quotes(word)));
}

}  // namespace vdwmesh
