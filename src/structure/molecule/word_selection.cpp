// A text is cut into words and brackets, and one function for each rule of the grammar reads them:
// alternatives() reads what "or" joins, conjunction() what "and" joins, factor() the rest.
#include "structure/molecule/word_selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <climits>
#include <gemmi/model.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/molecule/residue_elements.hpp"
#include "structure/read/lines.hpp"
#include "structure/read/parsed_file.hpp"

namespace vdwmesh {
namespace {

enum class Keyword {
  protein,
  nucleic,
  polymer,
  backbone,
  water,
  ligand,
  hydrogen,
  hetatm,
  all,  // up to here without values
  chain,
  residue_number,
  residue_name,
  atom_name,
  element,
  segment
};

using NamedKeyword = std::pair<std::string_view, Keyword>;
constexpr NamedKeyword kKeywords[] = {
    {"protein", Keyword::protein},       {"nucleic", Keyword::nucleic},
    {"polymer", Keyword::polymer},       {"backbone", Keyword::backbone},
    {"water", Keyword::water},           {"waters", Keyword::water},
    {"solvent", Keyword::water},         {"ligand", Keyword::ligand},
    {"ligands", Keyword::ligand},        {"hydrogen", Keyword::hydrogen},
    {"hydrogens", Keyword::hydrogen},    {"hetatm", Keyword::hetatm},
    {"hetero", Keyword::hetatm},         {"all", Keyword::all},
    {"chain", Keyword::chain},           {"chainid", Keyword::chain},
    {"resi", Keyword::residue_number},   {"resid", Keyword::residue_number},
    {"resnum", Keyword::residue_number}, {"resn", Keyword::residue_name},
    {"resname", Keyword::residue_name},  {"name", Keyword::atom_name},
    {"element", Keyword::element},       {"elem", Keyword::element},
    {"segid", Keyword::segment},         {"segment", Keyword::segment},
};

const Keyword* find_keyword(std::string_view word) {
  const std::string small = lower_case(word);
  for (const auto& [name, keyword] : kKeywords)
    if (name == small) return &keyword;
  return nullptr;
}

bool is_joint(std::string_view word) {
  const std::string small = lower_case(word);
  return small == "and" || small == "or" || small == "not" || word == "(" || word == ")";
}

// Words between blanks; brackets are words of their own.
std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  bool begins = true;
  for (const char c : text) {
    const bool is_bracket = c == '(' || c == ')', is_blank = c == ' ' || c == '\t';
    if (is_bracket || (begins && !is_blank)) words.emplace_back();
    if (!is_blank) words.back() += c;
    begins = is_bracket || is_blank;
  }
  return words;
}

// The values of a word: "ALA,GLY" and "10-40+50" have two. The sign of an ion ("NA+") stays.
void add_values(const std::string& word, std::vector<std::string>& values) {
  std::string value;
  for (std::size_t i = 0; i < word.size(); ++i) {
    const bool parts = word[i] == ',' || (word[i] == '+' && i + 1 < word.size() && i > 0);
    if (!parts) value += word[i];
    if (value.empty() || !(parts || i + 1 == word.size())) continue;
    values.push_back(std::exchange(value, ""));
  }
}

// A residue number with its insertion code, in the order of a chain.
using ResidueNumber = std::pair<int, char>;

struct NumberRange {
  ResidueNumber first, last;
};

// Takes "10", "-3" or "52A" off the text.
std::optional<ResidueNumber> take_residue_number(std::string_view& text) {
  std::size_t end = text.starts_with('-') ? 1 : 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  const auto number = whole_number(text.substr(0, end));
  if (!number || *number <= INT_MIN || *number >= INT_MAX) return std::nullopt;
  text.remove_prefix(end);
  ResidueNumber place{static_cast<int>(*number), ' '};
  if (text.empty() || !is_letter(text[0])) return place;
  place.second = upper_case(text[0]);
  text.remove_prefix(1);
  return place;
}

std::optional<NumberRange> residue_numbers_of(std::string_view text) {
  const auto first = take_residue_number(text);
  if (!first) return std::nullopt;
  if (text.empty()) return NumberRange{*first, *first};
  if (text[0] != '-' && text[0] != ':') return std::nullopt;
  text.remove_prefix(1);
  const auto last = take_residue_number(text);
  return last && text.empty() ? std::optional(NumberRange{*first, *last}) : std::nullopt;
}

// Whether the text is the pattern, in which * stands for any characters.
bool is_like(std::string_view text, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  if (star == pattern.npos || text == pattern) return text == pattern;
  if (!text.starts_with(pattern.substr(0, star))) return false;
  for (std::size_t i = star; i <= text.size(); ++i)
    if (is_like(text.substr(i), pattern.substr(star + 1))) return true;
  return false;
}

bool any_is_like(const std::vector<std::string>& values, std::string_view value) {
  return std::ranges::any_of(values, [value](const auto& one) { return is_like(value, one); });
}

// The test of a keyword with values.
SiteTest test_of(Keyword keyword, std::vector<std::string> values) {
  switch (keyword) {
    case Keyword::chain:  // a chain without an id goes by its segment
      return [values](const Site& site) {
        const std::string& chain = site.place->chain->name;
        return any_is_like(values, chain.empty() ? site.place->residue->segment : chain);
      };
    case Keyword::segment:
      return
          [values](const Site& site) { return any_is_like(values, site.place->residue->segment); };
    case Keyword::residue_name:
      return [values](const Site& site) { return any_is_like(values, site.place->residue->name); };
    case Keyword::atom_name:
      return [values](const Site& site) { return any_is_like(values, site.atom->name.view()); };
    default:
      break;
  }
  for (std::string& value : values) value = upper_case(value);
  return [values](const Site& site) {
    return any_is_like(values,
                       upper_case(std::string_view(gemmi::element_name(site.atom->element))));
  };
}

SiteTest test_of_numbers(const std::vector<NumberRange>& all) {
  return [all](const Site& site) {
    const gemmi::SeqId& id = site.place->residue->seqid;
    if (!id.num.has_value()) return false;
    const ResidueNumber here{*id.num, upper_case(id.icode)};
    return std::ranges::any_of(
        all, [here](const NumberRange& p) { return p.first <= here && here <= p.last; });
  };
}

bool is_polymer(ResidueKind kind) {
  return kind == ResidueKind::protein || kind == ResidueKind::nucleic;
}

SiteTest test_of_kind(Keyword keyword) {
  const auto of_residue = [](ResidueKind wanted) {
    return
        [wanted](const Site& site) { return kind_of_residue(site.place->residue->name) == wanted; };
  };
  switch (keyword) {
    case Keyword::protein:
      return of_residue(ResidueKind::protein);
    case Keyword::nucleic:
      return of_residue(ResidueKind::nucleic);
    case Keyword::polymer:
      return
          [](const Site& site) { return is_polymer(kind_of_residue(site.place->residue->name)); };
    case Keyword::backbone:
      return [](const Site& site) {
        constexpr std::string_view kAtoms[] = {"N", "CA", "C", "O"};
        return kind_of_residue(site.place->residue->name) == ResidueKind::protein &&
               std::ranges::find(kAtoms, site.atom->name.view()) != std::end(kAtoms);
      };
    case Keyword::water:
      return of_residue(ResidueKind::water);
    case Keyword::ligand:
      return of_residue(ResidueKind::other);
    case Keyword::hydrogen:
      return [](const Site& site) { return gemmi::is_hydrogen(site.atom->element); };
    case Keyword::hetatm:
      return [](const Site& site) { return site.atom->hetero; };
    default:
      return [](const Site&) { return true; };
  }
}

class SelectionWords {
 public:
  explicit SelectionWords(std::string_view text) : words_(words_of(text)) {}

  SiteTest read() {
    SiteTest test = alternatives();
    if (next_ < words_.size()) misread();
    return test;
  }

 private:
  SiteTest alternatives() {
    SiteTest test = conjunction();
    while (take("or"))
      test = [a = std::move(test), b = conjunction()](const Site& s) { return a(s) || b(s); };
    return test;
  }

  SiteTest conjunction() {
    SiteTest test = factor();
    while (take("and"))
      test = [a = std::move(test), b = factor()](const Site& s) { return a(s) && b(s); };
    return test;
  }

  SiteTest factor() {
    if (take("not")) return [a = factor()](const Site& s) { return !a(s); };
    if (take("(")) {
      SiteTest test = alternatives();
      if (!take(")")) misread();
      return test;
    }
    const Keyword* keyword = next_ < words_.size() ? find_keyword(words_[next_]) : nullptr;
    if (!keyword) misread();
    ++next_;
    if (*keyword < Keyword::chain) return test_of_kind(*keyword);
    return *keyword == Keyword::residue_number ? numbers() : test_of(*keyword, values());
  }

  std::vector<std::string> values() {
    std::vector<std::string> found;
    while (next_ < words_.size() && !is_joint(words_[next_])) {
      if (!found.empty() && find_keyword(words_[next_])) misread();  // "and" is missing
      add_values(words_[next_++], found);
    }
    if (found.empty()) misread();
    return found;
  }

  // "10 to 40" is "10-40".
  SiteTest numbers() {
    std::vector<std::string> texts = values();
    for (std::size_t i = 1; i + 1 < texts.size(); ++i) {
      if (lower_case(texts[i]) != "to") continue;
      texts[i - 1] += "-" + texts[i + 1];
      texts.erase(texts.begin() + static_cast<std::ptrdiff_t>(i),
                  texts.begin() + static_cast<std::ptrdiff_t>(i) + 2);
      --i;
    }
    std::vector<NumberRange> all;
    for (const std::string& text : texts) {
      const auto numbers = residue_numbers_of(text);
      if (!numbers) throw InvalidInput(fmt::format("near {}", in_quotes(text)));
      all.push_back(*numbers);
    }
    return test_of_numbers(all);
  }

  bool take(std::string_view word) {
    if (next_ == words_.size() || lower_case(words_[next_]) != word) return false;
    ++next_;
    return true;
  }

  [[noreturn]] void misread() const {
    throw InvalidInput(next_ < words_.size() ? fmt::format("near {}", in_quotes(words_[next_]))
                                             : "something is missing at its end");
  }

  const std::vector<std::string> words_;
  std::size_t next_ = 0;
};

}  // namespace

bool is_in_words(std::string_view text) {
  bool is_negated = false;  // "not" alone is no selection of either kind
  for (const std::string& word : words_of(text)) {
    if (word == "(") continue;
    if (lower_case(word) != "not") return find_keyword(word) != nullptr;
    is_negated = true;
  }
  return is_negated;
}

void refuse_words_of_others(std::string_view text) {
  constexpr std::string_view kNear[] = {"within", "exwithin", "around",  "beyond",   "near_to",
                                        "expand", "byres",    "bychain", "byresidue"};
  const std::vector<std::string> words = words_of(text);
  const auto near = std::ranges::find_if(
      words, [&](const std::string& word) { return std::ranges::count(kNear, lower_case(word)); });
  if (words.size() > 1 && near != words.end())
    throw InvalidInput(
        fmt::format("selection {}: {} is not known, atoms are not selected by distance or as "
                    "neighbours; name residues: chain A and resi 10+12",
                    in_quotes(text), in_quotes(*near)));
  const std::size_t comma = text.find(',');
  if (comma == text.npos || is_in_words(text) || !is_in_words(text.substr(comma + 1))) return;
  throw InvalidInput(fmt::format("selection {}: has a name in front, as in PyMOL; leave it out: {}",
                                 in_quotes(text), in_quotes(trimmed(text.substr(comma + 1)))));
}

SiteTest test_in_words(std::string_view text) { return SelectionWords(text).read(); }

}  // namespace vdwmesh
