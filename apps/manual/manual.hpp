// Man pages and completions in shells, made from the lists of verbs and options.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "command_line/option_list.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {

struct ListedVerb {
  const Verb* verb;
  std::vector<OptionGroup> groups;  // as --help shows them
};

struct ListedProgram {
  Program program;
  std::vector<ListedVerb> verbs;
};

// The options' readers refer to `draft`; nothing here reads a value with them.
ListedProgram list_of(const Program& program, Draft& draft);

// "vdwmesh-bench-thesis": the name of a verb's page.
std::string page_name(const Program& program, const Verb& verb);
// Both in the macros of man(7), in ASCII. `version` is that of the program.
std::string man_page(const ListedProgram& listed, std::string_view version);
std::string man_page(const ListedProgram& listed, const ListedVerb& verb, std::string_view version);

// Functions that complete verbs, options, names, files and folders, and say to the shell that they
// do: for the folders of bash-completion, and of zsh's fpath.
std::string bash_completion(const ListedProgram& listed);
std::string zsh_completion(const ListedProgram& listed);

// "_vdwmesh_mpi": the function of a shell that completes the words of the program.
std::string function_name(const Program& program);
// What the value of an option is, for completions.
enum class ValueKind { none, word, words, file, folder };  // words: with commas between
ValueKind value_kind(const Option& option);

}  // namespace vdwmesh::apps
