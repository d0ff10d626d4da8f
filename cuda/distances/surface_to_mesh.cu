// From the exposed surface to a mesh: a warp for each patch takes its samples, and
// find_nearest_triangles() measures them.
//
// Samples are counted first, patch by patch, and prefix sums of the counts are the places at which
// a second pass writes them, in the order of the host: along the walk through the lattice of a
// sphere, patch after patch. Both passes run the same code.
#include <vector>

#include "cuda/distances/device_statistics.cuh"
#include "cuda/distances/measure_distances.cuh"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/warp.cuh"

namespace vdwmesh::distance {
namespace {

constexpr unsigned kThreads = 128;

// The patches and how densely they are sampled.
struct SampledPatches {
  const Patch* patches;
  const std::uint32_t* ranks;  // numbers of their random streams
  std::uint32_t count;
  double density;  // per Å²
  std::uint64_t seed;
};

// The two kinds of samples: inside patches, for all figures, and on their borders, for the maximum.
enum Kind { kInside, kBorder, kKinds };

// Samples that a warp appends in the order of its lanes. Without memory they are only counted.
class OrderedSamples {
 public:
  __device__ explicit OrderedSamples(Vec3d* to) : to_(to) {}
  // Called by all lanes at once; each has a point if `here`.
  __device__ void append(bool here, const Vec3d& p) {
    const unsigned appending = __ballot_sync(kAllLanes, here);
    if (here && to_ != nullptr) to_[count_ + bits_below(appending, threadIdx.x % kWarp)] = p;
    count_ += static_cast<unsigned>(count_bits(appending));
  }
  __device__ std::uint64_t count() const { return count_; }

 private:
  Vec3d* to_;
  std::uint64_t count_ = 0;
};

// Appends the exposed points of the lattice, as sample_patch() does on the host. The lanes of the
// warp take points in turns.
__device__ void append_inside(const Patch& patch, double density, Random& random,
                              OrderedSamples& samples) {
  const SphereLattice lattice = lattice_on(patch, density, random);
  for (std::uint64_t first = 0; first < lattice.size(); first += kWarp) {
    const std::uint64_t step = first + threadIdx.x % kWarp;
    bool exposed = step < lattice.size();
    Vec3d direction{};
    if (exposed) {
      direction = lattice.point(static_cast<double>(lattice.at(step)));
      exposed = is_exposed(patch, direction);
    }
    samples.append(exposed, patch.ball.center + patch.ball.radius * direction);
  }
}

// Appends exposed points of circles and then corners, as sample_border() does on the host. The
// lanes of the warp take points in turns.
__device__ void append_border(const Patch& patch, double density, Random& random,
                              OrderedSamples& samples) {
  const double r = patch.ball.radius;
  const unsigned lane = threadIdx.x % kWarp;
  for (std::uint32_t i = 0; i < patch.circles; ++i) {
    if (patch.covers[i].place < patch.place) continue;
    const CircleSamples circle(patch, i, density, random);
    for (std::uint64_t first = 0; first < circle.size(); first += kWarp) {
      bool exposed = first + lane < circle.size();
      Vec3d direction{};
      if (exposed) {
        direction = circle[first + lane];
        exposed = is_exposed(patch, direction, i);
      }
      samples.append(exposed, patch.ball.center + r * direction);
    }
  }
  for (std::uint32_t first = 0; first < patch.corner_count; first += kWarp) {
    const bool here = first + lane < patch.corner_count;
    const SphereCorner corner = here ? patch.corners[first + lane] : SphereCorner{};
    samples.append(here && corner.first, patch.ball.center + r * corner.position);
  }
}

// Numbers of samples of each kind, or places of the first ones.
struct SampleCounts {
  std::uint64_t* of[kKinds];  // [patch]
};

// A warp for each patch. The last one writes counts of 0, for the prefix sums.
__global__ void count_samples(SampledPatches all, SampleCounts counts) {
  const std::uint64_t i = thread_index() / kWarp;
  if (i > all.count) return;
  OrderedSamples inside(nullptr), border(nullptr);
  if (i < all.count) {
    Random random(all.seed, all.ranks[i]);
    append_inside(all.patches[i], all.density, random, inside);
    append_border(all.patches[i], sqrt(all.density), random, border);
  }
  if (threadIdx.x % kWarp != 0) return;
  counts.of[kInside][i] = inside.count();
  counts.of[kBorder][i] = border.count();
}

// A part of the patches, and where the samples of each kind begin that belong to it.
struct PatchRange {
  std::uint32_t begin, end;
  std::uint64_t base[kKinds];
};
struct SampleMemory {
  Vec3d* of[kKinds];
};

// A warp for each patch of the range.
__global__ void emit_samples(SampledPatches all, SampleCounts first, PatchRange range,
                             SampleMemory samples) {
  const std::uint64_t i = range.begin + thread_index() / kWarp;
  if (i >= range.end) return;
  OrderedSamples inside(samples.of[kInside] + (first.of[kInside][i] - range.base[kInside]));
  OrderedSamples border(samples.of[kBorder] + (first.of[kBorder][i] - range.base[kBorder]));
  Random random(all.seed, all.ranks[i]);
  append_inside(all.patches[i], all.density, random, inside);
  append_border(all.patches[i], sqrt(all.density), random, border);
}

// How many samples of each kind the patches before each one have, and all: on the device and on the
// host.
class SampleOffsets {
 public:
  SampleOffsets(const SampledPatches& patches, const Stream& stream) {
    for (DeviceArray<std::uint64_t>& array : device_)
      array = DeviceArray<std::uint64_t>(patches.count + std::size_t{1}, stream);
    launch("count_samples", count_samples,
           over((std::uint64_t{patches.count} + 1) * kWarp, kThreads), stream, patches, device());
    for (int kind = 0; kind < kKinds; ++kind) scan(kind, stream);
    stream.wait();
  }
  SampleCounts device() const { return {device_[kInside].data(), device_[kBorder].data()}; }
  std::uint64_t operator()(int kind, std::uint32_t patch) const { return host_[kind][patch]; }
  std::uint64_t all(std::uint32_t patch) const {
    return host_[kInside][patch] + host_[kBorder][patch];
  }

 private:
  void scan(int kind, const Stream& stream) {
    const DeviceArray<std::uint64_t>& array = device_[kind];
    run_cub("places of samples", stream, [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceScan::ExclusiveSum(scratch, bytes, array.data(), array.size(),
                                           stream.get());
    });
    host_[kind].resize(array.size());
    check_cuda(cudaMemcpyAsync(host_[kind].data(), array.data(), array.bytes(),
                               cudaMemcpyDeviceToHost, stream),
               "download");
  }

  DeviceArray<std::uint64_t> device_[kKinds];
  std::vector<std::uint64_t> host_[kKinds];
};

// Cuts the patches into ranges of whole blocks, each with at most kDistancesPerLaunch samples or of
// one block.
std::vector<PatchRange> cut(const SampleOffsets& offsets, std::uint32_t patches) {
  std::vector<PatchRange> ranges;
  const auto per_block = static_cast<std::uint32_t>(kPatchesPerBlock);
  for (std::uint32_t begin = 0; begin < patches;) {
    const std::uint64_t most = offsets.all(begin) + kDistancesPerLaunch;
    std::uint32_t end = begin;
    do {
      end = patches - end > per_block ? end + per_block : patches;
    } while (end < patches &&
             offsets.all(patches - end > per_block ? end + per_block : patches) <= most);
    ranges.push_back({begin, end, {offsets(kInside, begin), offsets(kBorder, begin)}});
    begin = end;
  }
  return ranges;
}

// Measures the samples of a range and adds them to the statistics.
void add_range(const SampledPatches& patches, const SampleOffsets& offsets, const PatchRange& range,
               const SearchedMesh& mesh, double reach, DeviceStatistics& statistics,
               const Stream& stream) {
  DeviceArray<Vec3d> samples[kKinds];
  for (int kind = 0; kind < kKinds; ++kind) {
    samples[kind] =
        DeviceArray<Vec3d>(offsets(kind, range.end) - offsets(kind, range.begin), stream);
  }
  launch("emit_samples", emit_samples,
         over(std::uint64_t{range.end - range.begin} * kWarp, kThreads), stream, patches,
         offsets.device(), range, SampleMemory{samples[kInside].data(), samples[kBorder].data()});
  DeviceArray<double> found[kKinds];
  for (int kind = 0; kind < kKinds; ++kind) {
    const std::uint64_t count = samples[kind].size();
    found[kind] = DeviceArray<double>(count, stream);
    find_nearest_triangles(mesh, samples[kind], reach, found[kind].data(), stream);
  }
  statistics.add(
      found[kInside].data(), found[kInside].size(),
      PatchBlocks{offsets.device().of[kInside] + range.begin, range.base[kInside],
                  range.end - range.begin, static_cast<std::uint32_t>(kPatchesPerBlock)});
  statistics.add_extremes(found[kBorder].data(), found[kBorder].size(), found[kBorder].size());
}

}  // namespace

DistanceStatistics surface_to_mesh(const DeviceExposedPatches& patches, const SearchedMesh& mesh,
                                   double density, double reach, const DistanceOptions& options,
                                   const Stream& stream) {
  const SampledPatches sampled{patches.patches(), patches.ranks(), patches.size(), density,
                               options.seed};
  const SampleOffsets offsets(sampled, stream);
  const std::vector<PatchRange> ranges = cut(offsets, sampled.count);
  begin_stage(options.monitor, "distances of the surface (CUDA)", ranges.size());
  DeviceStatistics statistics(stream);
  for (const PatchRange& range : ranges) {
    add_range(sampled, offsets, range, mesh, reach, statistics, stream);
    advance(options.monitor, 1);
  }
  return statistics.result();
}

}  // namespace vdwmesh::distance
