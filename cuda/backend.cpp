// The one place that chooses between the backends. Extractor, BatchExtractor, Refiner, FieldMesher,
// UnionMeasurer, DistanceMeasurer, ExcludedMeasurer and pipeline come from the CPU, from CUDA, or,
// for Backend::automatic on a machine with a device, from the classes Automatic*: these try CUDA
// first and compute on the CPU what does not fit the device's memory (DeviceMemoryExceeded), and
// everything if no device opens (BackendUnavailable).
//
// A pipeline extracts, then refines. If both stages do not fit on the device together, it runs them
// one after the other, with the mesh on the host in between.
#include "cuda/backend.hpp"

#include <utility>

#include "core/errors.hpp"
#include "core/workspace.hpp"
#include "cuda/count_part.hpp"
#include "cuda/cuda_backend.hpp"
#include "extract/count_part.hpp"

namespace vdwmesh {
namespace {

// Calls the observer, if there is one, with the size of the mesh.
void tell_size(const MeshSizeObserver& observer, const IndexedMesh& mesh) {
  if (observer) observer({mesh.vertex_count(), mesh.triangle_count()});
}

// The options of both stages of a pipeline with one common workspace, so that the second stage
// finds the cell list of the first. It is the caller's workspace if the options name one, else one
// that lives as long as this object (WorkspaceOfCall).
class RunOptions {
 public:
  RunOptions(const ExtractOptions& extraction, const RefineOptions& refinement)
      : workspace_(extraction.workspace), extract(extraction), refine(refinement) {
    extract.workspace = &static_cast<Workspace&>(workspace_);
    refine.workspace = extract.workspace;
  }
  // The options of an extraction that is followed by a refinement. It makes half-edges, which the
  // refinement needs, and does not call on_size, because its mesh is not the result.
  ExtractOptions extraction_to_refine() const {
    ExtractOptions options = extract;
    options.connectivity = Connectivity::half_edges;
    options.on_size = {};
    return options;
  }

 private:
  // Before the options, because their initialisation uses it.
  WorkspaceOfCall workspace_;

 public:
  ExtractOptions extract;
  RefineOptions refine;
};

// Extracts to the host, into the memory of result.mesh, then refines the mesh from there. Without
// subdivisions it only extracts.
void run_over_host(PipelineResult& result, const SphereSet& spheres, const RunOptions& run,
                   const Extractor& extractor, const Refiner& refiner) {
  ExtractResult extracted;
  extracted.mesh = std::move(result.mesh);
  if (run.refine.subdivisions == 0) {
    extractor.extract_into(extracted, spheres, run.extract);
    // Not refined: no levels, 0 seconds, no fallback.
    result = {std::move(extracted.mesh),    extracted.grid, extracted.stats, {}, 0,
              std::move(extracted.fallback)};
    return;
  }
  extractor.extract_into(extracted, spheres, run.extraction_to_refine());
  RefineOptions options = run.refine;
  options.grid = extracted.grid;
  RefineResult refined = refiner.refine(spheres, std::move(extracted.mesh), options);
  tell_size(run.extract.on_size, refined.mesh);
  result = {std::move(refined.mesh),   extracted.grid,  extracted.stats,
            std::move(refined.levels), refined.seconds, std::move(refined.fallback)};
}

// An observer that passes each level on to `observer` once. If a first attempt fails and a second
// one starts from level 0 again, levels that have been passed on are skipped: they have the same
// bits. `next` is the lowest level that has not been passed on; it must live as long as the result.
LevelObserver once_per_level(const LevelObserver& observer, int& next) {
  if (!observer) return {};
  return [&observer, &next](int level, const IndexedMesh& mesh) {
    if (level < next) return;
    next = level + 1;
    observer(level, mesh);
  };
}

// Calls on_device() and, if that throws DeviceMemoryExceeded or BackendUnavailable, on_cpu().
// Returns an empty string, or why the CPU had to do the work: "`done` on the CPU: " and what the
// device lacked or why none opened.
template <class OnDevice, class OnCpu>
std::string with_fallback(const char* done, const OnDevice& on_device, const OnCpu& on_cpu) {
  std::string lack;
  try {
    on_device();
    return {};
  } catch (const DeviceMemoryExceeded& error) {
    lack = error.what();
  } catch (const BackendUnavailable& error) {
    lack = error.what();
  }
  // Outside the handler: the exception and what it holds are gone before the CPU starts.
  on_cpu();
  return std::string(done) + " on the CPU: " + lack;
}

template <class Interface>
using Maker = std::unique_ptr<Interface> (*)();

// with_fallback() for a call of an object that either backend makes.
template <class Interface, class Call>
std::string call_with_fallback(const char* done, Maker<Interface> cuda, Maker<Interface> cpu,
                               const Call& call) {
  return with_fallback(
      done, [&] { call(*cuda()); }, [&] { call(*cpu()); });
}

// The object of an interface for a backend.
template <class Automatic, class Interface>
std::unique_ptr<Interface> made_for(Backend backend, Maker<Interface> cuda, Maker<Interface> cpu) {
  if (resolve(backend) == Backend::cpu) return cpu();
  if (backend == Backend::cuda) return cuda();
  return std::make_unique<Automatic>();
}

// The classes Automatic* are used only on a machine with a usable device, see made_for().
class AutomaticExtractor final : public Extractor {
 public:
  void extract_into(ExtractResult& result, const SphereSet& spheres,
                    const ExtractOptions& options) const override {
    result.fallback =
        call_with_fallback("meshed", make_cuda_extractor, make_cpu_extractor,
                           [&](const Extractor& e) { e.extract_into(result, spheres, options); });
  }
  std::unique_ptr<SurfacePart> count(const SphereSet& spheres, const KeyRange& range,
                                     const ExtractOptions& options) const override {
    return count_part(Backend::automatic, spheres, {}, range, options);
  }
};

class AutomaticBatchExtractor final : public BatchExtractor {
 public:
  void extract_into(BatchExtraction& result, const ExtractBatch& batch,
                    const ExtractOptions& options) const override {
    result.fallback = call_with_fallback(
        "meshed", make_cuda_batch_extractor, make_cpu_batch_extractor,
        [&](const BatchExtractor& e) { e.extract_into(result, batch, options); });
  }
};

class AutomaticFieldMesher final : public FieldMesher {
 public:
  void mesh_into(ExtractResult& result, const SampledFieldView& field,
                 const ExtractOptions& options) const override {
    result.fallback =
        call_with_fallback("meshed", make_cuda_field_mesher, make_cpu_field_mesher,
                           [&](const FieldMesher& m) { m.mesh_into(result, field, options); });
  }
};

class AutomaticRefiner final : public Refiner {
 public:
  RefineResult refine(const SphereSet& spheres, IndexedMesh&& mesh,
                      const RefineOptions& options) const override {
    int next_level = 0;
    RefineOptions observed = options;
    observed.on_level = once_per_level(options.on_level, next_level);
    RefineResult result;
    const IndexedMesh& kept = mesh;  // CUDA refines a copy, because the CPU may still need the mesh
    const std::string fallback = with_fallback(
        "refined", [&] { result = make_cuda_refiner()->refine(spheres, kept, observed); },
        [&] { result = make_cpu_refiner()->refine(spheres, std::move(mesh), observed); });
    result.fallback = fallback;
    return result;
  }
};

class AutomaticUnionMeasurer final : public UnionMeasurer {
 public:
  void measure_into(BatchMeasures& result, const SphereBatch& batch,
                    Monitor* monitor) const override {
    const auto measure = [&](const UnionMeasurer& m) { m.measure_into(result, batch, monitor); };
    // The CPU cannot read spheres in device memory, so there is nothing to fall back to.
    if (batch.memory == MemorySpace::device) return measure(*make_cuda_union_measurer());
    result.fallback =
        call_with_fallback("measured", make_cuda_union_measurer, make_cpu_union_measurer, measure);
  }
  void gradients_into(BatchGradients& result, const SphereBatch& batch, const BatchWeights& weights,
                      Monitor* monitor) const override {
    const auto measure = [&](const UnionMeasurer& m) {
      m.gradients_into(result, batch, weights, monitor);
    };
    if (batch.memory == MemorySpace::device) return measure(*make_cuda_union_measurer());
    result.measures.fallback =
        call_with_fallback("measured", make_cuda_union_measurer, make_cpu_union_measurer, measure);
  }
};

class AutomaticDistanceMeasurer final : public DistanceMeasurer {
 public:
  MeasuredDistances measure(const IndexedMesh& mesh, const SphereSet& spheres,
                            const DistanceOptions& options) const override {
    MeasuredDistances measured;
    measured.fallback = with_either([&](const DistanceMeasurer& m) {
      measured.result = m.measure(mesh, spheres, options).result;
    });
    return measured;
  }
  MeasuredPoints measure_points(std::span<const Vec3d> points, const SphereSet& spheres,
                                Monitor* monitor) const override {
    MeasuredPoints measured;
    measured.fallback = with_either([&](const DistanceMeasurer& m) {
      measured.result = m.measure_points(points, spheres, monitor).result;
    });
    return measured;
  }

 private:
  template <class Measure>
  static std::string with_either(const Measure& measure) {
    return call_with_fallback("distances were measured", make_cuda_distance_measurer,
                              make_cpu_distance_measurer, measure);
  }
};

class AutomaticExcludedMeasurer final : public ExcludedMeasurer {
 public:
  void measure_into(ExcludedBatch& result, const SphereBatch& atoms, double probe,
                    Monitor* monitor) const override {
    const auto measure = [&](const ExcludedMeasurer& m) {
      m.measure_into(result, atoms, probe, monitor);
    };
    // The CPU cannot read spheres in device memory, so there is nothing to fall back to.
    if (atoms.memory == MemorySpace::device) return measure(*make_cuda_excluded_measurer());
    result.fallback = call_with_fallback("measured", make_cuda_excluded_measurer,
                                         make_cpu_excluded_measurer, measure);
  }
};

class AutomaticExactMesher final : public ExactMesher {
 public:
  ExactMesh mesh(const SphereSet& spheres, const ExactMeshOptions& options) const override {
    if (spheres.size() < kSpheresWorthADevice)
      return make_cpu_exact_mesher()->mesh(spheres, options);
    ExactMesh made;
    const std::string fallback =
        call_with_fallback("meshed", make_cuda_exact_mesher, make_cpu_exact_mesher,
                           [&](const ExactMesher& m) { made = m.mesh(spheres, options); });
    made.fallback = fallback;
    return made;
  }
};

// Runs a pipeline with the mesh on one device throughout, if it is to be refined and one device is
// asked for. Otherwise, or if that does not fit the device's memory, extracts with CUDA to the host
// and refines by `refiner` from there.
void run_on_device(PipelineResult& result, const SphereSet& spheres, const RunOptions& run,
                   const Refiner& refiner) {
  if (run.refine.subdivisions > 0 && run.extract.devices == 1) {
    try {
      return make_cuda_pipeline()->run_into(result, spheres, run.extract, run.refine);
    } catch (const DeviceMemoryExceeded&) {
      // The stages may fit one after the other: the extraction can be cut into slabs, and the
      // refinement then has the device to itself.
    }
  }
  run_over_host(result, spheres, run, *make_cuda_extractor(), refiner);
}

class BackendPipeline final : public SurfacePipeline {
 public:
  // `automatic` stands for a machine with a usable device.
  explicit BackendPipeline(Backend backend) : backend_(backend) {}

  void run_into(PipelineResult& result, const SphereSet& spheres, const ExtractOptions& extract,
                const RefineOptions& refine) const override {
    int next_level = 0;
    RefineOptions observed = refine;
    observed.on_level = once_per_level(refine.on_level, next_level);
    const auto on_cpu = [&] {
      run_over_host(result, spheres, {extract, observed}, *make_cpu_extractor(),
                    *make_cpu_refiner());
    };
    const auto on_device = [&](const Refiner& refiner) {
      run_on_device(result, spheres, {extract, observed}, refiner);
    };
    if (backend_ == Backend::cpu) return on_cpu();
    if (backend_ == Backend::cuda) return on_device(*make_cuda_refiner());
    const std::string fallback = with_fallback(
        "meshed", [&] { on_device(AutomaticRefiner()); }, on_cpu);
    // Otherwise the result may name a fallback of its own: of the refinement alone.
    if (!fallback.empty()) result.fallback = fallback;
  }

 private:
  Backend backend_;
};

}  // namespace

DeviceList cuda_devices() { return find_cuda_devices(); }

Backend resolve(Backend requested) {
  if (requested == Backend::cpu) return Backend::cpu;
  const DeviceList list = cuda_devices();
  if (!list.devices.empty()) return Backend::cuda;
  if (requested == Backend::automatic) return Backend::cpu;
  throw BackendUnavailable("the CUDA backend is not there: " + list.reason +
                           "; leave the choice to auto, or take cpu");
}

void share_devices(std::size_t process) { share_cuda_devices(process); }

void release_device_memory() { release_cuda_memory(); }

std::unique_ptr<SurfacePart> count_part(Backend backend, const SphereSet& spheres,
                                        std::span<const SphereId> ids, const KeyRange& range,
                                        const ExtractOptions& options) {
  if (resolve(backend) == Backend::cpu) return count_part_on_cpu(spheres, ids, range, options);
  if (backend == Backend::cuda) return count_part_on_cuda(spheres, ids, range, options);
  std::unique_ptr<SurfacePart> part;
  const std::string fallback = with_fallback(
      "meshed", [&] { part = count_part_on_cuda(spheres, ids, range, options); },
      [&] { part = count_part_on_cpu(spheres, ids, range, options); });
  part->fallback = fallback;
  return part;
}

std::unique_ptr<Extractor> make_extractor(Backend backend) {
  return made_for<AutomaticExtractor, Extractor>(backend, make_cuda_extractor, make_cpu_extractor);
}
std::unique_ptr<BatchExtractor> make_batch_extractor(Backend backend) {
  return made_for<AutomaticBatchExtractor, BatchExtractor>(backend, make_cuda_batch_extractor,
                                                           make_cpu_batch_extractor);
}
std::unique_ptr<Refiner> make_refiner(Backend backend) {
  return made_for<AutomaticRefiner, Refiner>(backend, make_cuda_refiner, make_cpu_refiner);
}
std::unique_ptr<FieldMesher> make_field_mesher(Backend backend) {
  return made_for<AutomaticFieldMesher, FieldMesher>(backend, make_cuda_field_mesher,
                                                     make_cpu_field_mesher);
}
std::unique_ptr<UnionMeasurer> make_union_measurer(Backend backend) {
  return made_for<AutomaticUnionMeasurer, UnionMeasurer>(backend, make_cuda_union_measurer,
                                                         make_cpu_union_measurer);
}
std::unique_ptr<ExactMesher> make_exact_mesher(Backend backend) {
  return made_for<AutomaticExactMesher, ExactMesher>(backend, make_cuda_exact_mesher,
                                                     make_cpu_exact_mesher);
}
std::unique_ptr<DistanceMeasurer> make_distance_measurer(Backend backend) {
  return made_for<AutomaticDistanceMeasurer, DistanceMeasurer>(backend, make_cuda_distance_measurer,
                                                               make_cpu_distance_measurer);
}
std::unique_ptr<ExcludedMeasurer> make_excluded_measurer(Backend backend) {
  return made_for<AutomaticExcludedMeasurer, ExcludedMeasurer>(backend, make_cuda_excluded_measurer,
                                                               make_cpu_excluded_measurer);
}
std::unique_ptr<SurfacePipeline> make_pipeline(Backend backend) {
  return std::make_unique<BackendPipeline>(resolve(backend) == Backend::cpu ? Backend::cpu
                                                                            : backend);
}

DeviceArcs measure_arcs_on_device(const SphereSet& spheres) {
  resolve(Backend::cuda);
  return measure_arcs_on_cuda(spheres);
}

}  // namespace vdwmesh
