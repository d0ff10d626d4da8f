// What man pages and completions need of the lists: the options of every verb, names of pages, and
// the kind of an option's value, which is told from what --help writes for it (FILE, FOLDER, a list
// with commas) and from whether it is a file that is read or written.
#include "manual/manual.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace vdwmesh::apps {

ListedProgram list_of(const Program& program, Draft& draft) {
  ListedProgram listed{program, {}};
  for (const Verb& verb : program.verbs) {
    listed.verbs.push_back({&verb, options_of(verb.bit, draft)});
  }
  return listed;
}

std::string page_name(const Program& program, const Verb& verb) {
  std::string name = fmt::format("{}-{}", program.name, verb.name);
  std::ranges::replace(name, ' ', '-');
  return name;
}

std::string function_name(const Program& program) {
  std::string name = fmt::format("_{}", program.name);
  std::ranges::replace(name, '-', '_');
  return name;
}

ValueKind value_kind(const Option& option) {
  const std::string_view value = option.reader.value;
  if (option.is_flag()) return ValueKind::none;
  if (value.ends_with(",...")) return ValueKind::words;
  if (value.find("FOLDER") != value.npos) return ValueKind::folder;
  const bool is_file = option.reader.use != Use::none || value.find("FILE") != value.npos;
  return is_file ? ValueKind::file : ValueKind::word;
}

}  // namespace vdwmesh::apps
