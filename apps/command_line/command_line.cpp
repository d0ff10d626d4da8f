// Reads the command line in three steps: which verb it names, which texts its options have, and
// what these mean. CLI11 does the second alone: it splits words into options and values, and knows
// nothing of what they mean. Every refusal is worded here or where a value is read, one line that
// says what, where and what would work.
#include "command_line/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>

#include "build_id.hpp"
#include "command_line/help.hpp"
#include "command_line/option_list.hpp"
#include "command_line/other_words.hpp"
#include "core/errors.hpp"
#include "mesh/mesh_io.hpp"
#include "report/output.hpp"
#include "request/refuse.hpp"
#include "structure/reader.hpp"

namespace vdwmesh::apps {
namespace {

using Words = std::vector<std::string>;
using WordViews = std::vector<std::string_view>;

constexpr std::string_view kHelpOfAll = "--help-all";

bool asks_for_all(const Words& words) { return std::ranges::count(words, kHelpOfAll) > 0; }

bool asks_for_help(const Words& words) {
  const auto is_help = [](const std::string& word) { return word == "--help" || word == "-h"; };
  return std::ranges::any_of(words, is_help) || asks_for_all(words);
}

WordViews names_of(const std::vector<OptionGroup>& groups) {
  WordViews names;
  for (const OptionGroup& group : groups) {
    for (const Option& option : group.options) names.push_back(option.long_name());
  }
  return names;
}

// The verb that the first word names; it is taken off.
const Verb& take_verb(const Program& program, Words& words) {
  const std::string given = words.empty() ? "" : words[0];
  const auto verb = std::ranges::find(program.verbs, given, &Verb::name);
  refuse_if(given == "bench", "bench: is a program of its own, vdwmesh-bench (bench/README.md)");
  if (verb == program.verbs.end()) {
    const std::string frames = advice_on_trajectory(words);
    if (!frames.empty()) throw InvalidInput(frames);
    WordViews known;
    for (const Verb& one : program.verbs) known.push_back(one.name);
    Draft draft;
    std::vector<OptionGroup> groups;  // whose names are looked at
    const auto known_of = [&](std::string_view name) {
      const auto meant = std::ranges::find(program.verbs, name, &Verb::name);
      if (meant != program.verbs.end()) groups = options_of(meant->bit, draft, Extent::read);
      return names_of(groups);
    };
    const std::string advice = advice_on_verb(
        program.name, {words.begin() + (words.empty() ? 0 : 1), words.end()}, given, known_of);
    refuse_if(!advice.empty(), "{}: not a verb{}", given, advice);
    const std::string what =
        given.empty() ? "VERB: missing" : given + ": not a verb" + suggestion(given, known);
    // A file alone is what people type who do not know verbs yet.
    const std::string example = has_structure_extension(given)
                                    ? fmt::format(", for example {} exact {}", program.name, given)
                                    : "";
    throw InvalidInput(fmt::format("{}; the verbs are {}{}; {} --help says what each does", what,
                                   fmt::join(known, " "), example, program.name));
  }
  words.erase(words.begin());
  return *verb;
}

// Help and version without a verb. Whether that was asked for.
bool answer_without_verb(const Program& program, const Words& words) {
  if (!words.empty() && words[0] == "--version") {
    write_standard_output(
        fmt::format("{} {} ({})\nbuild {}\n", program.name, kVersion, kRevision, kBuild));
  } else if (!words.empty() && asks_for_help({words[0]})) {
    write_standard_output(verbs_help(program));
  } else {
    return false;
  }
  return true;
}

// The words of one verb: split by CLI11, then read in the order of the list, so that of several
// faults the same one is named whatever the order of the words.
class Reading {
 public:
  Reading(const Program& program, const Verb& verb, const std::vector<OptionGroup>& groups)
      : program_(program), verb_(verb), groups_(groups) {
    app_.set_help_flag();
    app_.allow_extras();
    for (const OptionGroup& group : groups) {
      for (const Option& option : group.options) add(option);
    }
  }

  // CLI11 leaves what it does not know; which word that is, and what may have been meant, is said
  // here.
  void split(Words words) {
    words_ = words;
    std::ranges::for_each(words, [this](const std::string& word) { refuse_empty_value(word); });
    std::ranges::reverse(words);  // as CLI11 takes them
    try {
      app_.parse(words);
    } catch (const CLI::ArgumentMismatch& error) {
      const std::string_view what = error.what();
      const std::string typed = with_dashes();
      refuse("{}: its value is missing{}", what.substr(0, what.find(':')),
             typed.empty() ? see_help() : typed);
    } catch (const CLI::ParseError& error) {
      refuse("{}{}", error.what(), see_help());
    }
    for (const std::string& word : app_.remaining()) {
      if (word != "--") refuse_word(word);
    }
  }

  // Fills the draft that the options read into.
  void read(Draft& draft) const {
    for (const OptionGroup& group : groups_) {
      for (const Option& option : group.options) {
        const std::string name = option.short_name();
        if (!is_given(name)) {
          read_absent(option);
          continue;
        }
        draft.given.emplace_back(name, group.title);
        read_given(option, draft.files);
      }
    }
  }

 private:
  // Every text that is given is kept: whether an option may be repeated is for its reader to say.
  void add(const Option& option) {
    CLI::Option* added =
        option.is_flag() ? app_.add_flag(option.name) : app_.add_option(option.name);
    added->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    if (option.is_positional() && option.reader.times == Times::often) added->expected(-1);
    added_[option.short_name()] = added;
  }

  bool is_given(const std::string& name) const { return added_.at(name)->count() > 0; }

  // CLI11 takes the word behind "--json=" for its value.
  void refuse_empty_value(const std::string& word) const {
    if (!word.starts_with('-') || !word.ends_with('=')) return;
    const std::string name = word.substr(0, word.size() - 1);
    if (app_.get_option_no_throw(name) != nullptr) refuse_empty(name);
  }

  // Most likely a variable of a script that was not set.
  [[noreturn]] static void refuse_empty(const std::string& name) {
    refuse("{}: its value is empty; give one, or leave the option out", name);
  }

  // Files are accounted for as they come, so that a clash names the two options.
  void read_given(const Option& option, NamedFiles& files) const {
    const std::string name = option.short_name();
    const std::vector<std::string>& texts = added_.at(name)->results();
    if (option.is_flag() && texts[0] != "true") throw InvalidInput(name + ": takes no value");
    if (option.reader.times == Times::once) check_once(option, texts.size());
    for (const std::string& text : texts) {
      if (text.empty()) refuse_empty(name);
      if (option.reader.use == Use::reads) files.add_input(name, text);
      if (option.reader.use == Use::writes) files.add_output(name, text);
      if (name == "--format") refuse_other_format(text);
      option.reader.read(name, text);
    }
  }

  void check_once(const Option& option, std::size_t times) const {
    const std::string name = option.short_name();
    if (times > 1 && !option.is_flag()) throw InvalidInput(name + ": is given more than once");
    if (option.other.empty() || !is_given(option.other)) return;
    refuse("{} and {}: give only one of them", name, option.other);
  }

  // A default is read as if it had been typed: what --help says and what happens cannot differ.
  void read_absent(const Option& option) const {
    const std::string name = option.short_name();
    const auto& [meaning, text] = option.absence;
    if (meaning == Absence::Meaning::value) option.reader.read(name, text);
    if (meaning != Absence::Meaning::error) return;
    if (!option.other.empty() && is_given(option.other)) return;
    const std::string typed = name == "INPUT" ? with_dashes() : "";
    refuse_if(!typed.empty(), "no {}: the structure stands where a file to write is named{}", name,
              typed);
    refuse("no {}: {}", name, text);
  }

  // Whether the word is an option of a file for which - is standard output.
  bool can_print(const std::string& word) const {
    return std::ranges::any_of(groups_, [&](const OptionGroup& group) {
      return std::ranges::any_of(group.options, [&](const Option& option) {
        return (word == option.short_name() || word == option.long_name()) &&
               option.reader.use == Use::writes &&
               option.help.find("standard output") != std::string::npos;
      });
    });
  }

  // "; type: vdwmesh exact 1UBQ.pdb --json -" where no file stands behind --json, or the structure;
  // empty if that is nowhere so.
  std::string with_dashes() const {
    std::vector<std::string> typed;
    for (std::size_t i = 0; i < words_.size(); ++i) {
      typed.push_back(in_shell(words_[i]));
      const std::string next = i + 1 < words_.size() ? words_[i + 1] : "--";
      const bool is_file = next == "-" || !(next.starts_with('-') || has_structure_extension(next));
      if (can_print(words_[i]) && !is_file) typed.emplace_back("-");
    }
    if (typed.size() == words_.size()) return "";
    return fmt::format("; type: {} {} {}", program_.name, verb_.name, fmt::join(typed, " "));
  }

  // Other programs have --format for what they write.
  void refuse_other_format(const std::string& text) const {
    const std::string advice = advice_on_format(fmt::format("{} {}", program_.name, verb_.name),
                                                words_, text, names_of(groups_));
    refuse_if(!advice.empty(), "--format {}: is that of the structure{}", text, advice);
  }

  [[noreturn]] void refuse_word(const std::string& word) const {
    const std::string frames = advice_on_trajectory(words_);
    if (!frames.empty()) throw InvalidInput(frames);
    const std::string name = word.substr(0, word.find('='));
    if (!name.starts_with('-')) {
      const std::string typed = with_dashes();
      refuse("{}: one argument too many{}", word, typed.empty() ? advice_on(word) : typed);
    }
    const WordViews known = names_of(groups_);
    const std::string advice =
        advice_on_option(fmt::format("{} {}", program_.name, verb_.name), words_, name, known);
    refuse_if(!advice.empty(), "{}: not an option of {} {}{}", name, program_.name, verb_.name,
              advice);
    const bool is_mesh = name == "-o" || name == "--output";
    refuse("{}: not an option of {} {}{}{}", name, program_.name, verb_.name,
           is_mesh ? fmt::format("; it writes no mesh, {} mesh does", program_.name)
                   : suggestion(name, known),
           see_help());
  }

  // What the name of a file that nobody asked for was most likely meant for.
  std::string advice_on(const std::string& word) const {
    const bool is_output = find_mesh_format(word) || word.ends_with(".png");
    if (is_output && added_.contains("-o")) return "; an output is named by -o FILE";
    if (has_structure_extension(word)) {
      const bool plain = std::ranges::all_of(words_, has_structure_extension);
      return plain && verb_.name == "exact"
                 ? advice_on_option(fmt::format("{} batch", program_.name), words_, "", {})
                 : "; vdwmesh batch takes many structures";
    }
    return see_help();
  }

  std::string see_help() const {
    return fmt::format("; {} {} --help-all lists the options", program_.name, verb_.name);
  }

  const Program& program_;
  const Verb& verb_;
  const std::vector<OptionGroup>& groups_;
  Words words_;  // as they were typed
  CLI::App app_;
  std::map<std::string, CLI::Option*> added_;
};

}  // namespace

// The readers hold references into the draft, which therefore stays where it is until all is read.
std::optional<Command> read_command_line(const Program& program, int argc,
                                         const char* const* argv) {
  Words words(argv + 1, argv + std::max(argc, 1));
  // Other programs take the word help before a verb, so people type it here too.
  if (!words.empty() && words[0] == "help") {
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  if (answer_without_verb(program, words)) return std::nullopt;
  const Verb& verb = take_verb(program, words);
  Draft draft;
  draft.verb = verb.bit;
  draft.processes = program.processes;
  if (asks_for_help(words)) {
    const Extent extent = asks_for_all(words) ? Extent::shown : Extent::usual;
    write_standard_output(
        verb_help(program, verb, options_of(verb.bit, draft, extent), options_of(verb.bit, draft)));
    return std::nullopt;
  }
  const std::vector<OptionGroup> groups = options_of(verb.bit, draft, Extent::read);
  Reading reading(program, verb, groups);
  reading.split(std::move(words));
  reading.read(draft);
  settle(draft);
  return Command{&verb, std::move(draft.options)};
}

}  // namespace vdwmesh::apps
