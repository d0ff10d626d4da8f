// Reads MOL2 (Tripos): sections that begin with @<TRIPOS>, of which MOLECULE, ATOM and SUBSTRUCTURE
// are read. Each molecule is a model of its own. An atom is: id name x y z type [substructure's id
// [its name [charge [status]]]].
//
// Types of SYBYL begin with the symbol of the element: "C.3", "N.ar", "Ca". Programs write types of
// force fields there as well ("ca" and "c3" of GAFF), which are no symbols; then names tell.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/molecule/elements.hpp"
#include "structure/molecule/residue_elements.hpp"
#include "structure/plain/atom_lines.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

// The text of a field; four asterisks stand for none.
std::string_view field_of(const std::vector<std::string_view>& words, std::size_t index) {
  if (index >= words.size() || words[index] == "****") return {};
  return words[index];
}

// The symbol in a type of SYBYL, or "LP" or "DU" for what is no atom; empty for other types.
std::string symbol_of_type(std::string_view type) {
  constexpr std::string_view kForms = "  1 2 3 4 ar am pl3 co2 cat o o2 spc t3p th oh ";
  const std::size_t point = std::min(type.find('.'), type.size());
  const std::string_view begin = type.substr(0, point);
  if (begin == "LP" || begin == "Du") return upper_case(begin);
  const std::string form =
      fmt::format(" {} ", lower_case(type.substr(std::min(point + 1, type.size()))));
  const bool is_spelled = !begin.empty() && is_capital(begin[0]) &&
                          (begin.size() == 1 || (begin.size() == 2 && is_small_letter(begin[1])));
  const bool is_symbol = is_spelled && kForms.find(form) != kForms.npos &&
                         element_of_symbol(begin) != std::string_view("X");
  return is_symbol ? std::string(begin) : std::string();
}

class Mol2Reader {
 public:
  Mol2Reader(std::string_view text, const std::string& path, Monitor* monitor)
      : lines_(text, path, monitor), builder_(path, "mol2") {}

  ParsedFile run() {
    while (lines_.next()) take(lines_.line());
    if (molecules_ == 0)
      throw FileFormatError(lines_.path() + ": is not MOL2: it has no @<TRIPOS>MOLECULE");
    end_molecule();
    if (other_types_ > 0)
      builder_.file().warnings.push_back(
          fmt::format("the types of {} atoms are none of SYBYL, the first {} in line {}: elements "
                      "are told from names",
                      other_types_, first_type_, first_line_));
    return builder_.finish();
  }

 private:
  enum class Section { none, molecule, atoms, substructures };

  // Where the words of a SUBSTRUCTURE stand: name, chain and kind of residue.
  using Words = std::vector<std::string_view>;
  static constexpr std::size_t kChain = 5, kKind = 6;

  void take(std::string_view line) {
    constexpr std::string_view kMark = "@<TRIPOS>";
    if (line.starts_with(kMark)) return begin_section(trimmed(line.substr(kMark.size())));
    if (section_ == Section::molecule) return take_header(line);
    line = trimmed(line);
    if (section_ == Section::none || line.empty() || line.starts_with('#')) return;
    if (line.ends_with('\\')) lines_.refuse("goes on in the next line; write it in one");
    Words words = split_at_blanks(line);
    if (section_ == Section::atoms) return take_atom(std::move(words));
    substructures_[words[0]] = std::move(words);
  }

  void begin_section(std::string_view name) {
    if (name == "MOLECULE") {
      end_molecule();
      ++molecules_;
      header_lines_ = 0;
    }
    if (molecules_ == 0) lines_.refuse("stands before the first @<TRIPOS>MOLECULE");
    section_ = name == "MOLECULE"       ? Section::molecule
               : name == "ATOM"         ? Section::atoms
               : name == "SUBSTRUCTURE" ? Section::substructures
                                        : Section::none;
  }

  // The second line begins with the number of atoms.
  void take_header(std::string_view line) {
    if (++header_lines_ != 2) return;
    const Words words = split_at_blanks(line);
    wanted_ = lines_.count_in(words.empty() ? "" : words[0], "the number of atoms");
  }

  void take_atom(Words words) {
    if (words.size() < 6)
      lines_.refuse(fmt::format("has {} fields; an atom of MOL2 has at least 6: id name x y z type",
                                words.size()));
    lines_.position_in(words[2], words[3], words[4]);
    atoms_.emplace_back(lines_.number(), std::move(words));
  }

  // Substructures may stand behind the atoms, so that these wait for the end of their molecule.
  void end_molecule() {
    if (molecules_ > 0 && (header_lines_ < 2 || atoms_.size() != wanted_))
      lines_.refuse(fmt::format("here ends molecule {}, with {} atoms, of which its header says {}",
                                molecules_, atoms_.size(), header_lines_ < 2 ? 0 : wanted_));
    if (!atoms_.empty()) builder_.begin_model(std::to_string(molecules_));
    for (const auto& [line, words] : atoms_) add(line, words);
    atoms_.clear();
    substructures_.clear();
    wanted_ = 0;
  }

  void add(std::uint32_t line, const Words& words) {
    const ResidueLabel residue = residue_of(words);
    AtomRecord& atom =
        builder_.add(residue, lines_.position_in(words[2], words[3], words[4]), line);
    atom.name = words[1];
    atom.serial = whole_number(words[0]).value_or(atom.serial);
    const std::string symbol = symbol_of_type(words[5]);
    if (symbol.empty() && other_types_++ == 0) {
      first_type_ = in_quotes(words[5]);
      first_line_ = line;
    }
    atom.element = gemmi::find_element(element_of_symbol(symbol));
    read_element(symbol, atom.name, NamePlace::word, residue.name, atom);
  }

  // The substructure's name, without the number that programs write behind the residue's name:
  // "ALA12". A name that merely ends with digits ("SO4") stays as it is.
  ResidueLabel residue_of(const Words& words) const {
    const std::string_view id = field_of(words, 6), name = field_of(words, 7);
    if (name.empty()) return {"A", "UNL", id.empty() ? "1" : id};
    const auto found = substructures_.find(id);
    const std::string_view chain =
        found == substructures_.end() ? std::string_view() : field_of(found->second, kChain);
    const std::string_view kind =
        found == substructures_.end() ? std::string_view() : field_of(found->second, kKind);
    const std::string_view begin = name.substr(0, name.find_last_not_of("0123456789-") + 1);
    if (!kind.empty() && name.size() > kind.size() && name.starts_with(kind) &&
        whole_number(name.substr(kind.size())))
      return {chain, kind, name.substr(kind.size())};
    const std::string_view number = name.substr(begin.size());
    const bool is_known = kind_of_residue(begin) != ResidueKind::other;
    if (!number.empty() && (is_known || (begin.size() > 2 && number == id)))
      return {chain, begin, number};
    return {chain, name, id};
  }

  NumberedLines lines_;
  StructureBuilder builder_;
  Section section_ = Section::none;
  int molecules_ = 0, header_lines_ = 0;                // begun; read of the last one
  std::uint64_t wanted_ = 0;                            // atoms, as the header says
  std::vector<std::pair<std::uint32_t, Words>> atoms_;  // of the molecule: line and words
  std::map<std::string_view, Words> substructures_;     // by id
  std::size_t other_types_ = 0;                         // atoms with types that are none of SYBYL
  std::string first_type_;
  std::uint32_t first_line_ = 0;
};

}  // namespace

ParsedFile parse_mol2(std::string_view text, const std::string& path, Monitor* monitor) {
  return Mol2Reader(text, path, monitor).run();
}

}  // namespace vdwmesh
