// The sweep: what has been kept is found again, what has not is made and kept. The cheapest runs
// come first, and runs beyond a limit are left out, so that whenever a study ends most of it is
// there.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <set>
#include <utility>

#include "command_line/names.hpp"
#include "steps/exact_steps.hpp"
#include "steps/excluded_steps.hpp"
#include "steps/stopwatch.hpp"
#include "study/make_run.hpp"
#include "study/plan.hpp"
#include "study/records.hpp"
#include "study/study.hpp"
#include "study/study_progress.hpp"

namespace vdwmesh::apps {
namespace {

constexpr double kNoTimeLimit = std::numeric_limits<double>::infinity();

// A hash of the bits of all coordinates and radii. Kept runs are found by it, so spheres that
// differ in the last bit have runs of their own.
std::string hash_of(const SphereSet& spheres) {
  std::string bytes(spheres.size() * 4 * sizeof(double), '\0');
  char* at = bytes.data();
  for (const Sphere& s : spheres.spheres()) {
    for (const double value : {s.center.x, s.center.y, s.center.z, s.radius}) {
      std::memcpy(at, &value, sizeof value);
      at += sizeof value;
    }
  }
  return hash_text(bytes);
}

std::string name_of_input(const InputOptions& options) {
  return options.sample.empty() ? options.path.filename().string() : options.sample;
}

StudyInput read_input(const InputOptions& options, ExactSurface surface,
                      const MachineOptions& machine) {
  Session session{machine, nullptr, {}, {}};
  Structure structure = load(options, session);
  const bool excluded = surface == ExactSurface::excluded;
  SphereSet atoms = excluded ? to_spheres(structure.molecule, 0) : structure.spheres;
  StudyInput input{.name = name_of_input(options),
                   .structure = std::move(structure),
                   .atoms = std::move(atoms),
                   .hash = {},
                   .report = {},
                   .warnings = {},
                   .exact = {},
                   .excluded = {}};
  input.hash = hash_of(input.atoms);
  if (excluded) {
    input.hash += fmt::format(" excluded {}", options.probe);
    measure_excluded(input.structure.molecule, options.probe, {}, Switch::off, session);
    input.excluded = std::move(session.report.excluded);
    // Whoever reads area and volume from `exact` finds them there for either surface.
    input.exact.method = UnionMethod::cgal;
    input.exact.area = input.excluded->complete.area;
    input.exact.volume = input.excluded->complete.volume;
  } else {
    measure_exactly(input.atoms, {}, session);
    input.exact = std::move(*session.report.exact);
  }
  input.report = session.report.input;
  input.warnings = session.report.warnings;
  input.exact_seconds = session.report.timing.exact->wall;
  return input;
}

// Rows of the table are told apart by the name of their input.
void make_names_unique(std::vector<StudyFindings>& findings) {
  std::multiset<std::string> names;
  for (const StudyFindings& f : findings) names.insert(f.input.name);
  std::size_t number = 0;
  for (StudyFindings& f : findings) {
    ++number;
    if (names.count(f.input.name) > 1) f.input.name += fmt::format(" (input {})", number);
  }
}

// Several names may mean one backend, as `auto` does; its runs would be the same.
std::vector<BackendReport> find_backends(const std::vector<Backend>& requested) {
  std::vector<BackendReport> backends;
  for (const Backend backend : requested) {
    const BackendReport report = describe_backend(backend, resolve(backend));
    const auto same = [&](const BackendReport& r) { return r.used == report.used; };
    if (std::ranges::none_of(backends, same)) backends.push_back(report);
  }
  return backends;
}

class Sweep {
 public:
  Sweep(Study& study, const StudyStore& store) : study_(study), store_(store) {}

  void run() {
    std::vector<StudyTask> tasks = plan();
    std::erase_if(tasks, [&](StudyTask& task) { return find_finished(task); });
    // The cheapest first: an interrupted study has gone through most of its settings.
    std::ranges::stable_sort(tasks, {}, &StudyTask::weight);
    double total = 0;
    for (const StudyTask& task : tasks) total += task.weight;
    progress_ = make_study_progress(study_.options.machine.progress, total);
    const Stopwatch watch;
    for (const StudyTask& task : tasks) {
      if (watch.seconds() >= study_.options.time_limit.value_or(kNoTimeLimit)) {
        study_.runs_left += task.levels.size();
        continue;
      }
      run(task);
      progress_->end_run(task.weight);
    }
  }

 private:
  std::vector<StudyTask> plan() const {
    std::vector<Backend> backends;
    backends.reserve(study_.backends.size());
    for (const BackendReport& backend : study_.backends) backends.push_back(backend.used);
    std::vector<double> areas;
    areas.reserve(study_.findings.size());
    for (const StudyFindings& f : study_.findings) areas.push_back(f.input.exact.area);
    return plan_study(study_.options.axes, backends, areas);
  }

  // Removes from the task the levels whose runs are in the store. Returns whether none is left.
  bool find_finished(StudyTask& task) {
    if (study_.options.resume == Switch::off) return false;
    std::erase_if(task.levels, [&](int level) {
      std::optional<StudyRun> kept = store_.find(key_of(task.input, at_level(task.setting, level)));
      if (!kept) return false;
      study_.findings[task.input].runs.push_back(std::move(*kept));
      ++study_.runs_found;
      return true;
    });
    if (!task.levels.empty()) retarget(task);
    return task.levels.empty();
  }

  // Makes the deepest level that is left the target of the task, and estimates its cost anew.
  void retarget(StudyTask& task) const {
    task.setting = at_level(task.setting, task.levels.back());
    task.weight = study_weight(study_.findings[task.input].input.exact.area, task.setting);
  }

  RunKey key_of(std::size_t input, const StudySetting& setting) const {
    const StudyOptions& options = study_.options;
    const BackendReport& backend =
        *std::ranges::find(study_.backends, value_named<Backend>("backend", setting.key.backend),
                           &BackendReport::used);
    RunKey key{.spheres = study_.findings[input].input.hash,
               .setting = setting,
               .self_intersections = static_cast<int>(options.self_intersections),
               .device = backend.device,
               .threads = backend.threads};
    if (options.distances.distances == Switch::on) {
      key.samples = options.distances.samples_per_area;
      key.seed = options.distances.seed;
    }
    return key;
  }

  // Levels beyond a limit are refused one by one from the deepest, so that the others still come.
  void run(StudyTask task) {
    const StudyInput& input = study_.findings[task.input].input;
    while (!task.levels.empty()) {
      progress_->begin_run(fmt::format("{} {} {} Å, subdivided {} x, {}", input.name,
                                       name_of(task.setting.key.field), task.setting.resolution,
                                       task.setting.key.subdivisions, task.setting.key.backend));
      try {
        return keep(task.input, make_runs(task, input, study_.options, progress_.get()));
      } catch (const LimitExceeded& error) {
        refuse(task, error.what());
      } catch (const InvalidInput& error) {  // too coarse: no grid node inside the surface
        refuse(task, error.what());
      } catch (const std::bad_alloc&) {
        refuse(task, "out of memory");
      }
    }
  }

  // Each run is kept as soon as it is made: a study may be interrupted at any time.
  void keep(std::size_t input, std::vector<StudyRun> runs) {
    for (StudyRun& run : runs) {
      store_.keep(key_of(input, run.setting), run);
      study_.findings[input].runs.push_back(std::move(run));
      ++study_.runs_made;
    }
  }

  void refuse(StudyTask& task, const std::string& reason) {
    study_.findings[task.input].refused.push_back({task.setting, reason});
    task.levels.pop_back();
    if (!task.levels.empty()) retarget(task);
  }

  Study& study_;
  const StudyStore& store_;
  std::unique_ptr<StudyProgress> progress_;
};

}  // namespace

SurfaceOptions surface_options(const StudySetting& setting, ExactSurface surface) {
  SurfaceOptions options;
  options.kind = surface;
  options.mesher = setting.key.mesher;
  if (options.mesher == Mesher::exact) {
    options.edge_length = setting.resolution;
  } else {
    options.field.kind = setting.key.field;
    options.grid = preset_grid(options.field.preset, setting.resolution, std::nullopt);
  }
  options.subdivisions = setting.key.subdivisions;
  options.projection = setting.key.projection;
  return options;
}

Study make_study(const std::vector<InputOptions>& inputs, const StudyOptions& options) {
  const Stopwatch watch;
  Study study;
  study.options = options;
  study.backends = find_backends(options.axes.backends);
  for (const InputOptions& input : inputs) {
    study.findings.push_back({read_input(input, options.surface, options.machine), {}, {}, {}});
  }
  make_names_unique(study.findings);
  const StudyStore store(options.folder);
  Sweep(study, store).run();
  for (StudyFindings& f : study.findings) {
    std::ranges::sort(f.runs, {}, &StudyRun::setting);
    f.series = find_series(f.runs);
  }
  study.seconds = watch.seconds();
  return study;
}

}  // namespace vdwmesh::apps
