// The crease-exact mesh of the boundary of a union of balls. It is the second mesher, beside
// marching cubes, and its edges follow the creases in which spheres meet.
//
// A corner lies on three spheres, a vertex of an arc on two, any other vertex on one, each up to
// rounding. Each triangle belongs to one sphere: its vertices lie on that sphere, and the triangle
// lies in that sphere's power cell. Each arc is sampled once. The patches on both sides of the arc
// use the same points, so the mesh is watertight.
//
// Topology. The regular triangulation of the balls, which is exact, decides which corners, arcs and
// patches there are. The mesh has the topology of the union, unless features are too small for
// double coordinates. By default such features are arcs shorter than 1e-8 of the sphere's radius,
// circles with a radius below 1e-6 of it, and curves nearer to each other than 1e-8 of it. The
// mesher reduces each of them to a point and separates surfaces that meet in this point only. What
// the triangulation gives is in arcs/arrangement.hpp.
//
// Fallbacks. If the reduction changes the topology, the mesher tries again with the smaller
// thresholds 1e-11 for arcs and 1e-7 for circles. If curves lie too close to be meshed, it tries
// larger thresholds, at last 1e-5 and 1e-4. `ExactMeshStats` counts the reduced features and says
// by how much the topology of the mesh differs from the exact one.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/errors.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class Monitor;

// Which patches a CUDA device gets, if there is one. `balanced` is the quickest: of few patches
// none, of some thousand as many as it meshes while the host's cores mesh the others, of more all.
// `all`: all of them, however few.
enum class DeviceWork : std::uint8_t { balanced, all };

// The largest bound on angles. What smoothing and flips take is added to it (patch_angles.cpp), and
// above 30° no algorithm is known to end.
inline constexpr double kLargestMinAngle = 25;  // degrees

struct ExactMeshOptions {
  double edge_length = 0.35;  // Å; shorter at narrow features, and for the area of small patches
  // Å, by sphere, in place of edge_length if not empty. Along the arc between two spheres the
  // shorter length holds; from there the triangles of the other sphere grow to its own length. Of
  // equal spheres the first one counts.
  std::span<const double> edge_lengths = {};
  // Degrees, at most kLargestMinAngle: no triangle has a smaller angle, but near sharp corners of
  // patches (mesher/patch_angles.hpp), and where ExactMeshStats::below_min_angle says so. 0: no
  // bound. On the CPU of one process alone.
  double min_angle = 0;
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes
  DeviceWork device_work = DeviceWork::balanced;
  // Bytes, for the CUDA backend; the mesh does not depend on them. What a device keeps of the mesh,
  // and the batches of boundaries and patches that it works on, fit in these and in its free
  // memory. Patches that it cannot keep travel to the host batch by batch.
  std::uint64_t device_memory = kNoMemoryLimit;
  Monitor* monitor = nullptr;
};

struct ExactMeshStats {
  std::uint64_t arcs = 0, corners = 0;  // of the boundary, without those reduced to points
  std::uint64_t points = 0;    // arcs reduced to points: more than three spheres meet there
  std::uint64_t contacts = 0;  // circles reduced to points: two balls touch; the mesh parts them
  std::uint64_t joins = 0;     // places where curves on one sphere nearly touch and were joined
  // The thresholds in use, as fractions of the smaller sphere's radius. Arcs up to the length
  // `arc_size` and circles up to the radius `circle_size` were reduced to points.
  double arc_size = 0, circle_size = 0;
  // Value of the mesh minus value of the union, for the Euler characteristic and for the number of
  // closed surfaces. The value of the union counts each point of contact twice, as the mesh does,
  // which adds 2 to the Euler characteristic for each contact. Both differences are 0 if points,
  // contacts and joins are 0.
  std::int64_t euler_difference = 0, shell_difference = 0;
  std::uint64_t pieces = 0;  // mesh edges along the arcs
  std::uint64_t split = 0;   // pieces that had to be split after the first sampling
  // Tests of the triangulations that double precision did not decide, so exact arithmetic did.
  std::uint64_t exact_tests = 0;
  // Boundaries that a CUDA device looked at before the host did, and those that it left to the host
  // because double precision did not decide a test, pieces met elsewhere than at their ends, there
  // were too many points for one thread, or memory was too small. Both are 0 on the CPU, and for
  // sets that are not worth it.
  std::uint64_t device_looks = 0, left_looks = 0;
  // Patches that a CUDA device meshed, and those that it left to the host because double precision
  // did not decide a test, a triangle has an angle below 5°, or the memory for one patch was too
  // small. Both are 0 on the CPU. How many a device gets depends on the number of the host's cores
  // (DeviceWork) and, as the batches below, on timing; the mesh does not.
  std::uint64_t device_patches = 0, left_patches = 0;
  // The batches in which a CUDA device meshed its patches, and how many of these patches it could
  // not keep until all vertices had their numbers, for want of memory: they came to the host at
  // once. Both are 0 on the CPU.
  std::uint64_t device_batches = 0, returned_patches = 0;
  // Triangles with an angle below ExactMeshOptions::min_angle: near sharp corners, and elsewhere,
  // because the limits on the rounds or on the pieces of an arc, or on how short a piece may be,
  // have ended the search for better ones.
  std::uint64_t below_min_angle_at_corners = 0, below_min_angle = 0;
  // Angles below their floors (mesher/angle_floors.hpp): below 5°, or below half of the exact angle
  // at a corner of the patch where that is less. Empty with a bound on the angles, which takes the
  // place of these.
  std::optional<std::uint64_t> below_floor;
  // Balls whose corners and arcs an exact triangulation decided: all of them, concentric ones of
  // which only the largest counts included.
  std::uint64_t triangulated_balls = 0;
  // Wall time. The first is the part before meshing: arcs and corners, and areas.
  double arrangement_seconds = 0, seconds = 0;
};

struct ExactMesh {
  IndexedMesh mesh;  // with triangle_spheres, without opposite half-edges
  ExactMeshStats stats;
  // Why the CPU meshed what was meant for a device; empty if it did not.
  std::string fallback;
};

// Meshes the boundary of the union. The labels of a vertex are the ids of the spheres it lies on,
// ascending. The result depends on the arguments alone: every call and any number of threads give
// the same mesh, and a permuted input permutes the labels only.
//
// Throws InvalidInput for an empty set, for an edge length that is not finite and positive, for a
// least angle out of range, and if there are edge lengths by sphere, but not one for each sphere;
// and Cancelled. Throws LimitExceeded before it takes memory beyond the limit, or later if curves
// of the boundary lie too close to each other for every set of thresholds.
ExactMesh mesh_union(const SphereSet& spheres, const ExactMeshOptions& options = {});

// mesh_union() on the CPU or on a CUDA device; make_exact_mesher() (cuda/backend.hpp) chooses. All
// backends give the same mesh, bit by bit. The device looks at the boundaries of patches first, and
// meshes the patches once their boundaries are settled; the host does the rest. mesh() throws
// DeviceMemoryExceeded as well.
class ExactMesher {
 public:
  virtual ~ExactMesher() = default;
  virtual ExactMesh mesh(const SphereSet& spheres, const ExactMeshOptions& options = {}) const = 0;
};

// On all cores.
std::unique_ptr<ExactMesher> make_cpu_exact_mesher();

}  // namespace vdwmesh
