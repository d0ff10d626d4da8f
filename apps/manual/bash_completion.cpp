// The completion of bash: a function that finds out at which place of the command line the cursor
// is, around a table of verbs, their options and the values of these. It needs nothing of the
// package bash-completion but its folder. Bash ends words at "=", so `--field` with a value behind
// it comes as three.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "manual/manual.hpp"

namespace vdwmesh::apps {
namespace {

constexpr const char* kFunction = R"(
{0}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}
  local verb=${{COMP_WORDS[1]}} first=2 kind='' words='' prefix=''
  COMPREPLY=()
  if [[ $word == '=' ]]; then
    word=''
  elif [[ $before == '=' && COMP_CWORD -gt 2 ]]; then
    before=${{COMP_WORDS[COMP_CWORD-2]}}
  fi
  if ((COMP_CWORD == 1)); then
    verb=''
  elif [[ '{1}' == *" $verb "* ]]; then
    if ((COMP_CWORD > 2)); then verb+=" ${{COMP_WORDS[2]}}"; fi
    first=3
  fi
  if ((COMP_CWORD < first)); then
    case $verb in
{2}    esac
  else
    case "$verb $before" in
{3}    esac
    if [[ -z $kind ]]; then
      if [[ $word == -* ]]; then
        kind=words
        case $verb in
{4}        esac
      else
        case $verb in
{5}        esac
      fi
    fi
  fi
  case $kind in
    list)
      [[ $word == *,* ]] && prefix=${{word%,*}},
      words=$(compgen -P "$prefix" -W "$words" -- "${{word##*,}}") ;;
    words) words=$(compgen -W "$words" -- "$word") ;;
    file) words=$(compgen -W "$words" -- "$word"; compgen -f -- "$word") ;;
    folder) words=$(compgen -d -- "$word") ;;
  esac
  if [[ $kind == file || $kind == folder ]]; then compopt -o filenames 2>/dev/null; fi
  if [[ -n $words ]]; then mapfile -t COMPREPLY <<< "$words"; fi
}}
complete -F {0} {6}
)";

std::string one_case(std::size_t indent, const std::string& pattern, const std::string& kind,
                     const std::string& words) {
  return fmt::format("{:{}}{}) kind={} words='{}' ;;\n", "", indent, pattern, kind, words);
}

// The words that can stand where a verb does, by what stands before: nothing, or "bench".
std::map<std::string, std::vector<std::string>> words_of_verbs(const ListedProgram& listed) {
  std::map<std::string, std::vector<std::string>> words;
  for (const ListedVerb& verb : listed.verbs) {
    const std::string name(verb.verb->name);
    const std::size_t space = name.find(' ');
    std::vector<std::string>& first = words[""];
    const std::string begin = name.substr(0, space);
    if (std::ranges::find(first, begin) == first.end()) first.push_back(begin);
    if (space != name.npos) words[begin].push_back(name.substr(space + 1));
  }
  for (auto& [before, list] : words) list.push_back("--help");
  words[""].push_back("--version");
  return words;
}

// The options that have one kind and the same words are one case.
std::string cases_of_values(const ListedProgram& listed) {
  constexpr const char* kKinds[] = {"", "words", "list", "file", "folder"};
  std::map<std::pair<std::string, std::string>, std::vector<std::string>> patterns;
  for (const ListedVerb& verb : listed.verbs) {
    for (const OptionGroup& group : verb.groups) {
      for (const Option& option : group.options) {
        if (option.is_flag() || option.is_positional()) continue;
        const std::string kind = kKinds[static_cast<int>(value_kind(option))];
        auto& same = patterns[{kind, fmt::format("{}", fmt::join(option.reader.words, " "))}];
        same.push_back(fmt::format("'{} {}'", verb.verb->name, option.long_name()));
        if (option.short_name() == option.long_name()) continue;
        same.push_back(fmt::format("'{} {}'", verb.verb->name, option.short_name()));
      }
    }
  }
  std::string text;
  for (const auto& [value, same] : patterns) {
    text += one_case(6, fmt::format("{}", fmt::join(same, "|")), value.first, value.second);
  }
  return text;
}

std::string names_of_options(const ListedVerb& verb) {
  std::string names;
  for (const OptionGroup& group : verb.groups) {
    for (const Option& option : group.options) {
      if (!option.is_positional()) names += std::string(option.long_name()) + ' ';
    }
  }
  return names + "--help";
}

bool takes_files(const ListedVerb& verb) {
  return std::ranges::any_of(verb.groups, [](const OptionGroup& group) {
    return std::ranges::any_of(group.options, &Option::is_positional);
  });
}

}  // namespace

std::string bash_completion(const ListedProgram& listed) {
  const std::string function = function_name(listed.program);
  std::string verbs, prefixes, options, places;
  for (const auto& [before, words] : words_of_verbs(listed)) {
    verbs += one_case(6, "'" + before + "'", "words", fmt::format("{}", fmt::join(words, " ")));
    prefixes += before + ' ';
  }
  for (const ListedVerb& verb : listed.verbs) {
    const std::string pattern = fmt::format("'{}'", verb.verb->name);
    options += one_case(10, pattern, "words", names_of_options(verb));
    if (takes_files(verb)) places += one_case(10, pattern, "file", "");
  }
  return fmt::format("# bash completion for {}    -*- shell-script -*-\n", listed.program.name) +
         fmt::format(fmt::runtime(kFunction), function, prefixes, verbs, cases_of_values(listed),
                     options, places, listed.program.name);
}

}  // namespace vdwmesh::apps
