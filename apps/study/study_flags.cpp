#include "study/study_flags.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "parse.hpp"
#include "study/records.hpp"

namespace vdwmesh::apps {
namespace {

constexpr Choice<StudyProjection> kProjections[] = {{"own", StudyProjection::own},
                                                    {"vdw", StudyProjection::vdw},
                                                    {"field", StudyProjection::field},
                                                    {"none", StudyProjection::none}};
constexpr Choice<Resume> kResume[] = {{"on", Resume::on}, {"off", Resume::off}};
constexpr Choice<SelfIntersections> kSelfIntersections[] = {
    {"auto", SelfIntersections::small_meshes},
    {"on", SelfIntersections::count},
    {"off", SelfIntersections::skip}};

}  // namespace

std::string_view study_projection_name(StudyProjection projection) {
  return name_of(projection, kProjections);
}

void StudyFlags::add_to(CLI::App& verb) {
  verb.add_option("-o,--output", folder_, "folder for study.csv, study.json and index.html");
  verb.add_option("--mesher", meshers_, "marching-cubes, exact [" + meshers_ + "]");
  verb.add_option("--edge-length", edge_lengths_,
                  "edge lengths, of --mesher exact, Å [" + edge_lengths_ + "]");
  verb.add_option("--spacing", spacings_, "grid spacings, Å [" + spacings_ + "]");
  verb.add_option("--subdivide", subdivisions_, "numbers of subdivisions [" + subdivisions_ + "]");
  verb.add_option("--field", fields_, "fields [" + fields_ + "]");
  verb.add_option("--project", projections_,
                  "surfaces that vertices are moved to after a subdivision: own (that of the "
                  "field), vdw, field or none [" +
                      projections_ + "]");
  verb.add_option("--backend", backends_, "auto, cpu, cuda [auto]");
  verb.add_option("--self-intersections", self_intersections_,
                  "on, off, or auto: meshes of up to a million triangles [auto]");
  verb.add_option("--resume", resume_, "take finished runs from the folder, on or off [on]");
  verb.add_option("--time-limit", time_limit_,
                  "seconds after which no further run begins; what is finished is written [none]");
  verb.add_option("--page-triangles", page_triangles_,
                  "most triangles of all meshes shown on the page [" + page_triangles_ + "]");
  distances_.add_to(verb);
  machine_.add_to(verb, MachineFlags::Backends::none);
}

StudyAxes StudyFlags::resolve_axes() const {
  StudyAxes axes;
  axes.meshers = parse_list("--mesher", meshers_,
                            [](const std::string& part) { return mesher_of_name(part); });
  axes.spacings = parse_lengths("--spacing", spacings_);
  axes.edge_lengths = parse_lengths("--edge-length", edge_lengths_);
  axes.subdivisions = parse_list("--subdivide", subdivisions_, [](const std::string& part) {
    return static_cast<int>(parse_integer("--subdivide", part, 0, kMaxSubdivisions));
  });
  std::ranges::sort(axes.subdivisions);
  axes.fields =
      parse_list("--field", fields_, [](const std::string& part) { return field_of_name(part); });
  axes.projections = parse_list("--project", projections_, [](const std::string& part) {
    return choose("--project", part, kProjections);
  });
  axes.backends = parse_list("--backend", backends_,
                             [](const std::string& part) { return backend_of_name(part); });
  return axes;
}

StudyOptions StudyFlags::resolve() const {
  if (folder_.empty()) throw InvalidInput("-o: name the folder that the study is written to");
  StudyOptions options;
  options.folder = folder_;
  options.axes = resolve_axes();
  options.distances = distances_.resolve();
  options.self_intersections =
      choose("--self-intersections", self_intersections_, kSelfIntersections);
  options.machine = machine_.resolve();
  options.resume = choose("--resume", resume_, kResume);
  if (time_limit_) {
    options.time_limit = parse_number("--time-limit", *time_limit_, Range::non_negative, "3600");
  }
  options.page_triangles = static_cast<std::uint64_t>(
      parse_integer("--page-triangles", page_triangles_, 0, 100'000'000));
  return options;
}

}  // namespace vdwmesh::apps
