// Packs patches for a device: what bounded_patch.hpp describes, for many patches in one piece of
// memory, in the order of their size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "creases/plane/bounded_patch.hpp"
#include "creases/share/patch_device.hpp"

namespace vdwmesh {

// The sizes of a job's patch, with room for as many points as its area and boundary let expect. The
// functions below want them in the job.
PatchSizes sizes_of(const PatchJob& job);
// Whether a patch is for a device. A single thread meshes it, so it must not be large.
bool is_for_device(const PatchSizes& sizes);

// Copies a boundary to its place among packed ones.
void pack_boundary(const PatchBoundary& from, const PatchInput& to);

// How a device divides the memory that it may take: half of it is for results that it keeps, and a
// quarter for each of the two batches that it works on.
struct DeviceShares {
  std::uint64_t kept, batch;
  explicit DeviceShares(std::uint64_t bytes) : kept(bytes / 2), batch(bytes / 4) {}
};
// The most bytes that a batch takes on a device: of all its jobs with this function, and the points
// of their icosahedra besides. With everything: input, work memory, and results.
std::uint64_t device_bytes(const PatchSizes& sizes);
// The batches in which a device meshes jobs, each within so many bytes. Jobs that are withdrawn or
// not for a device are in none, nor are those that alone need more.
std::vector<std::vector<std::uint32_t>> batches_of(std::span<const PatchJob> jobs,
                                                   std::uint64_t batch_bytes);

// What a device gets of some patches (DeviceWork::balanced): those of up to so many points
// (PatchSizes::most_points), and for how many milliseconds it is busy with them.
struct DeviceLoad {
  std::uint32_t most_points = 0;
  double milliseconds = 0;
};
// `sizes` are the points of each patch, and the device is busy for so many milliseconds before it
// can begin.
DeviceLoad load_for_device(std::vector<std::uint32_t> sizes, HostWork host, double busy = 0);
// For how many of so many milliseconds a device is still busy after the host has looked at so many
// boundaries, or if so many patches are taken back from it.
double busy_after(double milliseconds, std::size_t boundaries);
double busy_without(double milliseconds, std::size_t patches);
// Of how many patches at least it is worth sending them to a device.
inline constexpr std::size_t kLeastPatchesForDevice = 1024;

// The most patches of a batch: as many as fill a device.
inline constexpr std::size_t kPatchesOfBatch = std::size_t{1} << 15;

class PatchBatch {
 public:
  // Takes the jobs `which` of `jobs` but those withdrawn, and keeps a view of `jobs`.
  PatchBatch(std::span<const PatchJob> jobs, std::span<const std::uint32_t> which);

  // Descending by size, so that threads side by side have about as much to do.
  std::span<const BoundedPatch> patches() const { return patches_; }
  // The job of patch i.
  std::uint32_t job(std::size_t i) const { return order_[i]; }
  std::span<const Vec3d> lattice() const { return lattice_; }
  std::size_t input_bytes() const { return input_bytes_; }
  std::size_t work_bytes() const { return work_bytes_; }

  // Where the sources of the boundary points of each patch begin, one patch after another; the last
  // entry is their number.
  const std::vector<std::uint64_t>& first_sources() const { return first_sources_; }

  // Writes the packed patches, on all cores.
  void pack(std::byte* input) const;
  // Writes the sources of all patches, on all cores, by `sources` as in PatchOrder.
  void pack_sources(const std::function<void(const PatchJob&, std::span<PointSource>)>& sources,
                    PointSource* out) const;

 private:
  void add_lattice(std::uint32_t parts, double edge_length);

  std::span<const PatchJob> jobs_;
  std::vector<std::uint32_t> order_;
  std::vector<BoundedPatch> patches_;
  std::vector<std::uint64_t> first_sources_{0};
  struct Lattice {
    std::uint32_t first = 0, count = 0;
  };
  std::vector<Lattice> lattices_;  // by the number of parts of an edge
  std::vector<Vec3d> lattice_;
  std::size_t input_bytes_ = 0, work_bytes_ = 0;
};

}  // namespace vdwmesh
