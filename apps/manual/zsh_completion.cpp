// The completion of zsh: specifications of `_arguments`, one for each verb, behind the choice of
// the verb, and behind that of the second word of a verb of two.
#include <fmt/format.h>

#include <algorithm>

#include "command_line/help.hpp"
#include "manual/manual.hpp"

namespace vdwmesh::apps {
namespace {

// As a part of a specification in single quotes, where some characters have a meaning.
std::string quoted(std::string_view text, std::string_view special) {
  std::string word;
  for (const char c : text) {
    if (c == '\'') word += "'\\'";
    if (special.find(c) != special.npos) word += '\\';
    word += c;
  }
  return word;
}

std::string action(const Option& option) {
  const std::string words = fmt::format("{}", fmt::join(option.reader.words, " "));
  switch (value_kind(option)) {
    case ValueKind::none:
      return "";
    case ValueKind::file:
      return "_files";
    case ValueKind::folder:
      return "_files -/";
    case ValueKind::word:
      return words.empty() ? " " : fmt::format("({})", words);
    case ValueKind::words:
      return words.empty() ? " " : "_values -s , value " + words;
  }
  return "";
}

// '--spacing=[grid spacing]:Å: ', and the same for each name of the option.
std::string specification(const Option& option) {
  if (option.is_positional()) {
    const bool repeats = option.reader.times == Times::often;
    return fmt::format("        '{}:{}:_files' \\\n", repeats ? "*" : "", option.name);
  }
  const std::string value =
      option.is_flag() ? ""
                       : fmt::format(":{}:{}", quoted(option.reader.value, ":"), action(option));
  const std::string meant = fmt::format("[{}]{}", quoted(option.help, "[]:"), value);
  const bool repeats = option.reader.times == Times::often;
  std::string text;
  if (option.short_name() != option.long_name()) {
    text += fmt::format("        '(--{0})-{1}+{2}' \\\n", option.long_name().substr(2),
                        option.short_name().substr(1), meant);
  }
  return text + fmt::format("        '{}{}{}{}' \\\n", repeats ? "*" : "", option.long_name(),
                            option.is_flag() ? "" : "=", meant);
}

std::string arguments(const ListedVerb& verb) {
  std::string text = "      _arguments \\\n";
  for (const OptionGroup& group : verb.groups) {
    for (const Option& option : group.options) text += specification(option);
  }
  return text + "        '(- *)'{-h,--help}'[print the options]' ;;\n";
}

// 'info:version, build, backends, devices'.
std::string description(std::string_view word, std::string_view summary) {
  return fmt::format(" '{}:{}'", word, quoted(summary, ":"));
}

struct Choices {
  std::string verbs, second_words, cases;  // of `bench`
};

Choices choices_of(const ListedProgram& listed) {
  Choices choices;
  std::string last;
  for (const ListedVerb& listed_verb : listed.verbs) {
    const Verb& verb = *listed_verb.verb;
    const std::size_t space = verb.name.find(' ');
    const std::string first(verb.name.substr(0, space));
    if (space == verb.name.npos) {
      choices.verbs += description(first, verb.summary);
    } else {
      choices.second_words += description(verb.name.substr(space + 1), verb.summary);
      if (first != last) choices.verbs += description(first, "benchmarks");
    }
    last = first;
    choices.cases += fmt::format("    '{}')\n{}", verb.name, arguments(listed_verb));
  }
  return choices;
}

// `words` and CURRENT count from the verb on in the state `rest`, because of the `*::`.
constexpr const char* kFunctions = R"(#compdef {0}
# zsh completion for {0}

{1}_of_verb() {{
  case $1 in
{2}  esac
}}

{1}() {{
  local curcontext=$curcontext state line
  local -a verbs second_words
  typeset -A opt_args
  verbs=({3} )
  second_words=({4} )
  _arguments -C \
    '(- *)'{{-h,--help}}'[print the verbs]' \
    '(- *)--version[print the version]' \
    '1: :->verb' '*:: :->rest'
  case $state in
    verb) _describe verb verbs ;;
    rest)
      if [[ $words[1] != bench ]]; then
        {1}_of_verb $words[1]
      elif ((CURRENT == 2)); then
        _describe benchmark second_words
      else
        shift words
        ((CURRENT -= 1))
        {1}_of_verb "bench $words[1]"
      fi ;;
  esac
}}

{1} "$@"
)";

}  // namespace

std::string zsh_completion(const ListedProgram& listed) {
  const std::string function = function_name(listed.program);
  const Choices choices = choices_of(listed);
  return fmt::format(fmt::runtime(kFunctions), listed.program.name, function, choices.cases,
                     choices.verbs, choices.second_words);
}

}  // namespace vdwmesh::apps
