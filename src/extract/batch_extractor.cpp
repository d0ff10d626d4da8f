// The batch extractor of the CPU, and what every backend needs beside its kernels: checks of the
// batch, the options of one set, and messages that name it. Sets are extracted one after another;
// the memory of one set's mesh serves the next, and each mesh is appended to those before it.
#include "extract/batch_extractor.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/errors.hpp"
#include "core/monitor.hpp"

namespace vdwmesh {
namespace {

template <class T>
void append(Buffer<T>& to, const Buffer<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// Marching cubes fills neither triangle_spheres nor the second and third sphere of a label.
void append(IndexedMesh& meshes, const IndexedMesh& mesh) {
  append(meshes.positions, mesh.positions);
  append(meshes.normals, mesh.normals);
  append(meshes.vertex_spheres.atoms, mesh.vertex_spheres.atoms);
  append(meshes.triangles, mesh.triangles);
  append(meshes.opposite, mesh.opposite);
}

template <class T>
Buffer<T> part_of(const Buffer<T>& all, std::uint64_t first, std::uint64_t size) {
  if (all.empty()) return {};
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
  return {begin, begin + static_cast<std::ptrdiff_t>(size)};
}

// The options of the extraction of one set. Progress counts sets, so the set itself reports none.
ExtractOptions options_of_set(const ExtractBatch& batch, const ExtractOptions& options,
                              std::size_t set, const IndexedMesh& before) {
  ExtractOptions own = options;
  own.grid = grid_of_set(batch, options, set);
  own.monitor = nullptr;
  own.devices = 1;
  if (options.memory_limit == kNoMemoryLimit) return own;
  own.memory_limit -= std::min(options.memory_limit, indexed_mesh_bytes(before));
  return own;
}

class CpuBatchExtractor final : public BatchExtractor {
 public:
  void extract_into(BatchExtraction& result, const ExtractBatch& batch,
                    const ExtractOptions& options) const override {
    begin_batch(result, batch);
    const std::size_t sets = batch.spheres.set_count();
    begin_stage(options.monitor, "extract", sets);
    append_one_by_one(result, batch, {0, sets}, options, *make_cpu_extractor());
  }
};

}  // namespace

IndexedMesh BatchExtraction::mesh(std::size_t set) const {
  const auto [vertex, triangle] = before[set];
  const auto [vertices, triangles] = size(set);
  IndexedMesh mesh;
  mesh.positions = part_of(meshes.positions, vertex, vertices);
  mesh.normals = part_of(meshes.normals, vertex, vertices);
  mesh.vertex_spheres.atoms = part_of(meshes.vertex_spheres.atoms, vertex, vertices);
  mesh.triangles = part_of(meshes.triangles, triangle, triangles);
  mesh.opposite = part_of(meshes.opposite, 3 * triangle, 3 * triangles);
  return mesh;
}

std::unique_ptr<BatchExtractor> make_cpu_batch_extractor() {
  return std::make_unique<CpuBatchExtractor>();
}

// All spheres are checked first, so that an error names the index in the batch and not in a set.
void begin_batch(BatchExtraction& result, const ExtractBatch& batch) {
  const SphereBatch& spheres = batch.spheres;
  if (spheres.memory == MemorySpace::device) {
    throw InvalidInput("the spheres are in device memory: a batch is extracted from host memory");
  }
  check_sets(spheres);
  if (!batch.grids.empty() && batch.grids.size() != spheres.set_count()) {
    throw InvalidInput(fmt::format("{} grids for {} sets: give one for each set, or none",
                                   batch.grids.size(), spheres.set_count()));
  }
  // The view checks all spheres; it is not needed otherwise.
  SphereSet::view({spheres.spheres, spheres.size});
  make_room(result.meshes, {}, {});  // for no vertex and no triangle: empties all arrays
  result.before.assign(1, {});
  result.grids.clear();
  result.stats = {};
  result.fallback.clear();
}

void append_one_by_one(BatchExtraction& result, const ExtractBatch& batch, const SetRun& run,
                       const ExtractOptions& options, const Extractor& extractor) {
  ExtractResult one;
  for (std::size_t set = run.begin; set < run.end; ++set) {
    try {
      extractor.extract_into(one, SphereSet::view(batch.spheres.set(set)),
                             options_of_set(batch, options, set, result.meshes));
    } catch (const Error&) {
      throw_of_set(set);
    }
    append(result.meshes, one.mesh);
    const MeshSize& last = result.before.back();
    result.before.push_back(
        {last.vertices + one.mesh.vertex_count(), last.triangles + one.mesh.triangle_count()});
    result.grids.push_back(one.grid);
    result.stats += one.stats;
    advance(options.monitor, 1);
  }
}

const GridOptions& grid_of_set(const ExtractBatch& batch, const ExtractOptions& options,
                               std::size_t set) {
  return batch.grids.empty() ? options.grid : batch.grids[set];
}

void check_batch_memory(const MeshSize& size, const MeshArrays& arrays,
                        std::uint64_t memory_limit) {
  const std::uint64_t need = indexed_mesh_bytes(size, arrays);
  if (need <= memory_limit) return;
  throw LimitExceeded(fmt::format(
      "{} vertices and {} triangles of all sets need {} bytes, {} are allowed: choose a larger "
      "spacing or a higher memory limit",
      size.vertices, size.triangles, need, memory_limit));
}

void throw_of_set(std::size_t set) {
  const auto named = [set](const Error& error) {
    return fmt::format("set {}: {}", set, error.what());
  };
  try {
    throw;
  } catch (const InvalidInput& error) {
    throw InvalidInput(named(error));
  } catch (const DeviceMemoryExceeded& error) {
    throw DeviceMemoryExceeded(named(error));
  } catch (const LimitExceeded& error) {
    throw LimitExceeded(named(error));
  }
}

}  // namespace vdwmesh
