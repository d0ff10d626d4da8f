#include "study/make_run.hpp"

#include <algorithm>
#include <utility>

#include "memory.hpp"
#include "memory_plan.hpp"
#include "parse.hpp"
#include "stopwatch.hpp"

namespace vdwmesh::apps {
namespace {

StudyRun measure(const IndexedMesh& mesh, const StudySetting& setting, const StudyInput& input,
                 const StudyOptions& options, Monitor* monitor) {
  begin_stage(monitor, "measure", 1);
  StudyRun run;
  run.setting = setting;
  const MeshExamination summary = examine(mesh);
  run.topology = summary.topology;
  run.measures = summary.measures;
  run.quality = summary.quality;
  run.histograms = quality_histograms(mesh);
  run.comparison = compare(run.topology, run.measures, input.exact);
  if (counts_self_intersections(options.self_intersections, mesh.triangle_count())) {
    run.self_intersections = self_intersections(mesh);
  }
  if (options.distances.distances == Switch::on) {
    const Stopwatch watch;
    run.comparison.distances =
        distances(mesh, input.spheres,
                  {options.distances.samples_per_area, options.distances.seed,
                   options.machine.memory_limit, monitor});
    run.seconds.distances = watch.seconds();
  }
  // As the setting alone has it: not with what the way there left in the mesh.
  run.memory.mesh = indexed_mesh_bytes(
      {mesh.vertex_count(), mesh.triangle_count()},
      {.labels = mesh.triangle_labels(), .width = label_width(surface_options(setting))});
  return run;
}

// Watches a refinement and measures the levels wanted, without their time and memory counting for
// the levels that follow.
class LevelRecorder {
 public:
  LevelRecorder(const StudyTask& task, const StudyInput& input, const StudyOptions& options,
                Monitor* monitor)
      : task_(task), input_(input), options_(options), monitor_(monitor) {}

  void see(int level, const IndexedMesh& mesh) {
    const double reached = watch_.seconds() - observed_;
    if (level == 0) extracted_ = reached;
    peak_ = std::max(peak_, memory_.bytes());
    if (std::ranges::find(task_.levels, level) != task_.levels.end()) {
      StudyRun run = measure(mesh, at_level(task_.setting, level), input_, options_, monitor_);
      run.memory.peak = peak_;
      if (level > 0) run.seconds.refine = reached - extracted_;
      runs_.push_back(std::move(run));
    }
    memory_ = {};
    observed_ = watch_.seconds() - reached;
  }

  // What the pipeline itself says of its times; the last level's is its own watch's.
  std::vector<StudyRun> finish(const Timing& timing) && {
    for (StudyRun& run : runs_) {
      run.seconds.field = timing.field;
      run.seconds.extract = timing.extract;
      if (run.setting == task_.setting) run.seconds.refine = timing.refine;
      run.seconds.mesh = run.seconds.field.value_or(0) + run.seconds.extract.value_or(0) +
                         run.seconds.refine.value_or(0);
    }
    return std::move(runs_);
  }

 private:
  const StudyTask& task_;
  const StudyInput& input_;
  const StudyOptions& options_;
  Monitor* monitor_;
  Stopwatch watch_;
  PeakMemory memory_;
  std::optional<std::uint64_t> peak_;
  double observed_ = 0, extracted_ = 0;  // s
  std::vector<StudyRun> runs_;
};

}  // namespace

std::vector<StudyRun> make_runs(const StudyTask& task, const StudyInput& input,
                                const StudyOptions& options, Monitor* monitor) {
  MachineOptions machine = options.machine;
  machine.backend = backend_of_name(task.setting.key.backend);
  LevelRecorder recorder(task, input, options, monitor);
  // A single level is measured once the pipeline is done, so that nothing interrupts its watch.
  const bool one_level = task.levels.size() == 1;
  LevelObserver observer;
  if (!one_level) observer = [&](int level, const IndexedMesh& mesh) { recorder.see(level, mesh); };
  Report report;
  MemoryDemand demand;
  demand.surface = surface_options(task.setting);
  demand.backend = resolve(machine.backend);
  demand.self_intersections = options.self_intersections;
  demand.distances = options.distances.distances;
  check_memory_before(demand, input.spheres, machine.memory_limit);
  const IndexedMesh mesh = make_mesh(input.spheres, surface_options(task.setting), {}, machine,
                                     monitor, report, {.on_level = observer, .on_size = {}});
  if (one_level) recorder.see(task.levels.front(), mesh);
  return std::move(recorder).finish(report.timing);
}

}  // namespace vdwmesh::apps
