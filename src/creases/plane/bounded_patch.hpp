// A patch whose boundary is triangulated, packed into plain memory, and its meshing there with
// arrays of fixed capacity. For host and device; a kernel meshes one patch with each thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "creases/patch/patch_smoothing.hpp"
#include "creases/patch/patch_work.hpp"
#include "creases/plane/patch_triangulator.hpp"
#include "creases/plane/plane_insertion.hpp"

namespace vdwmesh {

// The packed arrays of a boundary, and of its triangulation (PlaneTypes::State). Either may be
// elsewhere, and its arrays are null here.
struct PatchInput {
  Vec3d* points = nullptr;
  BoundaryPiece* pieces = nullptr;
  CoveredCap* caps = nullptr;
  SphereThrough* through = nullptr;
  PlanePoint* plane_points = nullptr;
  LinkedTriangle* triangles = nullptr;
  std::uint32_t* star = nullptr;

  VDWMESH_HD PatchBoundaryView view(const PatchSizes& sizes) const {
    PatchBoundaryView all;
    all.points = {points, sizes.points};
    all.pieces = {pieces, sizes.pieces};
    all.caps = {caps, sizes.caps};
    all.through = {through, sizes.through};
    return all;
  }
};

// Places arrays one after another, each at a multiple of eight bytes. Without memory to place them
// in, it counts the bytes alone, and all places are null.
class ArrayPlaces {
 public:
  VDWMESH_HD explicit ArrayPlaces(std::byte* begin) : begin_(begin) {}
  template <class T>
  VDWMESH_HD T* next(std::size_t count) {
    T* const place = begin_ ? reinterpret_cast<T*>(begin_ + bytes_) : nullptr;
    bytes_ += (count * sizeof(T) + 7) / 8 * 8;
    return place;
  }
  VDWMESH_HD std::size_t bytes() const { return bytes_; }

 private:
  std::byte* begin_;
  std::size_t bytes_ = 0;
};

VDWMESH_HD inline void place_boundary(const PatchSizes& sizes, ArrayPlaces& places,
                                      PatchInput& in) {
  in.points = places.next<Vec3d>(sizes.points);
  in.pieces = places.next<BoundaryPiece>(sizes.pieces);
  in.caps = places.next<CoveredCap>(sizes.caps);
  in.through = places.next<SphereThrough>(sizes.through);
}
// In the order of PlaneTriangulationOf::visit_state().
VDWMESH_HD inline void place_plane(std::uint32_t points, std::uint32_t triangles,
                                   ArrayPlaces& places, PatchInput& in) {
  in.plane_points = places.next<PlanePoint>(points);
  in.triangles = places.next<LinkedTriangle>(triangles);
  in.star = places.next<std::uint32_t>(points);
}
VDWMESH_HD inline PatchInput patch_input(const PatchSizes& sizes, ArrayPlaces& places) {
  PatchInput in;
  place_boundary(sizes, places, in);
  place_plane(sizes.plane_points(), sizes.plane_triangles, places, in);
  return in;
}

// The capacities of arrays. Those that follow from the numbers of points and triangles are never
// exceeded, because points are not inserted without room (patch_memory.hpp). A triangulation of n
// points in a frame has 2 n + 1 triangles.
VDWMESH_HD inline std::uint32_t capacity(const PatchSizes& sizes, PatchArray kind) {
  const std::uint32_t triangles = 2 * sizes.most_points + 1;
  switch (kind) {
    case PatchArray::circle_rows:
      return sizes.points + 2;
    case PatchArray::circle_entries:
      return 2 * sizes.pieces + sizes.through;
    case PatchArray::caps:
      return sizes.caps;
    case PatchArray::points:
      return sizes.most_points;
    case PatchArray::plane_points:
      return sizes.most_points + 3;
    case PatchArray::star_rows:
      return sizes.most_points + 2;
    case PatchArray::triangles:
      return triangles;
    case PatchArray::star_entries:
      return 3 * triangles;
    case PatchArray::queue:
      return 2 * triangles;
    case PatchArray::lists:
      return triangles / 2 + 32;
    case PatchArray::requests:
      return 2 * sizes.pieces + 32;
    case PatchArray::insertions:
      return sizes.plane_triangles > 0 ? 0 : triangles / 2 + 32;
  }
  return 0;
}

// Gives an array its memory, for the visits of PatchWork.
struct ArrayPlacer {
  const PatchSizes& sizes;
  PatchFailure* failure;
  ArrayPlaces& places;

  template <class T>
  VDWMESH_HD void operator()(BoundedArray<T>& array, PatchArray kind) const {
    const std::uint32_t most = capacity(sizes, kind);
    array = BoundedArray<T>(places.next<T>(most), most, failure);
  }
};
VDWMESH_HD inline void place_arrays(const PatchSizes& sizes, PatchFailure* failure,
                                    ArrayPlaces& places, PatchWork<BoundedMemory>& work) {
  work.visit_arrays(ArrayPlacer{sizes, failure, places});
}

// The bytes that the arrays take.
inline std::size_t work_bytes(const PatchSizes& sizes) {
  ArrayPlaces places(nullptr);
  PatchWork<BoundedMemory> work;
  place_arrays(sizes, nullptr, places, work);
  return places.bytes();
}

// The points of the divided icosahedron for one edge length.
struct FixedLattice {
  const Vec3d* first;
  std::size_t count;
  template <class Margins>
  VDWMESH_HD std::span<const Vec3d> points(double, const Margins&) const {
    return {first, count};
  }
};

struct BoundedPatch {
  PatchSizes sizes;
  std::uint32_t first_lattice_point, lattice_points;
  std::uint64_t input, work;    // in bytes, where its arrays begin
  double edge_length, largest;  // as a fraction of the radius; PlaneTypes::State::largest
  Demand demand;
};

// Either a failure, or requests, or else interior points and triangles, as in PatchMesh. A piece
// may have several requests.
struct PatchOutcome {
  PatchFailure failure;
  std::uint32_t interior, triangles, splits;
  const Vec3d* first_interior;
  const std::array<std::uint32_t, 3>* first_triangle;
  const PieceSplit* first_split;
};

// Where the arrays of a batch of patches begin.
struct PatchMemory {
  std::byte *input, *work;
  const Vec3d* lattice;
};

// What is known of a patch that is being meshed: where its arrays are and how much is in them, and
// whether it has failed.
struct PatchDesk {
  PatchFailure failure = PatchFailure::none;
  PatchWork<BoundedMemory> work{BoundedMemory(&failure)};
};

// Meshes one patch. The outcome is in its part of the work memory.
VDWMESH_HD inline PatchOutcome mesh_bounded_patch(const BoundedPatch& patch,
                                                  const PatchMemory& memory, PatchDesk& desk) {
  ArrayPlaces inputs(memory.input + patch.input), arrays(memory.work + patch.work);
  const PatchInput in = patch_input(patch.sizes, inputs);
  const PatchSizes& n = patch.sizes;
  const PatchBoundaryView boundary = in.view(n);
  PatchFailure& failure = desk.failure;
  PatchWork<BoundedMemory>& work = desk.work;
  place_arrays(n, &failure, arrays, work);
  work.circles.assign(boundary);
  work.plane.resume(patch.largest, in.plane_points, in.star, n.plane_points(), in.triangles,
                    n.plane_triangles, &work.circles);
  FixedLattice lattice{memory.lattice + patch.first_lattice_point, patch.lattice_points};
  triangulator::PatchTriangulator<BoundedMemory, FixedLattice>(boundary, patch.edge_length, lattice,
                                                               work, nullptr)
      .run(patch.demand, PatchStage::triangles);
  return {failure,
          static_cast<std::uint32_t>(work.interior.size()),
          static_cast<std::uint32_t>(work.triangles.size()),
          static_cast<std::uint32_t>(work.splits.size()),
          work.interior.data(),
          work.triangles.data(),
          work.splits.data()};
}
VDWMESH_HD inline PatchOutcome mesh_bounded_patch(const BoundedPatch& patch,
                                                  const PatchMemory& memory) {
  PatchDesk desk;
  return mesh_bounded_patch(patch, memory, desk);
}

}  // namespace vdwmesh
