// Area, volume and Euler characteristic of the solvent-excluded surfaces of one set of atoms or of
// many, with the shares of all atoms, on the CPU or on a CUDA device.
//
// Many small sets, such as the frames of a trajectory or a library of structures, are measured in
// one call. make_excluded_measurer() (cuda/backend.hpp) chooses the backend. What only the whole
// surface tells, its shells, components and exterior part, is in excluded_measures().
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "excluded/excluded_measures.hpp"
#include "measures/union_measurer.hpp"

namespace vdwmesh {

class Monitor;

// The complete surface of one set.
struct ExcludedTotals {
  double area, volume;                        // Å², Å³
  ByPatchKind area_by_kind;                   // Å²: sums to `area`
  ByPatchKind layer_by_kind;                  // Å³, as in ExcludedSurface
  double accessible_area, accessible_volume;  // Å², Å³ of the grown balls
  std::int64_t euler_characteristic;
  ExcludedCounts counts;
  // As in ExcludedChecks. On a CUDA device `volume` is that of the accessible solid less the layer,
  // and the check is the flux.
  double closure, check_volume;
  std::uint64_t uncertified_patches;
  // On a device: the concave patches that it left to the host.
  std::uint64_t extended_decisions;
};

struct ExcludedBatch {
  std::vector<ExcludedAtom> per_atom;  // in the order of the batch
  std::vector<ExcludedTotals> totals;  // one for each set
  // What a CUDA device left to the host, because rounding might decide it, or for lack of room:
  // balls whose exposed area and volume come from a triangulation, circles whose arcs do, corners
  // of thin triangles, concave patches, and sets with a probe that touches more than three atoms,
  // or with a tie.
  std::uint64_t host_balls = 0, host_circles = 0, host_corners = 0, host_patches = 0, host_sets = 0;
  std::string fallback;  // why the CPU measured what was meant for a device; empty if it did not
};

// A set's totals in the form of excluded_measures(), without shells and atoms.
ExcludedSurface surface_of(const ExcludedBatch& batch, std::size_t set);

class ExcludedMeasurer {
 public:
  virtual ~ExcludedMeasurer() = default;
  // Measures as excluded_measures() does. Backends differ by rounding: 1e-11 of a set's area and
  // accessible volume, counts and Euler characteristics not at all. A backend gives the same bits
  // at every call with the same batch. The atoms of the batch are without the probe's radius (Å).
  // Overwrites `result`. Throws as excluded_measures() and UnionMeasurer do.
  virtual void measure_into(ExcludedBatch& result, const SphereBatch& atoms, double probe,
                            Monitor* monitor = nullptr) const = 0;
  ExcludedBatch measure(const SphereBatch& atoms, double probe, Monitor* monitor = nullptr) const {
    ExcludedBatch result;
    measure_into(result, atoms, probe, monitor);
    return result;
  }
};

// Set after set, each on all cores.
std::unique_ptr<ExcludedMeasurer> make_cpu_excluded_measurer();

}  // namespace vdwmesh
