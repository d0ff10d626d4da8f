// Goes through all combinations of the axes and leaves out those that are the same: the
// crease-exact mesher has one field, and meshes that are not subdivided are not projected. A task
// is one call of the pipeline, with a weight by which the cheapest come first.
#include "study/plan.hpp"

#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "command_line/names.hpp"

namespace vdwmesh::apps {
namespace {

Projection resolve_projection(StudyProjection projection, FieldKind field) {
  if (projection == StudyProjection::none) return Projection::none;
  // The field of vdw is the union itself.
  const bool to_union = projection == StudyProjection::vdw || field == FieldKind::vdw;
  return to_union ? Projection::vdw : Projection::field;
}

class Planner {
 public:
  Planner(const StudyAxes& axes, std::span<const double> exact_areas)
      : axes_(axes), exact_areas_(exact_areas) {}

  void add(std::size_t input, Backend backend) {
    const std::string name(name_of(backend));
    for (const Mesher mesher : axes_.meshers) {
      if (mesher == Mesher::exact) {
        add_exact(input, backend, name);
      } else {
        add_marching_cubes(input, backend, name);
      }
    }
  }

  std::vector<StudyTask> take() && { return std::move(tasks_); }

 private:
  // The crease-exact mesher follows the union itself: there is no other field, and no choice of
  // what to project to.
  void add_exact(std::size_t input, Backend backend, const std::string& name) {
    for (const double length : axes_.edge_lengths) {
      add_levels(input, backend,
                 {{Mesher::exact, FieldKind::vdw, Projection::vdw, 0, name}, length});
    }
  }

  void add_marching_cubes(std::size_t input, Backend backend, const std::string& name) {
    for (const double spacing : axes_.spacings) {
      for (const FieldKind field : axes_.fields) {
        for (const StudyProjection choice : axes_.projections) {
          const Projection projection = resolve_projection(choice, field);
          add_levels(input, backend,
                     {{Mesher::marching_cubes, field, projection, 0, name}, spacing});
        }
      }
    }
  }

  // On CUDA a level costs little and is timed on the device, so each is a task of its own; on the
  // CPU one refinement shows all levels.
  void add_levels(std::size_t input, Backend backend, const StudySetting& setting) {
    if (backend == Backend::cpu) return add_task(input, setting, axes_.subdivisions);
    for (const int level : axes_.subdivisions) add_task(input, setting, {level});
  }

  // Settings that were planned already, on the way to another level, are not planned again.
  void add_task(std::size_t input, const StudySetting& setting, std::vector<int> levels) {
    std::erase_if(levels, [&](int level) {
      return !planned_.insert({input, at_level(setting, level)}).second;
    });
    if (levels.empty()) return;
    const StudySetting deepest = at_level(setting, levels.back());
    const double weight = study_weight(exact_areas_[input], deepest);
    tasks_.push_back({input, deepest, std::move(levels), weight});
  }

  const StudyAxes& axes_;
  std::span<const double> exact_areas_;
  std::vector<StudyTask> tasks_;
  std::set<std::pair<std::size_t, StudySetting>> planned_;
};

}  // namespace

StudySetting at_level(StudySetting setting, int level) {
  setting.key.subdivisions = level;
  if (level == 0) setting.key.projection = Projection::none;
  return setting;
}

double study_weight(double exact_area, const StudySetting& setting) {
  // A mesh has about one triangle per resolution², times 2; distances take samples besides.
  constexpr double kSamples = 20;  // per Å²
  const double triangles =
      2 / (setting.resolution * setting.resolution) * std::pow(4.0, setting.key.subdivisions);
  const double work = setting.key.projection == Projection::field ? 3 : 1;
  return exact_area * (triangles * work + kSamples);
}

std::vector<StudyTask> plan_study(const StudyAxes& axes, std::span<const Backend> backends,
                                  std::span<const double> exact_areas) {
  Planner planner(axes, exact_areas);
  for (std::size_t input = 0; input < exact_areas.size(); ++input) {
    for (const Backend backend : backends) planner.add(input, backend);
  }
  return std::move(planner).take();
}

}  // namespace vdwmesh::apps
