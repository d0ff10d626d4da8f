// Splits a selection into its fields, reads those that name chains, residues and atoms, and leaves
// the rest to gemmi: models, elements, alternate locations and conditions. gemmi takes no negative
// numbers and no names with other signs than letters and digits. A site is selected if its model,
// chain, residue and atom are.
#include "structure/molecule/site_selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <climits>
#include <exception>
#include <gemmi/polyheur.hpp>
#include <gemmi/select.hpp>
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/read/hierarchy.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

constexpr std::string_view kSegment = "segment=";

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t end = 0; end != std::string_view::npos; text.remove_prefix(end + 1)) {
    end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) break;
  }
  return parts;
}

// A field that is not what the grammar wants; the caller says which selection it is of.
[[noreturn]] void misread(std::string_view field) {
  throw InvalidInput(fmt::format("near {}", in_quotes(field)));
}

// "A,B", "!A,B" for all others, or "*". `signs` are what no name has.
gemmi::Selection::List list_of(std::string_view text, std::string_view signs) {
  gemmi::Selection::List list;
  list.all = text == "*";
  list.inverted = text.starts_with('!');
  if (list.all) return list;
  list.list = text.substr(list.inverted ? 1 : 0);
  if (list.list.find_first_of(signs) != std::string::npos) misread(text);
  return list;
}

// Takes a residue number off the text: "10", "-3", "52A", "52.A"; "*" for any. Without a number,
// `number` stays.
gemmi::Selection::SequenceId take_number(std::string_view& text, int number) {
  gemmi::Selection::SequenceId id{number, '*'};
  if (text.starts_with('*')) {
    text.remove_prefix(1);
    return id;
  }
  std::size_t end = text.starts_with('-') ? 1 : 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  const auto value = whole_number(text.substr(0, end));
  if (!value) return id;
  if (*value <= INT_MIN || *value >= INT_MAX) misread(text);
  id = {static_cast<int>(*value), ' '};
  text.remove_prefix(end);
  if (text.starts_with('.')) text.remove_prefix(1);
  if (!text.empty() && (is_letter(text[0]) || text[0] == '*')) {
    id.icode = text[0];
    text.remove_prefix(1);
  }
  return id;
}

// "10", "10-40", "-3--1", "10-", "*-40", "(ALA,GLY)", "10-40(ALA)" or "10(ALA)-40". A single number
// is one residue.
// "-10" is one as well where the file counts below 0, as `negative` says; elsewhere it is what
// gemmi reads, all up to 10: then the function returns true.
bool read_residues(std::string_view field, bool negative, gemmi::Selection& selection) {
  const std::string_view whole = field;
  const auto take_names = [&] {
    if (!field.starts_with('(')) return;
    const std::size_t end = field.find(')');
    if (end == std::string_view::npos) misread(whole);
    selection.residue_names = list_of(field.substr(1, end - 1), "[]()!/:;");
    field.remove_prefix(end + 1);
    // MMDB's ends of a list, "(ALA)." and "(ALA).*".
    while (field.starts_with('.') || field.starts_with('*')) field.remove_prefix(1);
  };
  const bool is_open = !negative && field.starts_with('-') && field.rfind('-') == 0;
  if (!is_open) selection.from_seqid = take_number(field, INT_MIN);
  const bool is_single = !selection.from_seqid.empty();
  take_names();
  if (field.starts_with('-')) {
    field.remove_prefix(1);
    selection.to_seqid = take_number(field, INT_MAX);
    take_names();
  } else if (is_single) {
    selection.to_seqid = selection.from_seqid;
  }
  if (!field.empty()) misread(whole);
  return is_open;
}

// Which field a selection begins with that leaves out the first ones: 0 model, 1 chain, 2 residue,
// 3 atom.
std::size_t first_field(std::string_view text) {
  if (text.starts_with('/')) return 0;
  if (is_digit(text[0]) || text[0] == '.' || text[0] == '(' || text[0] == '-') return 2;
  const std::size_t sign = text.find_first_of("/([:");
  if (sign == std::string_view::npos || text[sign] == '/') return 1;
  return text[sign] == '(' ? 2 : 3;
}

bool has_negative_numbers(const gemmi::Structure& structure) {
  for (const gemmi::Model& model : structure.models)
    for (const gemmi::Chain& chain : model.chains)
      for (const gemmi::Residue& residue : chain.residues)
        if (residue.seqid.num.has_value() && *residue.seqid.num < 0) return true;
  return false;
}

}  // namespace

// Reads chains, residues, names of atoms and segments, and returns what gemmi is to read.
std::string SiteSelection::read_names(std::string_view text, ParsedFile& file,
                                      gemmi::Selection& names) {
  std::vector<std::string_view> conditions = split(text, ';');
  std::string_view place = conditions.front();
  std::string model, atom, others;
  if (!place.empty() && place != "*") {
    const std::size_t first = first_field(place);
    if (first == 0) place.remove_prefix(1);
    std::vector<std::string_view> fields(first, "*");
    for (const std::string_view field : split(place, '/')) fields.push_back(field);
    if (fields.size() > 4) misread(fields[4]);
    const std::size_t given = fields.size();
    fields.resize(4);
    if (first == 0) model = fields[0];
    if (given > 1) names.chain_ids = list_of(fields[1], "[]()!/*:;");
    if (given > 2 && read_residues(fields[2], has_negative_numbers(*file.structure), names))
      file.warnings.push_back(
          fmt::format("selection {} is of all residues up to that number, as no number in the file "
                      "is negative; A/*-10 says so in any file",
                      in_quotes(text)));
    const std::size_t end = std::min(fields[3].find_first_of("[:"), fields[3].size());
    if (end > 0) names.atom_names = list_of(fields[3].substr(0, end), "[]()!/:;");
    atom = fields[3].substr(end);
  }
  for (std::size_t i = 1; i < conditions.size(); ++i) {
    const std::string_view condition = trimmed(conditions[i]);
    if (condition.starts_with(kSegment))
      segments_ = list_of(condition.substr(kSegment.size()), "[]()!/:;").str();
    else
      others += fmt::format(";{}", conditions[i]);
  }
  return fmt::format("/{}/*/(*)/{}{}", model, atom, others);
}

SiteSelection::SiteSelection(const std::string& text, ParsedFile& file) {
  refuse_words_of_others(text);
  try {
    if (is_in_words(text)) {
      words_ = test_in_words(text);
      return;
    }
    gemmi::Selection names;
    selection_ = std::make_unique<gemmi::Selection>(read_names(text, file, names));
    selection_->chain_ids = names.chain_ids;
    selection_->residue_names = names.residue_names;
    selection_->from_seqid = names.from_seqid;
    selection_->to_seqid = names.to_seqid;
    selection_->atom_names = names.atom_names;
  } catch (const std::exception& error) {
    throw InvalidInput(
        fmt::format("selection {} is not understood ({}); for example A/10-40/CA or /1/A,B, or in "
                    "words: chain A and resi 10-40",
                    in_quotes(text), one_line(error.what())));
  }
  if (selection_->entity_types.all) return;
  give_gemmi_atoms(file);
  gemmi::setup_entities(*file.structure);
}

SiteSelection::~SiteSelection() = default;

// A chain without an id goes by its segment as well.
bool SiteSelection::contains_chain(const Site& site) const {
  const std::string& chain = site.place->chain->name;
  const std::string& segment = site.place->residue->segment;
  if (segments_ != "*" && !list_of(segments_, "").has(segment)) return false;
  const gemmi::Selection::List& chains = selection_->chain_ids;
  if (!chain.empty() || segment.empty()) return chains.has(chain);
  return chains.inverted ? chains.has(chain) && chains.has(segment)
                         : chains.has(chain) || chains.has(segment);
}

bool SiteSelection::contains(const Site& site) const {
  if (words_) return words_(site);
  if (!selection_->matches(*site.place->model) || !contains_chain(site) ||
      !selection_->matches(*site.place->residue))
    return false;
  gemmi::Atom atom;
  copy_to_gemmi(*site.atom, atom);
  return selection_->matches(atom);
}

}  // namespace vdwmesh
