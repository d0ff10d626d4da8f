// Lays out and packs patches for a device.
//
// Steps: (1) order the jobs by size; (2) for each, find the sizes and places of its arrays in the
// input and in the work memory, and the points of its icosahedron, which jobs of equal edge length
// share; (3) copy boundaries and triangulations to their places.
#include "creases/share/patch_batch.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <utility>

#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

// Of all points a patch may have on a device, and of all parts of an icosahedron's edge.
constexpr std::uint32_t kMostPoints = 2048, kMostParts = SpherePoints::kMostPartsOfWhole;

// Of the points of an icosahedron each edge of which has so many parts.
std::uint64_t lattice_bytes(std::uint32_t parts) {
  return (10 * std::uint64_t{parts} * parts + 2) * sizeof(Vec3d);
}

double clamped_edge(const PatchJob& job) {
  return std::min(job.edge_length, triangulator::kLongestEdge);
}

template <class From, class To>
void copy(const PatchVector<From>& from, To* to) {
  std::copy(from.begin(), from.end(), to);
}

}  // namespace

void pack_boundary(const PatchBoundary& from, const PatchInput& to) {
  copy(from.points, to.points);
  copy(from.pieces, to.pieces);
  copy(from.caps, to.caps);
  copy(from.through, to.through);
}

// There are about as many points inside as half the triangles of that edge length that the area
// holds. Along the boundary triangles are smaller. The allowances are for patches of molecules; one
// that needs more is left to the host, as any that fails.
PatchSizes sizes_of(const PatchJob& job) {
  const PatchBoundary& b = job.progress->boundary;
  const double edge = clamped_edge(job);
  const double inside = job.area / (std::sqrt(3.0) / 2 * edge * edge);
  const auto count = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
  const double most = 1.75 * static_cast<double>(b.points.size()) + 1.25 * inside + 64;
  return {count(b.points),
          count(b.pieces),
          count(b.caps),
          count(b.through),
          count(job.progress->plane.triangles),
          static_cast<std::uint32_t>(std::min(most, 1e9))};
}

bool is_for_device(const PatchSizes& sizes) { return sizes.most_points <= kMostPoints; }

// Interior points and triangles are counted twice: a batch has them in its work memory, and
// gathers them.
std::uint64_t device_bytes(const PatchSizes& sizes) {
  ArrayPlaces input(nullptr);
  patch_input(sizes, input);
  return input.bytes() + vdwmesh::work_bytes(sizes) + sizeof(BoundedPatch) + sizeof(PatchOutcome) +
         3 * sizeof(std::uint64_t) + sizes.points * sizeof(PointSource) +
         sizes.most_points * sizeof(Vec3d) +
         capacity(sizes, PatchArray::triangles) * sizeof(std::array<std::uint32_t, 3>) +
         capacity(sizes, PatchArray::requests) * sizeof(PieceSplit);
}

std::vector<std::vector<std::uint32_t>> batches_of(std::span<const PatchJob> jobs,
                                                   std::uint64_t batch_bytes) {
  struct BatchNeed {
    std::uint64_t bytes = 0;  // 0: not for a device
    std::uint32_t parts = 0;  // of an edge of its icosahedron
  };
  std::vector<BatchNeed> needs(jobs.size());
  for_each_index(jobs.size(), [&](std::size_t j) {
    if (jobs[j].is_withdrawn) return;
    const std::uint32_t parts = SpherePoints::parts(clamped_edge(jobs[j]));
    const PatchSizes& sizes = jobs[j].sizes;
    if (!is_for_device(sizes) || parts > kMostParts) return;
    const std::uint64_t bytes = device_bytes(sizes);
    if (bytes + lattice_bytes(parts) <= batch_bytes) needs[j] = {bytes, parts};
  });
  std::vector<std::vector<std::uint32_t>> batches;
  std::bitset<kMostParts + 1> lattices;  // of the last batch
  std::uint64_t bytes = 0;               // of the last batch
  const auto with = [&](const BatchNeed& need) {
    return bytes + need.bytes + (lattices[need.parts] ? 0 : lattice_bytes(need.parts));
  };
  for (std::uint32_t j = 0; j < jobs.size(); ++j) {
    const BatchNeed& need = needs[j];
    if (need.bytes == 0) continue;
    if (batches.empty() || with(need) > batch_bytes || batches.back().size() == kPatchesOfBatch) {
      batches.emplace_back();
      lattices.reset();
      bytes = 0;
    }
    bytes = with(need);
    lattices.set(need.parts);
    batches.back().push_back(j);
  }
  return batches;
}

namespace {

// The figures are those of an H200 and 16 cores of its host (docs/exact_mesh.md). All patches of a
// few thousand are under way at once, so the largest of them ends last: a thread takes 6.9 ms for
// one of 495 points, the largest of haemoglobin's 1,905 that the first look leaves alone. More
// patches slow each other down, fitted to such runs: a millisecond for every 600. A core meshes 7.5
// patches of 310 points in a millisecond, since 16 of them take 541 ms for 65,536, and looks at 30
// boundaries.
constexpr double kPointsOfThread = 495 / 6.9, kPatchesOfDevice = 600;
constexpr double kPointsOfCore = 7.5 * 310, kBoundariesOfCore = 30;

double cores() {
  return static_cast<double>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace

double busy_after(double milliseconds, std::size_t boundaries) {
  return std::max(0.0,
                  milliseconds - static_cast<double>(boundaries) / (kBoundariesOfCore * cores()));
}

double busy_without(double milliseconds, std::size_t patches) {
  return std::max(0.0, milliseconds - static_cast<double>(patches) / kPatchesOfDevice);
}

// Of some thousand patches it gets the smallest, because one thread meshes a patch, and as many as
// let the device and the host's cores end at the same time. Of more patches it gets all while the
// host has rounds to do, if it has nothing else to do itself. Few are not worth the transfer.
DeviceLoad load_for_device(std::vector<std::uint32_t> sizes, HostWork host, double busy) {
  constexpr std::size_t kMany = 16384;
  if (sizes.size() < kLeastPatchesForDevice) return {};
  std::size_t count = sizes.size();
  const auto of_device = [&](std::uint32_t largest) {
    return largest / kPointsOfThread + static_cast<double>(count) / kPatchesOfDevice;
  };
  if (count >= kMany && host == HostWork::rounds && busy == 0) {
    const std::uint32_t largest = *std::ranges::max_element(sizes);
    return {largest, of_device(largest)};
  }
  tbb::parallel_sort(sizes.begin(), sizes.end());
  double points = 0;  // of the patches for the host
  for (; count > 0; --count) {
    const std::uint32_t largest = sizes[count - 1];
    if (points / (kPointsOfCore * cores()) >= busy + of_device(largest)) break;
    points += largest;
  }
  if (count == 0) return {};
  return {sizes[count - 1], of_device(sizes[count - 1])};
}

PatchBatch::PatchBatch(std::span<const PatchJob> jobs, std::span<const std::uint32_t> which)
    : jobs_(jobs) {
  // What a job needs, found on all cores.
  struct PackedJob {
    std::uint32_t job, parts;
    PatchSizes sizes;
    std::size_t input_bytes, work_bytes;
    bool is_withdrawn;
  };
  std::vector<PackedJob> needs(which.size());
  for_each_index(which.size(), [&](std::size_t i) {
    const PatchJob& job = jobs[which[i]];
    needs[i].is_withdrawn = job.is_withdrawn;
    if (job.is_withdrawn) return;
    const PatchSizes& sizes = job.sizes;
    ArrayPlaces places(nullptr);
    patch_input(sizes, places);
    needs[i] = {which[i],
                SpherePoints::parts(clamped_edge(job)),
                sizes,
                places.bytes(),
                vdwmesh::work_bytes(sizes),
                false};
  });
  std::erase_if(needs, [](const PackedJob& need) { return need.is_withdrawn; });
  // Patches of equal size stay in the order of their jobs.
  tbb::parallel_sort(needs.begin(), needs.end(), [](const PackedJob& a, const PackedJob& b) {
    return std::pair(b.sizes.most_points, a.job) < std::pair(a.sizes.most_points, b.job);
  });
  lattices_.resize(kMostParts + 1);
  order_.reserve(which.size());
  patches_.reserve(which.size());
  for (const PackedJob& need : needs) {
    const PatchJob& job = jobs[need.job];
    if (need.parts > kMostParts) continue;
    add_lattice(need.parts, clamped_edge(job));
    const Lattice& lattice = lattices_[need.parts];
    order_.push_back(need.job);
    patches_.push_back({need.sizes, lattice.first, lattice.count, input_bytes_, work_bytes_,
                        job.edge_length, job.progress->plane.largest, job.demand});
    first_sources_.push_back(first_sources_.back() + need.sizes.points);
    input_bytes_ += need.input_bytes;
    work_bytes_ += need.work_bytes;
  }
}

void PatchBatch::add_lattice(std::uint32_t parts, double edge_length) {
  Lattice& known = lattices_[parts];
  if (known.count > 0) return;
  SpherePoints maker;
  const std::vector<Vec3d>& points = maker.points(edge_length);
  known = {static_cast<std::uint32_t>(lattice_.size()), static_cast<std::uint32_t>(points.size())};
  lattice_.insert(lattice_.end(), points.begin(), points.end());
}

void PatchBatch::pack(std::byte* input) const {
  tbb::parallel_for(std::size_t{0}, patches_.size(), [&](std::size_t i) {
    const PatchProgress& from = *jobs_[order_[i]].progress;
    ArrayPlaces places(input + patches_[i].input);
    const PatchInput to = patch_input(patches_[i].sizes, places);
    pack_boundary(from.boundary, to);
    copy(from.plane.points, to.plane_points);
    copy(from.plane.star, to.star);
    copy(from.plane.triangles, to.triangles);
  });
}

void PatchBatch::pack_sources(
    const std::function<void(const PatchJob&, std::span<PointSource>)>& sources,
    PointSource* out) const {
  tbb::parallel_for(std::size_t{0}, patches_.size(), [&](std::size_t i) {
    sources(jobs_[order_[i]], {out + first_sources_[i], patches_[i].sizes.points});
  });
}

}  // namespace vdwmesh
