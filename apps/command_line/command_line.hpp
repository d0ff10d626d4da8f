// The command line, read and checked: which verb is to run, with which options.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "options.hpp"
#include "pockets/pockets.hpp"
#include "steps/picture_options.hpp"
#include "study/study_options.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {

// The page of a structure.
struct ViewChoice {
  std::string path;
  std::uint64_t most_triangles = 500'000;
};

// The options of all verbs. A verb finds its own filled in, and the others as they are here.
struct Options {
  std::vector<InputOptions> inputs;  // one, but for the verbs that take several
  std::string mesh_path;             // read by `compare`, written by `mesh`
  double mesh_scale = 1;             // lengths in the file that `mesh` writes, for 1 Å
  Switch ascii = Switch::off;        // whether `mesh` writes PLY and STL as text
  SurfaceOptions surface;
  SelfIntersections self_intersections = SelfIntersections::count;
  CgalCheck cgal_check = CgalCheck::small_meshes;
  ExactOptions exact;
  DistanceChoice distances;
  MachineOptions machine;
  PictureOptions picture;
  OutputOptions output;
  PocketQuery pocket_query;
  StudyOptions study;
  BatchChoice batch;
  PocketMeasures pocket_measures = PocketMeasures::exact;
  ViewChoice view;
};

struct Command {
  const Verb* verb;
  Options options;
};

// Nothing where --help or --version was asked for: that is printed. Throws InvalidInput for what is
// no verb, no option, no value of its option, or does not go together.
std::optional<Command> read_command_line(const Program& program, int argc, const char* const* argv);

}  // namespace vdwmesh::apps
