// What other programs call the options and verbs of this one, and the command to type instead.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vdwmesh::apps {

// "; type: vdwmesh exact 1UBQ.pdb --probe 1.4" for words that have --probe-radius in place of
// --probe; with a reason before that for an option that is left out; empty for others.
// `command` is the program and the verb, `words` follow it, `unknown` is the option among them, and
// `known` are the options of the verb.
std::string advice_on_option(std::string_view command, const std::vector<std::string>& words,
                             std::string_view unknown, std::span<const std::string_view> known);

// The same for the first word, which is no verb; `words` follow it.
std::string advice_on_verb(std::string_view program, const std::vector<std::string>& words,
                           std::string_view unknown);

}  // namespace vdwmesh::apps
