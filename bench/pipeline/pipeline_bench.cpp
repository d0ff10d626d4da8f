// Times one pass from structure file to mesh file, stage by stage, with the steps that verbs are
// made of. Each stage says how many bytes it must read and write at the least; what a copy of them
// would take is its floor. The least seconds of each stage count over several passes.
#include "pipeline/pipeline_bench.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "cuda/backend.hpp"
#include "mesh/mesh_io.hpp"
#include "pipeline/stage_clock.hpp"
#include "steps/exact_steps.hpp"
#include "steps/steps.hpp"

namespace vdwmesh::apps {
namespace {

constexpr double kEnoughSeconds = 20;  // of the repeats of one case, together

using Rows = std::vector<StageRow>;
using Bytes = std::optional<std::uint64_t>;

std::uint64_t file_bytes(const InputOptions& input) {
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(input.path, none);
  return none ? 0 : size;
}

// One pass over all stages of one case.
class Pass {
 public:
  Pass(const PipelineBenchOptions& options, const InputOptions& input, double spacing)
      : options_(options), input_(input), session_{options.machine, nullptr, {}, {}} {
    surface_.grid.spacing = spacing;
  }

  PipelineCase run() {
    result_.input = input_.sample.empty() ? input_.path.filename().string() : input_.sample;
    result_.spacing = surface_.grid.spacing;
    read();
    IndexedMesh mesh = extract();
    exact(mesh);
    measure_mesh(mesh);
    write(mesh);
    result_.warnings = std::move(report_.warnings);
    const bool fell_back = report_.backend->device && report_.backend->used == Backend::cpu;
    if (fell_back) result_.warnings.push_back(*report_.backend->reason);
    return std::move(result_);
  }

 private:
  template <class Work>
  StageRow& stage(const char* name, Bytes bytes_read, Work&& work,
                  StageKind kind = StageKind::stage) {
    StageClock clock(name, kind);
    const Bytes written = work();
    return add(clock, bytes_read, written);
  }

  StageRow& add(StageClock& clock, Bytes bytes_read, Bytes bytes_written) {
    StageRow& row = result_.stages.emplace_back(clock.finish());
    row.bytes_read = bytes_read;
    row.bytes_written = bytes_written;
    return row;
  }

  void read() {
    stage("read", input_.sample.empty() ? Bytes(file_bytes(input_)) : std::nullopt, [&]() -> Bytes {
      molecule_ = load_molecule(input_, session_);
      return molecule_.atoms.size() * sizeof(Atom);
    });
    stage("spheres", molecule_.atoms.size() * sizeof(Atom), [&]() -> Bytes {
      spheres_ = to_spheres(molecule_, input_.probe);
      return spheres_->size() * sizeof(Sphere);
    });
    result_.spheres = spheres_->size();
  }

  // Extraction and refinement, with the parts that the library announces or, on a device, those
  // that it timed.
  IndexedMesh extract() {
    surface_.subdivisions = options_.surface.subdivisions;
    surface_.projection = Projection::vdw;
    surface_.crossings = options_.surface.crossings;
    PartClock parts;
    IndexedMesh mesh;
    StageRow& row = stage("mesh", spheres_->size() * sizeof(Sphere), [&]() -> Bytes {
      session_.monitor = &parts;
      mesh = make_mesh(*spheres_, surface_, session_, {});
      session_.monitor = nullptr;
      parts.finish();
      return indexed_mesh_bytes(mesh);
    });
    if (report_.backend->used == Backend::cuda) parts.parts() = device_parts(row.wall_seconds);
    for (const StageRow& part : parts.parts())
      row.peak_memory = std::max(row.peak_memory, part.peak_memory);
    result_.stages.insert(result_.stages.end(), parts.parts().begin(), parts.parts().end());
    result_.vertices = mesh.vertex_count();
    result_.triangles = mesh.triangle_count();
    return mesh;
  }

  // A device works while the host waits, so its parts are those that it timed itself.
  Rows device_parts(double wall_seconds) const {
    StageRow kernels, rest;
    kernels.name = "kernels";
    kernels.wall_seconds = report_.timing.field.value_or(0) + report_.timing.extract.value_or(0) +
                           report_.timing.refine.value_or(0);
    rest.name = "transfers and host";
    rest.wall_seconds = wall_seconds - kernels.wall_seconds;
    kernels.kind = rest.kind = StageKind::part;
    return {kernels, rest};
  }

  void exact(const IndexedMesh& mesh) {
    const std::uint64_t in = spheres_->size() * sizeof(Sphere);
    const auto unite = [&](const char* name, UnionMethod method) {
      stage(
          name, in,
          [&]() -> Bytes {
            const ExactUnion exact = exact_union(*spheres_, {method, nullptr});
            return exact.per_sphere.size() * sizeof(SphereMeasures);
          },
          StageKind::beside);
    };
    unite("exact, arcs", UnionMethod::arcs);
    unite("exact, topology", UnionMethod::cgal);
    if (options_.distances == Switch::off) return;
    stage(
        "distances", in + indexed_mesh_bytes(mesh),
        [&]() -> Bytes {
          (void)measure_distances(mesh, *spheres_, DistanceChoice{}, session_);
          return std::nullopt;
        },
        StageKind::beside);
  }

  void measure_mesh(const IndexedMesh& mesh) {
    stage("measure", indexed_mesh_bytes(mesh), [&]() -> Bytes {
      measure(mesh, SelfIntersections::skip, session_);
      return std::nullopt;
    });
  }

  void write(const IndexedMesh& mesh) {
    stage("write PLY", indexed_mesh_bytes(mesh),
          [&]() -> Bytes { return encode_mesh(mesh, MeshFormat::ply).bytes.size(); });
  }

  const PipelineBenchOptions& options_;
  const InputOptions& input_;
  SurfaceOptions surface_;
  Molecule molecule_;
  std::optional<SphereSet> spheres_;
  Session session_;
  Report& report_ = session_.report;
  PipelineCase result_;
};

// Of each stage by itself: a pass that was disturbed in one of them counts in the others.
void keep_least(PipelineCase& least, const PipelineCase& other) {
  for (std::size_t i = 0; i < least.stages.size(); ++i) {
    StageRow& row = least.stages[i];
    row.wall_seconds = std::min(row.wall_seconds, other.stages[i].wall_seconds);
    if (row.cpu_seconds) row.cpu_seconds = std::min(row.cpu_seconds, other.stages[i].cpu_seconds);
  }
}

// Stages that say nothing of their bytes have no floor.
void set_floors(PipelineCase& done, const CopyRate& copy) {
  for (StageRow& row : done.stages) {
    if (!row.bytes_read && !row.bytes_written) continue;
    row.floor_seconds =
        static_cast<double>(row.bytes_read.value_or(0) + row.bytes_written.value_or(0)) / copy.warm;
  }
}

// Long cases run once: what disturbs them is small beside them.
PipelineCase run_case(const PipelineBenchOptions& options, const InputOptions& input,
                      double spacing) {
  const Stopwatch watch;
  PipelineCase least = Pass(options, input, spacing).run();
  for (int i = 1; i < options.repeats && watch.seconds() < kEnoughSeconds; ++i)
    keep_least(least, Pass(options, input, spacing).run());
  return least;
}

}  // namespace

std::optional<double> floor_ratio(const StageRow& row) {
  if (!row.cpu_seconds || !row.floor_seconds || *row.floor_seconds <= 0) return std::nullopt;
  return *row.cpu_seconds / *row.floor_seconds;
}

StageRow total_of(const PipelineCase& done) {
  StageRow total;
  total.name = "file to file";
  total.cpu_seconds = 0;
  for (const StageRow& row : done.stages) {
    if (row.kind != StageKind::stage) continue;
    total.wall_seconds += row.wall_seconds;
    *total.cpu_seconds += row.cpu_seconds.value_or(0);
    total.peak_memory = std::max(total.peak_memory, row.peak_memory);
  }
  return total;
}

PipelineBench time_pipeline(const PipelineBenchOptions& options,
                            const std::function<void(std::size_t, std::size_t)>& on_case) {
  PipelineBench bench;
  bench.backend = describe_backend(options.machine.backend, resolve(options.machine.backend));
  bench.copy = measure_copy_rate();
  const std::size_t count = options.inputs.size() * options.spacings.size();
  // The first use of a device takes time of its own.
  if (bench.backend.used == Backend::cuda)
    (void)run_case(options, options.inputs.front(), options.spacings.front());
  for (const InputOptions& input : options.inputs) {
    for (const double spacing : options.spacings) {
      on_case(bench.cases.size(), count);
      bench.cases.push_back(run_case(options, input, spacing));
      set_floors(bench.cases.back(), bench.copy);
    }
  }
  return bench;
}

}  // namespace vdwmesh::apps
