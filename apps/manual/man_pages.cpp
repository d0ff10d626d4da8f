// Man pages: one of the program, which lists its verbs, and one of each verb, which lists its
// options by group. Text is written in ASCII, other characters by their number, so that a page
// looks the same however it is read; what troff takes for commands is escaped.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "command_line/help.hpp"
#include "manual/manual.hpp"

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
    {"vdwmesh-mesh", "vdwmesh mesh --sample bpti -o excluded.ply --surface excluded",
     "The solvent-excluded surface."},
    {"vdwmesh-report", "vdwmesh report --sample bpti --json bpti.json --per-atom bpti.csv",
     "The report as text and as JSON, and areas and volumes by atom."},
    {"vdwmesh-exact", "vdwmesh exact --sample ubiquitin --probe 1.4",
     "Area and volume of the solvent-accessible surface, and its topology."},
    {"vdwmesh-exact",
     "vdwmesh exact --sample ubiquitin --probe 1.4 --radii protor --per-atom - --group residue",
     "How exposed each residue is."},
    {"vdwmesh-compare", "vdwmesh compare ubiquitin.ply --sample ubiquitin",
     "A mesh of any program against the exact union of spheres."},
    {"vdwmesh-render", "vdwmesh render --sample bpti -o bpti.png --view top",
     "A picture, without a display."},
    {"vdwmesh-study", "vdwmesh study --sample bpti -o study --spacing 1,0.5 --field vdw",
     "Errors against grid spacing, as tables and as a page."},
    {"vdwmesh-batch", "vdwmesh batch FOLDER -o rows.csv --probe 1.4",
     "Area and volume of all structures of a folder."},
    {"vdwmesh-bench-thesis", "vdwmesh bench thesis --structures FOLDER --table 4.1",
     "One table of the thesis, rerun."},
    {"vdwmesh-bench-pipeline", "vdwmesh bench pipeline --sample ubiquitin --repeat 1",
     "What each stage costs."},
    {"vdwmesh-info", "vdwmesh info", "What this program can compute and draw on."},
    {"vdwmesh-mpi", "mpirun -n 4 vdwmesh-mpi exact --sample ubiquitin",
     "The exact measures by four processes."},
    {"vdwmesh-mpi-mesh", "mpirun -n 4 vdwmesh-mpi mesh --sample ubiquitin -o ubiquitin.ply",
     "One mesh file, which four processes write."},
    {"vdwmesh-mpi-exact", "mpirun -n 4 vdwmesh-mpi exact --sample ubiquitin --per-atom atoms.csv",
     "Areas and volumes by atom."}};

constexpr std::pair<std::string_view, std::string_view> kStatuses[] = {
    {"0", "All is done."},
    {"1", "The input or an option is wrong."},
    {"2", "A backend or device that was asked for is not there."},
    {"3", "A limit was hit: memory, or numbers that indices can hold."},
    {"4", "An internal error of the program."},
    {"130, 143", "It was ended by SIGINT or SIGTERM."}};

// The number of the character whose bytes of UTF-8 begin at `first`, which is moved behind them.
unsigned long take_character(std::string_view text, std::size_t& first) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text.at(i)); };
  const unsigned lead = byte(first++);
  const int more = lead < 0x80 ? 0 : lead < 0xE0 ? 1 : lead < 0xF0 ? 2 : 3;
  unsigned long number = more == 0 ? lead : lead & (0x3Fu >> more);
  for (int i = 0; i < more; ++i) number = number << 6 | (byte(first++) & 0x3Fu);
  return number;
}

// A hyphen is a minus, which readers can copy into a shell. A dot or apostrophe at the beginning of
// a line would be a command.
std::string troff(std::string_view text) {
  std::string line = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (std::size_t i = 0; i < text.size();) {
    const unsigned long c = take_character(text, i);
    switch (c) {
      case '\\':
        line += "\\(rs";
        break;
      case '-':
        line += "\\-";
        break;
      case '\'':
        line += "\\(aq";
        break;
      case '`':
        line += "\\(ga";
        break;
      case '^':
        line += "\\(ha";
        break;
      case '~':
        line += "\\(ti";
        break;
      case '"':
        line += "\\(dq";
        break;
      default:
        line += c < 0x80 ? std::string(1, static_cast<char>(c)) : fmt::format("\\[u{:04X}]", c);
    }
  }
  return line;
}

std::string bold(std::string_view text) { return fmt::format("\\fB{}\\fR", troff(text)); }
std::string italic(std::string_view text) { return fmt::format("\\fI{}\\fR", troff(text)); }

// A term, and below it indented what it means.
std::string entry(const std::string& term, std::string_view meaning) {
  return fmt::format(".TP\n{}\n{}\n", term, troff(meaning));
}

std::string head(std::string_view page, std::string_view summary, std::string_view version) {
  std::string capitals(page);
  std::ranges::transform(capitals, capitals.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return fmt::format(".TH {} 1 \"\" \"vdwmesh {}\" \"vdwmesh\"\n.SH NAME\n{} \\- {}\n",
                     troff(capitals), version, troff(page), troff(summary));
}

std::string synopses(std::initializer_list<std::string> lines) {
  std::string text = ".SH SYNOPSIS\n.nf\n";
  for (const std::string& line : lines) text += troff(line) + '\n';
  return text + ".fi\n";
}

// "\-o, \-\-output FILE", names bold and what stands for the value italic.
std::string names_and_value(const Option& option) {
  const std::string name = option.short_name();
  std::string term = option.is_positional() ? italic(name) : bold(name);
  if (option.long_name() != name) term += ", " + bold(option.long_name());
  return option.reader.value.empty() ? term : term + ' ' + italic(option.reader.value);
}

std::string options(const std::vector<OptionGroup>& groups) {
  std::string text = ".SH OPTIONS\n";
  for (const OptionGroup& group : groups) {
    text += fmt::format(".SS {}\n", troff(group.title));
    for (const Option& option : group.options) {
      text += entry(names_and_value(option), meaning(option));
    }
  }
  return text + ".SS Help\n" + entry(bold("-h") + ", " + bold("--help"), "print the options");
}

std::string statuses() {
  std::string text = ".SH EXIT STATUS\n";
  for (const auto& [status, meaning] : kStatuses) text += entry(bold(status), meaning);
  return text +
         ".PP\nAn error is one line on standard error that says what, where and what would "
         "work.\n";
}

std::string examples(std::string_view page) {
  std::string text;
  for (const Example& example : kExamples) {
    if (example.page != page) continue;
    text += entry(bold(example.command), example.meaning);
  }
  return text.empty() ? "" : ".SH EXAMPLES\n" + text;
}

std::string see_also(const ListedProgram& listed, std::string_view page) {
  std::vector<std::string> names{std::string(listed.program.name)};
  for (const ListedVerb& verb : listed.verbs) {
    names.push_back(page_name(listed.program, *verb.verb));
  }
  std::erase(names, page);
  std::string text = ".SH SEE ALSO\n";
  for (const std::string& name : names) {
    text += fmt::format(".BR {} (1){}\n", troff(name), &name == &names.back() ? "" : ",");
  }
  return text;
}

}  // namespace

std::string man_page(const ListedProgram& listed, std::string_view version) {
  const Program& program = listed.program;
  std::string text =
      head(program.name, program.summary, version) +
      synopses({fmt::format("{} VERB [OPTION...]", program.usage_name),
                fmt::format("{} VERB --help", program.name),
                fmt::format("{} --version", program.name)}) +
      ".SH DESCRIPTION\nEach verb has its own page, which lists its options. Lengths "
      "are in \\[u00C5], areas in \\[u00C5]\\[u00B2], volumes in "
      "\\[u00C5]\\[u00B3].\n.SH VERBS\n";
  for (const ListedVerb& verb : listed.verbs) {
    text += entry(bold(verb.verb->name), verb.verb->summary);
  }
  return text + statuses() + examples(program.name) + see_also(listed, program.name);
}

std::string man_page(const ListedProgram& listed, const ListedVerb& verb,
                     std::string_view version) {
  const std::string page = page_name(listed.program, *verb.verb);
  return head(page, verb.verb->summary, version) +
         synopses({synopsis(listed.program, *verb.verb, verb.groups)}) + options(verb.groups) +
         statuses() + examples(page) + see_also(listed, page);
}

}  // namespace vdwmesh::apps
