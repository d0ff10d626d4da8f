// Extracts the meshes of many sets of spheres in one call.
//
// Small molecules leave most of a device idle, and each call of an Extractor has a cost of its own.
// The CUDA backend works on all sets together: it searches, counts and emits them as if they were
// one surface. make_batch_extractor() (cuda/backend.hpp) chooses the backend.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "extract/extractor.hpp"
#include "spheres/sphere_batch.hpp"

namespace vdwmesh {

struct ExtractBatch {
  SphereBatch spheres;  // in host memory
  // The grid of each set; empty: ExtractOptions::grid for all.
  std::span<const GridOptions> grids{};
};

// The meshes of the sets, one behind the other in the arrays of one IndexedMesh. Within the part of
// a set, everything is numbered as in a mesh of its own: the corners of its triangles are indices
// into its part of `positions`, its opposite half-edges are numbers within its part, and the labels
// of its vertices are indices of spheres within the set.
struct BatchExtraction {
  IndexedMesh meshes;
  // How many vertices and triangles the sets before each set have, and last those of all sets.
  std::vector<MeshSize> before;
  std::vector<GridSpec> grids;  // of each set
  ExtractStats stats;           // sums over the sets
  // If the CPU made meshes although a device was asked for: the reason. Else empty.
  std::string fallback{};

  std::size_t set_count() const { return grids.size(); }
  MeshSize size(std::size_t set) const {
    return {before[set + 1].vertices - before[set].vertices,
            before[set + 1].triangles - before[set].triangles};
  }
  // A copy of the mesh of a set.
  IndexedMesh mesh(std::size_t set) const;
};

class BatchExtractor {
 public:
  virtual ~BatchExtractor() = default;

  // Replaces `result` by the meshes of all sets and reuses the memory of its arrays. Each mesh is
  // that of Extractor::extract() for the set alone, bit for bit. Of the options, `memory_limit`
  // holds for all meshes together, `on_size` is called for one set after another, and `devices` has
  // no meaning: one device makes all meshes. Throws InvalidInput for spheres in device memory, for
  // an empty set, for offsets that SphereBatch does not allow and for a wrong number of grids; and
  // what extract() throws, with the number of the set in front of the message. `result` has no
  // meaning then.
  virtual void extract_into(BatchExtraction& result, const ExtractBatch& batch,
                            const ExtractOptions& options) const = 0;

  BatchExtraction extract(const ExtractBatch& batch, const ExtractOptions& options) const {
    BatchExtraction result;
    extract_into(result, batch, options);
    return result;
  }
};

// The CPU backend: one set after another, each on all cores.
std::unique_ptr<BatchExtractor> make_cpu_batch_extractor();

// ---- for implementations ----

// Checks the batch, and makes `result` one of no sets.
void begin_batch(BatchExtraction& result, const ExtractBatch& batch);

// A run of sets, begin .. end - 1.
struct SetRun {
  std::size_t begin, end;
  std::size_t size() const { return end - begin; }
};

// Extracts the sets of the run by `extractor`, one after another, and appends their meshes.
void append_one_by_one(BatchExtraction& result, const ExtractBatch& batch, const SetRun& run,
                       const ExtractOptions& options, const Extractor& extractor);

// The grid options of a set.
const GridOptions& grid_of_set(const ExtractBatch& batch, const ExtractOptions& options,
                               std::size_t set);

// Throws LimitExceeded if meshes of this size together take more than `memory_limit` bytes.
void check_batch_memory(const MeshSize& size, const MeshArrays& arrays, std::uint64_t memory_limit);

// For the handler of an exception of one set: throws it again, of the same class, with the number
// of the set in front of its message.
[[noreturn]] void throw_of_set(std::size_t set);

}  // namespace vdwmesh
