// The list of all options of the program. Parsing, --help and suggestions are made from it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command_line/command_line.hpp"
#include "command_line/readers.hpp"
#include "named_files.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {

// What happens where an option is not given.
struct Absence {
  enum class Meaning { nothing, value, words, error };
  Meaning meaning = Meaning::nothing;
  std::string text;  // value: is read as if it had been given; words: what then holds, for --help;
                     // error: what to do about it
};

inline Absence no_default() { return {Absence::Meaning::nothing, ""}; }
inline Absence by_default(std::string value) { return {Absence::Meaning::value, std::move(value)}; }
inline Absence otherwise(std::string words) { return {Absence::Meaning::words, std::move(words)}; }
inline Absence required(std::string advice) { return {Absence::Meaning::error, std::move(advice)}; }

struct Option {
  std::string name;  // "--spacing"; "-o,--output"; "INPUT", without dashes, by its place
  VerbSet verbs;     // that take it
  Reader reader;
  std::string help;
  Absence absence = {};
  std::string other = {};  // the option that does not go with this one, and stands in for it where
                           // this one is required

  // As messages call it: the first of its names.
  std::string short_name() const { return name.substr(0, name.find(',')); }
  // Which may be a slip of somebody's fingers: the last.
  std::string_view long_name() const {
    return std::string_view(name).substr(name.find(',') + 1);  // npos + 1 is 0
  }
  bool is_positional() const { return name[0] != '-'; }
  bool is_flag() const { return !is_positional() && reader.value.empty(); }
};

struct OptionGroup {
  std::string title;
  std::vector<Option> options;
};

// The options while they are read, and what is not in its place until all of them are.
struct Draft {
  VerbSet verb = 0;
  std::uint64_t processes = 1;  // as in Program
  Options options;
  std::vector<std::string> paths, samples;
  ReadOptions read;
  std::optional<Inclusion> hetero_atoms;
  MeshRequest mesh;  // its surface is that of `measure`
  MeasureRequest measure;
  std::optional<std::uint64_t> memory_limit;  // bytes
  NamedFiles files;
  std::vector<std::pair<std::string, std::string>> given;  // name and group, in the list's order
};

// How much of the list is meant. What is turned by measurements of the authors alone, and older
// names that scripts may have, are read and not shown.
enum class Extent { usual, shown, read };

// The options of all verbs by group, in the order of --help; their readers fill `draft`.
std::vector<OptionGroup> all_options(Draft& draft);
// Those of one verb; groups without any are left out.
std::vector<OptionGroup> options_of(VerbSet verb, Draft& draft, Extent extent = Extent::shown);

// The verbs that take more than one INPUT.
inline constexpr VerbSet kSeveralInputs = kStudy;
// The verbs that take one, those of ranks among them; and all that read structures.
inline constexpr VerbSet kRanks = kRanksMesh | kRanksExact;
inline constexpr VerbSet kOneInput =
    kMesh | kReport | kExact | kInterface | kCompare | kRender | kPockets | kView | kRanks;
inline constexpr VerbSet kStructures = kOneInput | kSeveralInputs | kBatch;
// Groups whose options mean nothing in places.
inline constexpr const char *kInputGroup = "Input", *kSurfaceGroup = "Surface",
                            *kPictureGroup = "Picture";

// Puts everything in its place. Throws InvalidInput where options do not go together.
void settle(Draft& draft);

}  // namespace vdwmesh::apps
