// Exact area and volume of every ball of one union or of many, and their derivatives, on the CPU or
// on a CUDA device.
//
// Many small sets, such as the frames of a trajectory or a library of structures, are measured in
// one call. make_union_measurer() (cuda/backend.hpp) chooses the backend.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "measures/exact_union.hpp"
#include "measures/union_gradients.hpp"
#include "spheres/sphere_batch.hpp"

namespace vdwmesh {

class Monitor;

struct BatchMeasures {
  std::vector<SphereMeasures> per_sphere;  // in the order of the batch, Å² and Å³
  std::vector<SphereMeasures> totals;      // one for each set: sums over its spheres
  // Balls whose measures come from a triangulation, because their arcs left a doubt or because a
  // CUDA device has no room for them.
  std::uint64_t fallback_spheres = 0;
  // Why the CPU measured what was meant for a device; empty if it did not.
  std::string fallback;
};

// The weights w and u of union_gradients(): one for each sphere of a batch, in the memory in which
// its spheres are. Null: all are 1.
struct BatchWeights {
  const double* area = nullptr;
  const double* volume = nullptr;
};

struct BatchGradients {
  BatchMeasures measures;
  // Of Σ w A and Σ u V over the ball's set, in the order of the batch.
  std::vector<BallGradient> per_sphere;
  std::vector<std::uint64_t> kink_spheres;  // one for each set: as in UnionGradients
};

class UnionMeasurer {
 public:
  virtual ~UnionMeasurer() = default;
  // Measures each ball as method arcs of exact_union() does. Backends differ by rounding: 1e-12 of
  // the whole sphere's area, and of the ball's volume. A backend gives the same bits at every call
  // with the same batch, and gives a ball that is not measured by a triangulation the same bits in
  // every set that has the balls overlapping it. Overwrites `result` and reuses its memory. Throws
  // InvalidInput for an empty set, for offsets that break the rule above, for spheres that no
  // SphereSet accepts, and on the CPU for spheres in device memory; DeviceMemoryExceeded;
  // Cancelled.
  virtual void measure_into(BatchMeasures& result, const SphereBatch& batch,
                            Monitor* monitor = nullptr) const = 0;
  BatchMeasures measure(const SphereBatch& batch, Monitor* monitor = nullptr) const {
    BatchMeasures result;
    measure_into(result, batch, monitor);
    return result;
  }
  // The measures, with the same bits, and their derivatives, which union_gradients() describes.
  // Backends differ by rounding: 1e-11 (1 + size). The rules for bits above hold for derivatives
  // too. Throws as measure_into(), and InvalidInput for a weight or a derivative that is not
  // finite.
  virtual void gradients_into(BatchGradients& result, const SphereBatch& batch,
                              const BatchWeights& weights = {},
                              Monitor* monitor = nullptr) const = 0;
};

// On all cores.
std::unique_ptr<UnionMeasurer> make_cpu_union_measurer();

// For implementations: sums up the sets of per_sphere by total_measures().
void sum_sets(BatchMeasures& result, const SphereBatch& batch);

}  // namespace vdwmesh
