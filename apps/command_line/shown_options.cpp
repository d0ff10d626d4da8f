// Which entries of the list a verb takes, and which of them help shows.
#include <algorithm>
#include <string_view>

#include "command_line/option_list.hpp"

namespace vdwmesh::apps {
namespace {

// What --help lists of verbs that take structures; --help-all lists the others too.
constexpr std::string_view kUsual[] = {"--mesher",      "--subdivide",    "--repeat",  "--csv",
                                       "MESH",          "INPUT",          "--sample",  "--radii",
                                       "--probe",       "--assembly",     "--select",  "--surface",
                                       "--edge-length", "--spacing",      "--measure", "--topology",
                                       "--picture",     "--color",        "--json",    "-o",
                                       "--per-atom",    "--voids",        "--verb",    "--backend",
                                       "--threads",     "--memory-limit", "--verbose"};

// Options of verbs that take structures which are read and not shown.
constexpr std::string_view kUnseen[] = {"--csv",          "--hetatm",        "--preset",
                                        "--isovalue",     "--blobbiness",    "--crossings",
                                        "--seed",         "--cgal-check",    "--devices",
                                        "--camera",       "--shading",       "--antialias",
                                        "--rows",         "--time-limit",    "--page-triangles",
                                        "--edge-lengths", "--relative-edge", "--padding",
                                        "--progress",     "--project",       "--scan",
                                        "--shell",        "--from",          "--sums",
                                        "--method",       "--write",         "--b-factor",
                                        "--rsa",          "--max-distance",  "--ascii",
                                        "--transparency", "--outline",       "--ambient-occlusion",
                                        "--scale",        "--mesh"};

bool is_unseen(const Option& option) {
  return (option.verbs & kStructures) && std::ranges::count(kUnseen, option.short_name()) > 0;
}

bool is_within(const Option& option, Extent extent) {
  if (extent == Extent::read) return true;
  const bool is_usual = std::ranges::count(kUsual, option.short_name()) > 0;
  return !is_unseen(option) && (extent == Extent::shown || is_usual);
}

}  // namespace

// Verbs without a structure have few options, which are all usual.
std::vector<OptionGroup> options_of(VerbSet verb, Draft& draft, Extent extent) {
  std::vector<OptionGroup> groups = all_options(draft);
  if (extent == Extent::usual && !(verb & kStructures)) extent = Extent::shown;
  for (OptionGroup& group : groups) {
    std::erase_if(group.options, [&](const Option& option) {
      return !(option.verbs & verb) || !is_within(option, extent);
    });
  }
  std::erase_if(groups, [](const OptionGroup& group) { return group.options.empty(); });
  return groups;
}

}  // namespace vdwmesh::apps
