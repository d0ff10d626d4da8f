// What other programs call the options and verbs of this one, and the command to type instead.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vdwmesh::apps {

// The word as a shell takes it: between quotes where it has characters that mean something there.
std::string in_shell(const std::string& word);

// "; type: vdwmesh exact 1UBQ.pdb --probe 1.4" for words that have --probe-radius in place of
// --probe; with a reason before that for an option that is left out; empty for others.
// `command` is the program and the verb, `words` follow it, `unknown` is the option among them, and
// `known` are the options of the verb.
std::string advice_on_option(std::string_view command, const std::vector<std::string>& words,
                             std::string_view unknown, std::span<const std::string_view> known);

// What to do where --format names the form of a table, report or mesh; empty for other forms.
std::string advice_on_format(std::string_view command, std::vector<std::string> words,
                             const std::string& format, std::span<const std::string_view> known);

// The options of a verb.
using OptionsOfVerb = std::function<std::vector<std::string_view>(std::string_view verb)>;

// The same for the first word, which is no verb; `words` follow it, and their options are said as
// the verb in its place knows them.
std::string advice_on_verb(std::string_view program, const std::vector<std::string>& words,
                           std::string_view unknown, const OptionsOfVerb& known_of);

// What to type in Python where one of the words is a trajectory (.xtc .trr .dcd .nc) and another
// one its structure or topology; empty if none is a trajectory. The line is whole, without a
// beginning.
std::string advice_on_trajectory(const std::vector<std::string>& words);

}  // namespace vdwmesh::apps
