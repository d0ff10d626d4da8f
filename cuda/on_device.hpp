// Computations whose input and results stay in the memory of a CUDA device: atoms come in arrays
// that lie there, and meshes and measures are left there for the caller's own kernels.
//
// Only what the host needs to decide comes to it: the box around the atoms, counts, and the checks;
// for crease-exact meshes the balls, which the host arranges.
// Calls return when the device is done, so any stream may use a result at once. A result frees its
// memory in the order of the device's legacy default stream: after all work that was started on
// that stream, or on a blocking one, before. Who uses it on a non-blocking stream keeps the result
// until that work has ended. In a build without CUDA every function throws BackendUnavailable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "creases/exact_mesher.hpp"
#include "extract/extractor.hpp"
#include "measures/frame_measures.hpp"
#include "refine/refiner.hpp"
#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Numbers in device memory, aligned to their type.
struct DeviceNumbers {
  const std::byte* first = nullptr;
  CoordinateType type = CoordinateType::float64;
  std::ptrdiff_t stride = 0;  // bytes from one number to the next
};

// The device, by CUDA's number, in whose memory the address lies. Throws InvalidInput that begins
// with `name` if it lies in no device's memory, and BackendUnavailable if no device is usable or
// that one is not.
int device_of(const void* address, const char* name);

// Waits until the device has done all work that was started on the stream. `stream` is a
// cudaStream_t, or CUDA's number of a default stream: 1 of the legacy one, 2 of the calling
// thread's. Throws CudaError if that work has failed.
void wait_for_stream(int device, std::uintptr_t stream);

// Copies bytes from memory of the device to memory of the host, after the work of no stream.
void copy_to_host(void* to, const void* from, std::size_t bytes, int device);

// The balls of the same atoms in one frame or in several, in device memory. Copies share the balls.
class DeviceFrames {
 public:
  // Reads centres, and radii if they are given by DeviceNumbers, where they lie: all on `device`,
  // aligned to their type. Radii (Å) are grown by the probe, one for each atom. A centre that is
  // not finite, or no SphereSet accepts, makes its frame invalid(). Throws InvalidInput for no
  // frames or no atoms, and that names "radii[i]" for one that is no radius; DeviceMemoryExceeded.
  DeviceFrames(int device, const FrameCoordinates& centers, const DeviceNumbers& radii,
               double probe);
  DeviceFrames(int device, const FrameCoordinates& centers, std::span<const double> radii,
               double probe);
  // Copies balls of the host, as one frame, to the current device of the calling thread, or to the
  // first usable one if that is not usable.
  explicit DeviceFrames(const SphereSet& balls);

  std::size_t atoms() const;
  // Frames before the first invalid one, and why that one is invalid; empty if none is.
  std::size_t valid_frames() const;
  const std::optional<InvalidFrame>& invalid() const;
  // The boxes around the balls of the first frame and around their centres, and the least radius of
  // the balls, Å. No meaning if the first frame is invalid.
  const Box& balls() const;
  const Box& centers() const;
  double least_radius() const;

  struct Data;  // for the library's own use
  const Data& data() const { return *data_; }

 private:
  std::shared_ptr<const Data> data_;
};

// The arrays of a mesh in device memory. Each has the layout of the array of IndexedMesh.
struct CudaMeshArrays {
  int device = 0;
  std::size_t vertices = 0, triangles = 0;
  const Vec3d* positions = nullptr;          // Å
  const Vec3f* normals = nullptr;            // null without normals
  const SphereId* atoms = nullptr;           // the first sphere of each vertex's label
  const SphereId* triangle_atoms = nullptr;  // the sphere of each triangle; null of marching cubes
  const std::uint32_t* corners = nullptr;    // 3 for each triangle
};

// A mesh in device memory. Copies share the arrays; the last one frees them.
class CudaMesh {
 public:
  struct Data;  // for the library's own use
  explicit CudaMesh(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

  const CudaMeshArrays& arrays() const;
  // A copy in host memory, without half-edges.
  IndexedMesh download() const;

 private:
  std::shared_ptr<const Data> data_;
};

// The mesh of the first frame, extracted and then refined on its device: the arrays are those of
// SurfacePipeline::run(), bit for bit. The grid of the extraction replaces the grid of `refine`.
// Options about host memory, several devices, frames of cell lists and workspaces have no meaning.
// Throws as the pipeline for Backend::cuda does; InvalidFrame if the frame is invalid.
CudaMesh mesh_on_device(const DeviceFrames& spheres, const ExtractOptions& extract,
                        const RefineOptions& refine);

// A crease-exact mesh in device memory.
struct CudaExactMesh {
  CudaMesh mesh;  // with triangle_atoms
  ExactMeshStats stats;
  std::vector<ProjectionStats> levels;  // of the refinement; empty without
  // Why the host has made the mesh and copied it to the device; empty if it has not.
  std::string fallback;
};

// The crease-exact mesh of the balls of the first frame, refined if there is a subdivision. The
// arrays are those that make_exact_mesher() and make_refiner() of Backend::cuda make on the host,
// bit for bit. The balls travel to the host, which arranges them and settles how arcs are sampled;
// patches are put together where the device has meshed them, and half-edges, midpoints and normals
// of a refinement are made there. The host makes the mesh if features of the boundary were reduced
// to points (ExactMeshStats) or angles are bounded, and copies it to the device, which refines it.
// Of `refine`, the limit of host memory, the frame of cell lists and the workspace have no meaning,
// and the surface is that of the balls or none. Throws as the mesher and the refiner do,
// DeviceMemoryExceeded if the mesh does not fit the device beside the patches that it keeps until
// they are put together, InvalidFrame if the frame is invalid.
CudaExactMesh exact_mesh_on_device(const DeviceFrames& spheres, const ExactMeshOptions& exact,
                                   const RefineOptions& refine);

// The measures of the balls of several sets in device memory, of frames one row of atoms after
// another. Copies share the arrays.
class CudaMeasures {
 public:
  struct Data;  // for the library's own use
  explicit CudaMeasures(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

  int device() const;
  const SphereMeasures* rows() const;  // Å² and Å³; NaN for balls that were not to be measured
  const BallGradient* gradients() const;  // null if nobody asked

 private:
  std::shared_ptr<const Data> data_;
};

// Measures all valid frames as measure_frames() with the measurer of Backend::cuda does: `result`
// has the same bits. The measures of the balls are left on the device as well. options.measurer has
// no meaning. Does not throw for invalid frames: `result` has those before the first.
CudaMeasures measure_on_device(std::vector<ExactUnion>& result, const DeviceFrames& frames,
                               const FrameOptions& options);
// The same with derivatives of the sums of each frame, which are left on the device. The weights
// are those of the atoms, in its memory, for every frame alike. `kink_spheres` gets those of each
// frame (UnionGradients). Throws InvalidInput if options.measures.measured names atoms, and for
// weights and derivatives as UnionMeasurer does.
CudaMeasures gradients_on_device(std::vector<ExactUnion>& result,
                                 std::vector<std::uint64_t>& kink_spheres,
                                 const DeviceFrames& frames, const BatchWeights& weights,
                                 const FrameOptions& options);
// Measures many sets, whose balls are those of the first frame: set i has the balls offsets[i] up
// to offsets[i + 1] (SphereBatch). `result` has the bits of UnionMeasurer of Backend::cuda. Without
// weights (null), which are those of all balls, there are no derivatives. Throws InvalidFrame if
// the frame is invalid, and as UnionMeasurer does.
CudaMeasures sets_on_device(BatchMeasures& result, std::vector<std::uint64_t>& kink_spheres,
                            const DeviceFrames& balls, std::span<const std::size_t> offsets,
                            const BatchWeights* weights, Monitor* monitor = nullptr);

}  // namespace vdwmesh
