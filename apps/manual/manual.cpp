// Writes the man pages and completions of the programs into a folder, when the project is built:
//   vdwmesh_manual FOLDER [--ranks]
// FOLDER/man1, FOLDER/bash and FOLDER/zsh get the files under the names by which they are
// installed; with --ranks there are those of vdwmesh-mpi too. Everything is made from the lists of
// verbs and options, as --help is.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "build_id.hpp"
#include "command_line/help.hpp"
#include "outcome.hpp"
#include "ranks/rank_program.hpp"
#include "report/output.hpp"
#include "request/refuse.hpp"

namespace vdwmesh::apps {
namespace {

struct Example {
  std::string_view page, command, meaning;
};
// They need no files but those that examples before them make.
constexpr Example kExamples[] = {
    {"vdwmesh", "vdwmesh report --sample ubiquitin", "A mesh beside the exact figures."},
    {"vdwmesh-mesh", "vdwmesh mesh --sample ubiquitin -o ubiquitin.ply --spacing 0.25",
     "Marching cubes on a grid of a quarter of an ångström."},
    {"vdwmesh-mesh", "vdwmesh mesh --sample bpti -o bpti.ply --subdivide 1",
     "A mesh that follows the creases, with the exact topology."},
    {"vdwmesh-mesh", "vdwmesh mesh --sample bpti -o excluded.ply --surface ses --density 2",
     "The solvent-excluded surface, with two triangles per Å²."},
    {"vdwmesh-report", "vdwmesh report --sample bpti --json bpti.json --per-atom bpti.csv",
     "The report as text and as JSON, and areas and volumes by atom."},
    {"vdwmesh-exact", "vdwmesh exact --sample ubiquitin --probe 1.4",
     "Area and volume of the solvent-accessible surface, and its topology."},
    {"vdwmesh-exact",
     "vdwmesh exact --sample ubiquitin --probe 1.4 --radii protor --per-atom - --group residue",
     "How exposed each residue is."},
    {"vdwmesh-exact", "vdwmesh exact --sample bpti --surface sas --write bpti.pdb",
     "The atoms with their exposed areas as B factors, for viewers of molecules."},
    {"vdwmesh-interface", "vdwmesh interface FOLDER/1UBQ.pdb A/1-40 A/41-76",
     "What two parts of a chain bury of each other."},
    {"vdwmesh-view", "vdwmesh view --sample bpti -o bpti.html",
     "The surface, its pockets and the area of each residue, to look around in."},
    {"vdwmesh-pockets", "vdwmesh pockets --sample ubiquitin -o pockets.csv",
     "Pockets, channels and voids for a water molecule."},
    {"vdwmesh-compare", "vdwmesh compare ubiquitin.ply --sample ubiquitin",
     "A mesh of any program against the exact union of spheres."},
    {"vdwmesh-render", "vdwmesh render --sample bpti -o bpti.png --view top",
     "A picture, without a display."},
    {"vdwmesh-study", "vdwmesh study --sample bpti -o study --spacing 1,0.5 --field vdw",
     "Errors against grid spacing, as tables and as a page."},
    {"vdwmesh-batch", "vdwmesh batch FOLDER -o rows.csv --probe 1.4",
     "Area and volume of all structures of a folder."},
    {"vdwmesh-info", "vdwmesh info", "What this program can compute and draw on."},
    {"vdwmesh-mpi", "mpirun -n 4 vdwmesh-mpi exact --sample ubiquitin",
     "The exact measures by four processes."},
    {"vdwmesh-mpi-mesh", "mpirun -n 4 vdwmesh-mpi mesh --sample ubiquitin -o ubiquitin.ply",
     "One mesh file, which four processes write."},
    {"vdwmesh-mpi-exact", "mpirun -n 4 vdwmesh-mpi exact --sample ubiquitin --per-atom atoms.csv",
     "Areas and volumes by atom."}};

constexpr const char* kStatuses = R"(.SH EXIT STATUS
.TP
.B 0
All is done.
.TP
.B 1
The input or an option is wrong.
.TP
.B 2
A backend or device that was asked for is not there.
.TP
.B 3
A limit was hit: memory, or numbers that indices can hold.
.TP
.B 4
An internal error of the program.
.TP
.B 130, 143
It was ended by SIGINT or SIGTERM.
.PP
An error is one line on standard error that says what, where and what would work.
)";

// Text for troff. A hyphen is a minus, which readers can copy into a shell. A dot or apostrophe at
// the beginning of a line would be a command.
std::string troff(std::string_view text) {
  static const std::map<char, std::string_view> escapes{
      {'\\', "\\(rs"}, {'-', "\\-"},   {'\'', "\\(aq"}, {'`', "\\(ga"},
      {'^', "\\(ha"},  {'~', "\\(ti"}, {'"', "\\(dq"}};
  std::string line = text.starts_with('.') ? "\\&" : "";
  for (const char c : text) {
    const auto escape = escapes.find(c);
    line += escape == escapes.end() ? std::string(1, c) : std::string(escape->second);
  }
  return line;
}

// A term, and below it indented what it means.
std::string entry(std::string_view term, std::string_view meaning) {
  return fmt::format(".TP\n\\fB{}\\fR\n{}\n", term, troff(meaning));
}

std::string page_name(const Program& program, const Verb& verb) {
  return fmt::format("{}-{}", program.name, verb.name);
}

std::string options_section(const std::vector<OptionGroup>& groups) {
  std::string text = ".SH OPTIONS\n";
  for (const OptionGroup& group : groups) {
    text += fmt::format(".SS {}\n", troff(group.title));
    for (const Option& option : group.options) {
      std::string term = troff(option.short_name());
      if (option.short_name() != option.long_name())
        term += "\\fR, \\fB" + troff(option.long_name());
      if (!option.reader.value.empty()) term += "\\fR \\fI" + troff(option.reader.value);
      text += entry(term, meaning(option));
    }
  }
  return text + ".SS Help\n" + entry("\\-h\\fR, \\fB\\-\\-help", "print the options");
}

// A page with its own sections between those that all pages have.
std::string man_page(const Program& program, std::string_view page, std::string_view summary,
                     std::string_view synopsis, std::string_view sections) {
  std::string capitals(page);
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string text = fmt::format(
      ".\\\" -*- coding: UTF-8 -*-\n.TH {} 1 \"\" \"vdwmesh {}\" \"vdwmesh\"\n"
      ".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.nf\n{}\n.fi\n{}{}",
      troff(capitals), kVersion, troff(page), troff(summary), troff(synopsis), sections, kStatuses);
  std::string examples;
  for (const Example& example : kExamples) {
    if (example.page == page) examples += entry(troff(example.command), example.meaning);
  }
  if (!examples.empty()) text += ".SH EXAMPLES\n" + examples;
  std::vector<std::string> names{std::string(program.name)};
  for (const Verb& verb : program.verbs) names.push_back(page_name(program, verb));
  std::erase(names, page);
  for (std::string& name : names) name = fmt::format(".BR {} (1)", troff(name));
  return text + fmt::format(".SH SEE ALSO\n{}\n", fmt::join(names, ",\n"));
}

// The completion is a function around a table of verbs, their options and the values of these. Bash
// ends words at "=", so `--field` with a value behind it comes as three; in zsh it is one.
constexpr const char* kFunction = R"({0}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}
  local verb=${{COMP_WORDS[1]}} kind='' words='' prefix='' line=''
  COMPREPLY=()
  if [[ $word == '=' ]]; then
    word=''
  elif [[ $before == '=' && $COMP_CWORD -gt 2 ]]; then
    before=${{COMP_WORDS[COMP_CWORD-2]}}
  elif [[ $word == --*=* ]]; then
    before=${{word%%=*}} prefix=${{word%%=*}}= word=${{word#*=}}
  fi
  if [[ $COMP_CWORD -eq 1 ]]; then
    kind=words words='{1} --help --version'
  else
    case "$verb $before" in
{2}    esac
    if [[ -z $kind ]]; then
      case $verb in
{3}      esac
      if [[ $word == -* ]]; then kind=words; else words=''; fi
    fi
  fi
  if [[ $kind == list && $word == *,* ]]; then prefix+=${{word%,*}}, word=${{word##*,}}; fi
  case $kind in
    list | words) words=$(compgen -P "$prefix" -W "$words" -- "$word") ;;
    file) words=$(compgen -P "$prefix" -W "$words" -- "$word"; compgen -P "$prefix" -f -- "$word") ;;
    folder) words=$(compgen -P "$prefix" -d -- "$word") ;;
    *) words='' ;;
  esac
  if [[ $kind == file || $kind == folder ]]; then compopt -o filenames 2>/dev/null; fi
  while IFS= read -r line; do
    if [[ -n $line ]]; then COMPREPLY+=("$line"); fi
  done <<< "$words"
}}
)";

// What a shell offers for the value of an option: nothing, one of some words, several of them with
// commas between, a file or a folder. It is told from what --help writes for the value.
std::string_view completion_kind(const Option& option) {
  const std::string_view value = option.reader.value;
  if (value.ends_with(",...")) return "list";
  if (value.find("FOLDER") != value.npos) return "folder";
  const bool is_file = option.reader.use != Use::none || value.find("FILE") != value.npos;
  return is_file ? "file" : "words";
}

std::string completion(const Program& program, const std::string& function) {
  std::vector<std::string_view> verbs;
  std::string values, options;
  for (const Verb& verb : program.verbs) {
    verbs.push_back(verb.name);
    Draft draft;
    std::string names, kind = "words";
    for (const OptionGroup& group : options_of(verb.bit, draft)) {
      for (const Option& option : group.options) {
        if (option.is_positional()) kind = "file";
        if (option.is_positional()) continue;
        names += fmt::format("{} ", option.long_name());
        if (option.is_flag()) continue;
        values += fmt::format("      '{0} {1}' | '{0} {2}') kind={3} words='{4}' ;;\n", verb.name,
                              option.long_name(), option.short_name(), completion_kind(option),
                              fmt::join(option.reader.words, " "));
      }
    }
    options += fmt::format("        {}) kind={} words='{}--help' ;;\n", verb.name, kind, names);
  }
  return fmt::format(fmt::runtime(kFunction), function, fmt::join(verbs, " "), values, options);
}

void write_manual(const Program& program, const std::filesystem::path& folder) {
  const std::string name(program.name);
  const auto write_page = [&](const std::string& page, std::string_view summary,
                              const std::string& synopsis, const std::string& sections) {
    write_file(folder / "man1" / (page + ".1"),
               man_page(program, page, summary, synopsis, sections));
  };
  std::string sections =
      ".SH DESCRIPTION\nEach verb has its own page, which lists its options. "
      "Lengths are in Å, areas in Å², volumes in Å³.\n.SH VERBS\n";
  for (const Verb& verb : program.verbs) sections += entry(troff(verb.name), verb.summary);
  write_page(name, program.summary,
             fmt::format("{0} VERB [OPTION...]\n{1} VERB --help\n{1} --version", program.usage_name,
                         program.name),
             sections);
  for (const Verb& verb : program.verbs) {
    Draft draft;
    const std::vector<OptionGroup> groups = options_of(verb.bit, draft);
    write_page(page_name(program, verb), verb.summary, synopsis(program, verb, groups),
               options_section(groups));
  }
  std::string function = "_" + name + "_words";
  std::ranges::replace(function, '-', '_');
  const std::string words = completion(program, function);
  write_file(folder / "bash" / name, fmt::format("{}complete -F {} {}\n", words, function, name));
  // zsh has a layer for completions of bash, which it loads at the first call.
  write_file(folder / "zsh" / ("_" + name),
             fmt::format("#compdef {}\nautoload -U bashcompinit\nbashcompinit\n{}"
                         "_bash_complete -F {}\n",
                         name, words, function));
}

void write_manuals(int argc, const char* const* argv) {
  refuse_if(argc < 2, "vdwmesh_manual: name the folder that the pages are written to");
  const std::filesystem::path folder = argv[1];
  for (const char* part : {"man1", "bash", "zsh"}) {
    std::filesystem::remove_all(folder / part);
    std::filesystem::create_directories(folder / part);
  }
  write_manual(plain_program(), folder);
  if (argc < 3 || std::string_view(argv[2]) != "--ranks") return;
  const std::vector<Verb> verbs = rank_verbs({}, {});
  write_manual(rank_program(verbs, 1), folder);
}

}  // namespace
}  // namespace vdwmesh::apps

int main(int argc, char** argv) {
  using namespace vdwmesh::apps;
  const Outcome outcome = outcome_of([&] { write_manuals(argc, argv); });
  if (outcome.status != kDone)
    std::fprintf(stderr, "vdwmesh_manual: %s\n", outcome.message.c_str());
  return outcome.status;
}
