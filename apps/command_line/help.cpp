// Lays the lists of verbs and options out in two columns: what is typed, and what it means. Long
// meanings are broken between words and go on below the second column. Widths are counted in
// columns on the screen, because Å takes two bytes.
#include "command_line/help.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "report/printable.hpp"

namespace vdwmesh::apps {
namespace {

constexpr std::size_t kLeft = 32, kRight = 68;  // columns on the screen

// One entry of a list. If what is typed does not fit the left column, the meaning begins on the
// next line.
std::string list_entry(const std::string& typed, const std::string& meaning) {
  std::string text = typed + blanks(kLeft, typed);
  if (columns_of(typed) >= kLeft) text += '\n' + std::string(kLeft, ' ');
  std::istringstream words(meaning);
  std::size_t used = 0;
  for (std::string word; words >> word; used += columns_of(word) + 1) {
    const bool breaks = used > 0 && used + columns_of(word) > kRight;
    if (breaks) text += '\n' + std::string(kLeft, ' ');
    if (breaks) used = 0;
    text += (used > 0 ? " " : "") + word;
  }
  return text + '\n';
}

// "  -o, --output FILE".
std::string typed(const Option& option) {
  const std::string name = option.short_name();
  const bool has_two = name != option.long_name();
  const std::string& value = option.reader.value;
  return fmt::format("  {}{}{}{}{}", name, has_two ? ", " : "", has_two ? option.long_name() : "",
                     value.empty() ? "" : " ", value);
}

std::string mark(const Option& option) {
  if (option.absence.meaning != Absence::Meaning::error) return "";
  return option.other.empty() ? "(required) " : fmt::format("(required, or {}) ", option.other);
}

std::size_t count_options(const std::vector<OptionGroup>& groups) {
  std::size_t count = 0;
  for (const OptionGroup& group : groups) count += group.options.size();
  return count;
}

}  // namespace

// The names that a value can have come from its reader, the default from the list.
std::string meaning(const Option& option) {
  std::string text = mark(option) + option.help;
  if (!option.reader.accepted.empty()) text += ": " + option.reader.accepted;
  const bool is_shown = option.absence.meaning == Absence::Meaning::value ||
                        option.absence.meaning == Absence::Meaning::words;
  return is_shown ? fmt::format("{} [{}]", text, option.absence.text) : text;
}

// Options without a name are told apart by their order, so the synopsis shows them one by one.
std::string synopsis(const Program& program, const Verb& verb,
                     const std::vector<OptionGroup>& groups) {
  std::string text = fmt::format("{} {} [OPTION...]", program.usage_name, verb.name);
  for (const OptionGroup& group : groups) {
    for (const Option& option : group.options) {
      if (option.is_positional()) text += ' ' + option.name;
      if (option.reader.times == Times::often && option.is_positional()) text += "...";
    }
  }
  return text;
}

std::string verbs_help(const Program& program) {
  std::string text =
      fmt::format("{}\n\nUsage: {} VERB [OPTION...]\n       {} VERB --help | --version\n\nVerbs:\n",
                  program.summary, program.usage_name, program.name);
  for (const Verb& verb : program.verbs) {
    text += list_entry(fmt::format("  {}", verb.name), std::string(verb.summary));
  }
  const auto is_report = [](const Verb& verb) { return verb.name == "report"; };
  if (std::ranges::any_of(program.verbs, is_report))
    text += fmt::format("\nTo begin, without a file: {} report --sample ubiquitin\n", program.name);
  return text;
}

std::string verb_help(const Program& program, const Verb& verb,
                      const std::vector<OptionGroup>& groups, const std::vector<OptionGroup>& all) {
  std::string text = fmt::format("{} {}: {}\n\nUsage: {}\n", program.name, verb.name, verb.summary,
                                 synopsis(program, verb, groups));
  const std::size_t others = count_options(all) - count_options(groups);
  for (const OptionGroup& group : groups) {
    text += fmt::format("\n{}:\n", group.title);
    for (const Option& option : group.options) text += list_entry(typed(option), meaning(option));
  }
  if (others > 0) {
    text += fmt::format("\n{} {} --help-all lists {} more.\n", program.name, verb.name, others);
  }
  return text;
}

}  // namespace vdwmesh::apps
