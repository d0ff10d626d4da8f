// The CPU's ExcludedMeasurer, and the totals of the sets that a device measured.
//
// Terms. A row is what one ball has of its set's surface: areas and a volume (BallRow), and sums
// that check them (CheckRow). A chunk is some rows of one set, which the device has summed. The
// flux is a second volume, ∫ q · n dA / 3 with the points q and the outward normals n of the
// surface. A crease has a number, which its two probes give opposite signs.
//
// Claim. If no element of a set is missing or wrong, then ∫ n dA is 0, the numbers of the creases
// sum to 0, the Euler characteristic is even, and the flux is the volume. Of a set that lacks an
// element, one of the four shows it: a hole is far larger than rounding, and a chance of 2^-64
// hides a crease.
//
// Steps, for each set: (1) its chunks are summed in their order; (2) its totals are made of the
// sums; (3) if the device gave the set up, or if one of the four does not hold, excluded_measures()
// measures the set in place of the device.
#include "excluded/excluded_measurer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/errors.hpp"
#include "core/sum.hpp"
#include "excluded/elements/batch_rows.hpp"

namespace vdwmesh::excluded::elements {
namespace {

// A missing arc or patch leaves a hole far larger than this share of the area.
constexpr double kClosed = 1e-9;
// The two volumes of a set agree to this share of them.
constexpr double kSameVolume = 1e-6;

struct SetSum {
  WideSum contact, saddle, concave, volume, contact_layer, saddle_layer, x, y, z, flux;
  std::uint64_t creases = 0;
  std::int64_t sixths = 0;
  ExcludedCounts counts{};

  void add(const ChunkSum& sum) {
    const auto& [row, check] = sum;
    contact.add(row.contact);
    saddle.add(row.saddle);
    concave.add(row.concave);
    volume.add(row.volume);
    contact_layer.add(check.contact_layer);
    saddle_layer.add(check.saddle_layer);
    x.add(check.normal.x);
    y.add(check.normal.y);
    z.add(check.normal.z);
    flux.add(check.flux);
    creases += check.creases;
    sixths += check.sixths;
    counts.arcs += check.counts.arcs;
    counts.whole_rings += check.counts.rings;
    counts.spindle_saddles += check.counts.spindles;
    counts.cusps += check.counts.cusps;
    counts.probes += check.counts.probes;
    counts.low_probes += check.counts.low_probes;
    counts.crease_arcs += check.counts.crease_arcs;
  }

  ExcludedTotals totals(const SphereMeasures& grown) const {
    ExcludedTotals t{};
    t.area_by_kind = {contact.value(), saddle.value(), concave.value()};
    t.area = t.area_by_kind.sum();
    t.volume = volume.value();
    t.accessible_area = grown.area;
    t.accessible_volume = grown.volume;
    const double layers = grown.volume - t.volume;
    t.layer_by_kind = {contact_layer.value(), saddle_layer.value(), 0};
    t.layer_by_kind.concave = layers - t.layer_by_kind.contact - t.layer_by_kind.saddle;
    t.euler_characteristic = sixths / 6;
    t.counts = counts;
    t.counts.crease_arcs /= 2;
    t.closure = norm(Vec3d{x.value(), y.value(), z.value()}) / t.area;
    t.check_volume = flux.value();
    return t;
  }
  bool is_proved(const ExcludedTotals& t) const {
    return creases == 0 && sixths % 12 == 0 && t.closure < kClosed && t.area > 0 &&
           std::abs(t.check_volume - t.volume) < kSameVolume * t.volume;
  }
};

}  // namespace

void check_probe(double probe) {
  if (!(probe > 0 && std::isfinite(probe))) {
    throw InvalidInput(fmt::format("the probe's radius is {}; it must be above 0", probe));
  }
}

void measure_set(ExcludedBatch& result, const SphereBatch& atoms, std::size_t set, double probe,
                 Monitor* monitor) {
  const std::size_t first = atoms.set_begin(set), end = atoms.set_end(set);
  const SphereSet spheres(std::vector<Sphere>(atoms.spheres + first, atoms.spheres + end));
  const ExcludedSurface s =
      excluded_measures(spheres, {.probe = probe, .per_atom = true, .monitor = monitor}).complete;
  std::copy(s.per_atom.begin(), s.per_atom.end(),
            result.per_atom.begin() + static_cast<std::ptrdiff_t>(first));
  result.totals[set] = {s.area,
                        s.volume,
                        s.area_by_kind,
                        s.layer_by_kind,
                        s.accessible_area,
                        s.accessible_volume,
                        s.topology.value().euler_characteristic,
                        s.counts,
                        s.checks.closure,
                        s.checks.check_volume,
                        s.checks.uncertified_patches,
                        s.checks.extended_decisions};
}

BallRow* rows_of(ExcludedBatch& result, const SphereBatch& atoms) {
  static_assert(sizeof(BallRow) == sizeof(ExcludedAtom) && sizeof(BallRow) == 4 * sizeof(double));
  static_assert(offsetof(BallRow, volume) == offsetof(ExcludedAtom, volume));
  result.per_atom.resize(atoms.size);
  return reinterpret_cast<BallRow*>(result.per_atom.data());
}

std::vector<std::size_t> offsets_of(const SphereBatch& atoms) {
  std::vector<std::size_t> offsets{0};
  for (std::size_t set = 0; set < atoms.set_count(); ++set) offsets.push_back(atoms.set_end(set));
  return offsets;
}

void sum_sets(ExcludedBatch& result, const SphereBatch& atoms, double probe,
              const ElementSums& sums, const std::vector<SphereMeasures>& grown, Monitor* monitor) {
  result.totals.resize(atoms.set_count());
  result.host_circles = sums.host_circles;
  result.host_corners = sums.host_corners;
  result.host_patches = 0;
  result.host_sets = 0;
  for (std::size_t set = 0; set < atoms.set_count(); ++set) {
    SetSum sum;
    for (std::size_t i = sums.first_chunk[set]; i < sums.first_chunk[set + 1]; ++i) {
      sum.add(sums.chunks[i]);
    }
    result.totals[set] = sum.totals(grown[set]);
    result.totals[set].extended_decisions = sums.host_patches[set];
    result.host_patches += sums.host_patches[set];
    if (sums.failed[set] == 0 && sum.is_proved(result.totals[set])) continue;
    ++result.host_sets;
    measure_set(result, atoms, set, probe, monitor);
  }
}

}  // namespace vdwmesh::excluded::elements

namespace vdwmesh {
namespace {

class CpuExcludedMeasurer final : public ExcludedMeasurer {
 public:
  void measure_into(ExcludedBatch& result, const SphereBatch& atoms, double probe,
                    Monitor* monitor) const override {
    check_sets(atoms);
    excluded::elements::check_probe(probe);
    if (atoms.memory != MemorySpace::host) {
      throw InvalidInput("the CPU cannot read spheres in memory of a device");
    }
    result = {};
    result.per_atom.resize(atoms.size);
    result.totals.resize(atoms.set_count());
    for (std::size_t set = 0; set < atoms.set_count(); ++set) {
      excluded::elements::measure_set(result, atoms, set, probe, monitor);
    }
  }
};

}  // namespace

ExcludedSurface surface_of(const ExcludedBatch& batch, std::size_t set) {
  const ExcludedTotals& t = batch.totals.at(set);
  ExcludedSurface s{};
  s.area = t.area;
  s.volume = t.volume;
  s.area_by_kind = t.area_by_kind;
  s.layer_by_kind = t.layer_by_kind;
  s.accessible_area = t.accessible_area;
  s.accessible_volume = t.accessible_volume;
  s.euler_characteristic = t.euler_characteristic;
  s.counts = t.counts;
  s.checks = {t.closure, t.check_volume, t.extended_decisions, 0, t.uncertified_patches};
  return s;
}

std::unique_ptr<ExcludedMeasurer> make_cpu_excluded_measurer() {
  return std::make_unique<CpuExcludedMeasurer>();
}

}  // namespace vdwmesh
