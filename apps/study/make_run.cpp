// Makes the meshes of one task: one setting with one or more levels of refinement. One refinement
// makes the meshes of all levels, and each is measured when it is reached; no level counts the time
// and memory that measuring takes. The mesh of a task of one level is measured when the pipeline
// is done.
#include "study/make_run.hpp"

#include <algorithm>
#include <utility>

#include "command_line/names.hpp"
#include "excluded/excluded_comparison.hpp"
#include "excluded/excluded_distances.hpp"
#include "memory.hpp"
#include "memory_plan.hpp"
#include "steps/exact_steps.hpp"
#include "steps/excluded_steps.hpp"
#include "steps/stopwatch.hpp"

namespace vdwmesh::apps {
namespace {

// Measures a mesh and returns its record, which lacks only the times and the peak memory of the
// pipeline.
StudyRun measure_run(const IndexedMesh& mesh, const StudySetting& setting, const StudyInput& input,
                     const StudyOptions& options, const Session& session) {
  begin_stage(session.monitor, "measure", 1);
  StudyRun run;
  run.setting = setting;
  const MeshExamination summary = examine(mesh);
  run.topology = summary.topology;
  run.measures = summary.measures;
  run.quality = summary.quality;
  run.histograms = quality_histograms(mesh);
  const auto& excluded = input.excluded;
  run.comparison = excluded ? compare(run.topology, run.measures, excluded->complete)
                            : compare(run.topology, run.measures, input.exact);
  if (options.self_intersections == SelfIntersections::count) {
    run.self_intersections =
        self_intersections(mesh, session.monitor, edges_of(run.topology), grid_of(session.report));
  }
  if (options.distances.distances == Switch::on) {
    const Stopwatch watch;
    const DistanceChoice& d = options.distances;
    run.comparison.distances =
        excluded ? excluded_distances(
                       mesh, input.atoms, excluded->probe,
                       {d.samples_per_area, d.seed, session.machine.memory_limit, session.monitor})
                 : measure_distances(mesh, input.atoms, d, session).result;
    run.seconds.distances = watch.seconds();
  }
  // The bytes of a mesh made for this setting alone. A mesh of a level on the way to a finer one
  // has more arrays.
  run.memory.mesh =
      indexed_mesh_bytes({mesh.vertex_count(), mesh.triangle_count()},
                         {.labels = mesh.triangle_labels(),
                          .width = label_width(surface_options(setting, options.surface))});
  return run;
}

// Watches a refinement and measures the levels wanted, without their time and memory counting for
// the levels that follow.
class LevelRecorder {
 public:
  LevelRecorder(const StudyTask& task, const StudyInput& input, const StudyOptions& options,
                const Session& session)
      : task_(task), input_(input), options_(options), session_(session) {}

  void see(int level, const IndexedMesh& mesh) {
    const double seconds = watch_.seconds() - measuring_seconds_;  // of the pipeline alone
    if (level == 0) extract_seconds_ = seconds;
    peak_ = std::max(peak_, memory_.bytes());
    if (std::ranges::find(task_.levels, level) != task_.levels.end()) {
      StudyRun run = measure_run(mesh, at_level(task_.setting, level), input_, options_, session_);
      run.memory.peak = peak_;
      // finish() replaces that of the last level.
      if (level > 0) run.seconds.refine = seconds - extract_seconds_;
      runs_.push_back(std::move(run));
    }
    // What measuring took does not count for the levels that follow: memory_ starts anew, while
    // peak_ keeps the largest memory of the levels so far, and `seconds` leaves out all the time
    // that see() has taken so far.
    memory_ = {};
    measuring_seconds_ = watch_.seconds() - seconds;
  }

  // Adds the times that the pipeline measured itself, and returns the runs. The setting of the task
  // is that of its last level. The time of refinement of that level is the pipeline's as well; that
  // of the levels before comes from `watch_`.
  std::vector<StudyRun> finish(const Timing& timing) && {
    for (StudyRun& run : runs_) {
      run.seconds.field = timing.field;
      run.seconds.extract = timing.extract;
      const bool is_last_level = run.setting == task_.setting;
      if (is_last_level) run.seconds.refine = timing.refine;
      run.seconds.mesh = run.seconds.field.value_or(0) + run.seconds.extract.value_or(0) +
                         run.seconds.refine.value_or(0);
    }
    return std::move(runs_);
  }

 private:
  const StudyTask& task_;
  const StudyInput& input_;
  const StudyOptions& options_;
  const Session& session_;
  Stopwatch watch_;
  PeakMemory memory_;
  std::optional<std::uint64_t> peak_;
  double measuring_seconds_ = 0;  // that see() has taken
  double extract_seconds_ = 0;    // from the start to level 0
  std::vector<StudyRun> runs_;
};

}  // namespace

IndexedMesh make_study_mesh(const StudyInput& input, const SurfaceOptions& surface,
                            Session& session, const LevelObserver& observer) {
  if (!input.excluded) return make_mesh(input.atoms, surface, session, {.on_level = observer});
  return make_excluded_mesh(input.structure.molecule, input.excluded->probe, surface, session,
                            observer)
      .mesh;
}

std::vector<StudyRun> make_runs(const StudyTask& task, const StudyInput& input,
                                const StudyOptions& options, Monitor* monitor) {
  Session session{.machine = options.machine, .monitor = monitor, .report = {}};
  session.machine.backend = value_named<Backend>("backend", task.setting.key.backend);
  const SurfaceOptions surface = surface_options(task.setting, options.surface);
  LevelRecorder recorder(task, input, options, session);
  // A single level is measured once the pipeline is done, so that nothing interrupts its watch.
  const bool one_level = task.levels.size() == 1;
  LevelObserver observer;
  if (!one_level) observer = [&](int level, const IndexedMesh& mesh) { recorder.see(level, mesh); };
  MemoryDemand demand;
  demand.surface = surface;
  demand.backend = resolve(session.machine.backend);
  demand.self_intersections = options.self_intersections;
  demand.distances = options.distances.distances;
  check_memory_before(demand, input.structure.spheres, options.machine.memory_limit);
  const IndexedMesh mesh = make_study_mesh(input, surface, session, observer);
  if (one_level) recorder.see(task.levels.front(), mesh);
  return std::move(recorder).finish(session.report.timing);
}

}  // namespace vdwmesh::apps
