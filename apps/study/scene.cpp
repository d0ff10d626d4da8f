// Makes the meshes of the page anew and packs them: positions in 16 bits of their box, what colours
// show in 8.
#include "study/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "analysis/mesh_measures.hpp"
#include "command_line/names.hpp"
#include "core/errors.hpp"
#include "memory_plan.hpp"
#include "mesh/element_color.hpp"
#include "page/packed_mesh.hpp"
#include "report/json_text.hpp"
#include "spheres/box.hpp"
#include "steps/exact_steps.hpp"
#include "steps/picture.hpp"
#include "study/describe_study.hpp"
#include "study/make_run.hpp"

namespace vdwmesh::apps {
namespace {

constexpr std::uint64_t kSceneTriangles = 200'000;
constexpr double kMaxByte = 255;

// The number of each vertex's element in the list of elements returned.
std::vector<std::string> append_elements(const IndexedMesh& mesh, const Molecule& molecule,
                                         std::string& bytes) {
  std::vector<std::string> elements;
  std::map<std::string, char> numbers;
  for (const SphereId atom : mesh.vertex_spheres.atoms) {
    const std::string& element = molecule.atoms.at(atom).element;
    const auto [entry, is_new] = numbers.try_emplace(element, static_cast<char>(numbers.size()));
    if (is_new) elements.push_back(element);
    bytes += entry->second;
  }
  return elements;
}

// [lower, upper] -> [0, 255].
void append_bytes(const std::vector<float>& values, double lower, double upper,
                  std::string& bytes) {
  for (const float value : values) {
    const double place = (static_cast<double>(value) - lower) / (upper - lower);
    bytes += static_cast<char>(std::lround(kMaxByte * std::clamp(place, 0.0, 1.0)));
  }
}

// The colours span 99 % of the distances; single large ones would leave the rest without contrast.
double distance_range(const std::vector<float>& distances) {
  std::vector<double> sizes;
  sizes.reserve(distances.size());
  for (const float d : distances) sizes.push_back(std::abs(static_cast<double>(d)));
  const auto rank = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() * 99 / 100);
  std::nth_element(sizes.begin(), rank, sizes.end());
  return *rank > 0 ? *rank : 1e-9;
}

// Meshes are not kept with their runs: they take far more room than their figures.
IndexedMesh mesh_anew(const StudyInput& input, const SurfaceOptions& surface, Session& session) {
  MemoryDemand demand;
  demand.surface = surface;
  demand.backend = resolve(session.machine.backend);
  demand.measures = Switch::off;
  check_memory_before(demand, input.structure.spheres, session.machine.memory_limit);
  return make_study_mesh(input, surface, session);
}

StudyScene make_scene(const Study& study, std::size_t input, const StudySetting& setting) {
  const StudyInput& of = study.findings[input].input;
  Session session{study.options.machine, nullptr, {}, {}};
  session.machine.backend = value_named<Backend>("backend", setting.key.backend);
  session.report.excluded = of.excluded;
  const IndexedMesh mesh = mesh_anew(of, surface_options(setting, study.options.surface), session);
  // Vertices lie on the surface; what is wrong is what the triangles between them cut off.
  const std::vector<float> distances = measure_centers(mesh, of.atoms, session);
  const double range = distance_range(distances);
  StudyScene scene{input, setting, {}, {}};
  const Box box = append_mesh(mesh, scene.bytes);
  const std::vector<std::string> elements =
      append_elements(mesh, of.structure.molecule, scene.bytes);
  append_bytes(distances, -range, range, scene.bytes);
  append_bytes(min_angles_deg(mesh), 0, 60, scene.bytes);
  JsonText json(JsonText::Layout::compact);
  json("input", input), json("parameters", setting);
  describe_packed(json, mesh, box);
  json.list("elements", elements, [&](const std::string& element) {
    const auto color = element_color(element);
    json("element", element), json("color", std::vector<int>(color.begin(), color.end()));
  });
  json("distance_range", range);
  scene.description = std::move(json).take();
  return scene;
}

// A way of making meshes, whatever the resolution and the number of subdivisions.
using Way = std::tuple<Mesher, FieldKind>;

// The run of each way that is best looked at.
std::map<Way, const StudyRun*> choose_runs(const StudyFindings& findings) {
  std::map<Way, const StudyRun*> chosen;
  for (const StudyRun& run : findings.runs) {
    const StudyRun*& best = chosen[{run.setting.key.mesher, run.setting.key.field}];
    const auto fits = [](const StudyRun& r) { return r.topology.triangles <= kSceneTriangles; };
    const auto better = [&](const StudyRun& a, const StudyRun& b) {
      if (fits(a) != fits(b)) return fits(a);
      return fits(a) == (a.topology.triangles > b.topology.triangles);
    };
    if (!best || better(run, *best)) best = &run;
  }
  return chosen;
}

}  // namespace

// First ways first, over all inputs, so that each molecule is shown before any is shown twice.
std::vector<StudyScene> make_scenes(const Study& study, std::vector<std::string>& warnings) {
  std::vector<std::pair<Way, std::pair<std::size_t, const StudyRun*>>> wanted;
  for (std::size_t i = 0; i < study.findings.size(); ++i) {
    for (const auto& [way, run] : choose_runs(study.findings[i])) wanted.push_back({way, {i, run}});
  }
  std::ranges::stable_sort(wanted, {}, [](const auto& entry) { return entry.first; });
  std::vector<StudyScene> scenes;
  std::uint64_t triangles = 0;
  for (const auto& [way, place] : wanted) {
    const auto& [input, run] = place;
    if (triangles + run->topology.triangles > study.options.page_triangles) continue;
    try {
      scenes.push_back(make_scene(study, input, run->setting));
      triangles += run->topology.triangles;
    } catch (const LimitExceeded& error) {
      warnings.push_back(fmt::format("{}: a mesh is left out of the page: {}",
                                     study.findings[input].input.name, error.what()));
    }
  }
  std::ranges::stable_sort(scenes, {}, &StudyScene::input);
  return scenes;
}

}  // namespace vdwmesh::apps
