// Looks at many boundaries, and meshes many patches, at once, in place of the host's threads. The
// CUDA backend is one (cuda/mesher/). UnionMesher gives it boundaries that nobody has looked at,
// and later patches whose boundaries are triangulated (device_patches.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "creases/exact_mesher.hpp"
#include "creases/patch/patch_mesher.hpp"

namespace vdwmesh {

class MeshPlacement;
class MeshTeam;

struct PatchJob {
  std::uint32_t ball;
  const PatchProgress* progress;  // with a triangulation, and without chains since
  double edge_length;             // as in PatchOptions
  double area;                    // of the patch, in squared radii: roughly how many triangles
  Demand demand;
  PatchSizes sizes = {};  // sizes_of(), so that who plans batches need not look at the progress
  // The host has changed the boundary since, and meshes the patch itself. The device must not look
  // at the progress any more.
  bool is_withdrawn = false;

  // The rest is set by the device.
  // Whether it has looked at the progress. It sets this where it looks (PatchOrder::look()).
  bool is_begun = false;
  // Whether it has meshed the patch: then there are requests in `patch`, or it keeps the result for
  // place(), or, if it has no memory left for that, the result is in `patch`, with its sources. If
  // it keeps the result or there is none, `patch` is null.
  bool is_done = false;
  std::unique_ptr<PatchMesh> patch = nullptr;
  bool is_kept = false;
  std::uint32_t interior = 0, triangles = 0;  // how many points and triangles it keeps
  std::uint64_t kept = 0;                     // the device's name for the result
};

struct PatchOrder {
  std::span<PatchJob> jobs;
  // Calls a function that looks at the progress of jobs, or at whether they are withdrawn, while
  // the host changes neither. From any thread.
  std::function<void(const std::function<void()>&)> look;
  // Writes the sources of the points of a job's boundary. To be called from look().
  std::function<void(const PatchJob&, std::span<PointSource>)> sources;
  Monitor* monitor;
};

// What the host's cores do while a device meshes: rounds of boundaries, or the patches left to
// them.
enum class HostWork : std::uint8_t { rounds, patches };

// A boundary that nobody has looked at yet.
struct LookJob {
  PatchProgress* progress;           // with the boundary alone
  double edge_length = 0, area = 0;  // as in PatchOptions
};

// First looks at boundaries. The functions are called from any thread.
struct LookOrder {
  std::size_t count;
  // Gathers boundary i, 0 <= i < count.
  std::function<LookJob(std::size_t i)> begin;
  // Takes the requests of a boundary, as PatchMesh has them. Its progress has the triangulation.
  // Throws Cancelled.
  std::function<void(std::size_t i, PatchVector<PieceSplit>&& splits)> end;
};

// Where a kept patch goes in the mesh.
struct PatchPlace {
  std::uint64_t kept;                 // PatchJob::kept
  std::uint32_t interior, triangles;  // how many
  Sphere sphere;
  SphereId id;
  std::uint64_t first_vertex, first_triangle;  // of its interior points, of its triangles
};

struct PatchPlaces {
  std::span<const PatchPlace> places;             // ascending by vertex and by triangle
  double unit;                                    // of the spheres' lengths, in Å: a power of two
  std::span<const std::uint32_t> first_vertices;  // ArcSampling::first_vertices()
};

// A patch that the host has meshed, and its place. PatchPlace::kept has no meaning.
struct PatchOfHost {
  const PatchMesh* patch;  // with its sources
  PatchPlace place;
};

// What a mesh in the device's memory is put together from.
struct MeshToAssemble {
  MeshSize size;                         // of the mesh
  const MeshPlacement& boundary;         // places its first vertices: corners and points of arcs
  std::span<const PatchOfHost> of_host;  // ascending as PatchPlaces::places
  PatchPlaces kept;
};

class PatchDevice {
 public:
  virtual ~PatchDevice() = default;
  // Looks at boundaries as mesh_patch() would with Demand::quality and PatchStage::boundary, bit by
  // bit. It does not end those that double precision does not decide, that are not simple, or that
  // have no room. Throws Cancelled, DeviceMemoryExceeded.
  virtual void look(const LookOrder& order) = 0;
  // From how many threads mesh() may be called at the same time.
  virtual std::size_t threads() const = 0;
  // Meshes jobs as mesh_patch() would, bit by bit, and sets is_done for them. It leaves out those
  // that double precision does not decide or that outgrow their memory, and those withdrawn before
  // it looked at them. Results are kept until forget(), as far as memory allows. Throws Cancelled,
  // DeviceMemoryExceeded.
  virtual void mesh(const PatchOrder& order) = 0;
  // In how many batches it has meshed patches since forget().
  virtual std::uint64_t batches() const = 0;
  // Writes kept patches to their places in the mesh, which has room for them. Whatever vertices and
  // triangles of other patches are between the first and the last of the places may be overwritten.
  // Throws DeviceMemoryExceeded.
  virtual void place(const PatchPlaces& places, IndexedMesh& mesh) = 0;
  // Whether the mesh is wanted in the device's memory: then assemble() is called in place of
  // place(). A mesh whose corners were joined, or whose topology must be looked at, is the host's
  // all the same: its boundary has features that were reduced to points.
  virtual bool keeps_mesh() const = 0;
  // Makes the mesh in the device's memory, where it stays. Throws DeviceMemoryExceeded.
  virtual void assemble(const MeshToAssemble& parts) = 0;
  // Gives the memory of kept results back, and begins to count batches anew.
  virtual void forget() = 0;
};

// mesh_union() with a device for the patches, or without (null). The mesh is empty if the device
// has it in its memory.
ExactMesh mesh_union_with(PatchDevice* device, const SphereSet& spheres,
                          const ExactMeshOptions& options);
// The same by several processes: each has all spheres, and the team gets its piece of the mesh that
// mesh_union() makes. The memory limit and the monitor are those of a process. Precondition: a
// process with a device is alone. Throws in all processes.
ExactMeshStats mesh_union_by(MeshTeam& team, PatchDevice* device, const SphereSet& spheres,
                             const ExactMeshOptions& options);

}  // namespace vdwmesh
