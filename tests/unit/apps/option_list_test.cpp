// The list of options by itself: what parsing, help and suggestions take for granted of it; and
// which names are taken for a slip of the fingers.
#include "command_line/option_list.hpp"

#include <gmock/gmock.h>

#include <set>

namespace vdwmesh::apps {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Not;

std::vector<Option> options_in(const std::vector<OptionGroup>& groups) {
  std::vector<Option> all;
  for (const OptionGroup& group : groups) {
    all.insert(all.end(), group.options.begin(), group.options.end());
  }
  return all;
}

TEST(OptionList, AVerbHasEachOptionOnce) {
  for (const Verb& verb : plain_program().verbs) {
    Draft draft;
    std::set<std::string> names;
    for (const Option& option : options_in(options_of(verb.bit, draft, Extent::read))) {
      EXPECT_TRUE(names.insert(option.short_name()).second) << verb.name << ' ' << option.name;
    }
    const std::set<std::string_view> others{"render", "study", "batch", "view"};
    const bool has_report = !others.contains(verb.name);
    EXPECT_THAT(names, Contains("--json").Times(has_report ? 1 : 0));
  }
}

TEST(OptionList, WhatDoesNotGoTogetherBelongsToTheSameVerb) {
  for (const Verb& verb : plain_program().verbs) {
    Draft draft;
    const std::vector<Option> options = options_in(options_of(verb.bit, draft, Extent::read));
    std::vector<std::string> names;
    for (const Option& option : options) names.push_back(option.short_name());
    for (const Option& option : options) {
      if (option.other.empty()) continue;
      EXPECT_THAT(names, Contains(option.other)) << verb.name;
    }
  }
}

TEST(OptionList, EveryOptionSaysWhatItIsFor) {
  Draft draft;
  for (const Option& option : options_in(all_options(draft))) {
    EXPECT_NE(option.verbs, 0u) << option.name;
    EXPECT_THAT(option.help, Not(IsEmpty())) << option.name;
    const bool says_nothing = option.absence.meaning == Absence::Meaning::nothing;
    EXPECT_EQ(option.absence.text.empty(), says_nothing) << option.name;
  }
}

TEST(OptionList, DefaultsAreValuesOfTheirOptions) {
  Draft draft;
  for (const Option& option : options_in(all_options(draft))) {
    if (option.absence.meaning != Absence::Meaning::value) continue;
    EXPECT_NO_THROW(option.reader.read(option.short_name(), option.absence.text)) << option.name;
  }
  EXPECT_EQ(draft.measure.surface, SurfaceChoice::vdw);
}

TEST(OptionList, WhatCompletionOffersIsAValueOfTheOption) {
  Draft draft;
  std::size_t count = 0;
  for (const Option& option : options_in(all_options(draft))) {
    for (const std::string_view word : option.reader.words) {
      EXPECT_NO_THROW(option.reader.read(option.short_name(), std::string(word)))
          << option.name << ' ' << word;
      ++count;
    }
    // A reader that says which names it accepts offers exactly these.
    if (option.reader.accepted.empty()) continue;
    EXPECT_EQ(list_names(option.reader.words), option.reader.accepted) << option.name;
  }
  EXPECT_GT(count, 100u);
}

std::string guess(std::string_view given) {
  const std::string_view known[] = {"--spacing", "--padding", "vdw", "cpu", "on",
                                    "off",       "seed",      "4.1", "4.2"};
  return suggestion(given, known);
}

TEST(Suggestion, NamesTheSlipOfAFinger) {
  EXPECT_EQ(guess("--spcing"), "; did you mean --spacing?");
  EXPECT_EQ(guess("--spaccing"), "; did you mean --spacing?");
  EXPECT_EQ(guess("--spaicng"), "; did you mean --spacing?");
  EXPECT_EQ(guess("--pading"), "; did you mean --padding?");
  EXPECT_EQ(guess("vwd"), "; did you mean vdw?");
  EXPECT_EQ(guess("sead"), "; did you mean seed?");
}

TEST(Suggestion, IsSilentWhereNothingIsClose) {
  for (const char* given : {"", "x", "--x", "--frobnicate", "gpu", "sleep", "--speaking-clock"}) {
    EXPECT_EQ(guess(given), "") << given;
  }
}

TEST(Suggestion, IsSilentWhereTwoAreAsClose) {
  EXPECT_EQ(guess("of"), "");
  EXPECT_EQ(guess("4.6"), "");
}

}  // namespace
}  // namespace vdwmesh::apps
