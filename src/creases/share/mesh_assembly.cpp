// Numbers the interior points and the triangles ball by ball, so that every ball writes to index
// ranges of its own and all cores write at the same time.
#include "creases/share/mesh_assembly.hpp"

#include <tbb/parallel_for.h>

#include <cstdint>
#include <numeric>

#include "core/fixed_blocks.hpp"
#include "creases/share/device_patches.hpp"

namespace vdwmesh {
namespace {

// By ball, with one more entry at the end.
struct FirstNumbers {
  std::vector<std::uint64_t> vertex, triangle;
};

FirstNumbers number_patches(const MeshedPatches& meshed, std::uint64_t boundary_vertices) {
  const std::size_t balls = meshed.patches.size();
  FirstNumbers first{std::vector<std::uint64_t>(balls + 1), std::vector<std::uint64_t>(balls + 1)};
  first.vertex[0] = boundary_vertices;
  for_each_index(balls, [&](std::size_t b) {
    const PatchJob* const kept =
        meshed.device ? meshed.device->kept_job(static_cast<std::uint32_t>(b)) : nullptr;
    const PatchMesh& patch = meshed.patches[b];
    first.vertex[b + 1] = kept ? kept->interior : patch.interior.size();
    first.triangle[b + 1] = kept ? kept->triangles : patch.triangles.size();
  });
  std::partial_sum(first.vertex.begin(), first.vertex.end(), first.vertex.begin());
  std::partial_sum(first.triangle.begin(), first.triangle.end(), first.triangle.begin());
  return first;
}

// The device writes what it has kept, while the host writes corners and arcs; then come the patches
// of the host, over whatever the device has written there.
void fill(const MeshPlacement& placement, const MeshedPatches& meshed, const FirstNumbers& first,
          const PatchDispatch::Places& places, IndexedMesh& mesh) {
  const auto place_arcs = [&] {
    placement.place_corners(mesh);
    placement.place_arcs(mesh);
    // What the device has kept is not wanted any more by the host.
    for_each_index(meshed.progress.size(), [&](std::size_t b) { meshed.progress[b].reset(); });
  };
  if (meshed.device) {
    beside([&] { meshed.device->place(places, mesh); }, place_arcs);
  } else {
    place_arcs();
  }
  tbb::parallel_for(std::size_t{0}, meshed.patches.size(), [&](std::size_t b) {
    placement.place_patch(meshed.patches[b], static_cast<std::uint32_t>(b), first.vertex[b],
                          first.triangle[b], mesh);
    meshed.patches[b] = {};
  });
}

}  // namespace

UnnumberedPiece assemble(MeshPlacement& placement, const MeshedPatches& meshed,
                         bool stays_on_device) {
  const std::uint64_t boundary = placement.corners() + placement.points();
  const FirstNumbers first = number_patches(meshed, boundary);
  placement.find_elsewhere(
      [&](std::uint32_t b) { return first.triangle[b + 1] > first.triangle[b]; },
      first.vertex.back());
  UnnumberedPiece piece;
  piece.own = {placement.corners(), placement.points(), first.vertex.back() - boundary};
  piece.elsewhere = placement.elsewhere();
  check_vertices(first.vertex.back() + piece.elsewhere.size());
  const PatchDispatch::Places places{meshed.balls, first.vertex, first.triangle,
                                     meshed.sampling.first_vertices()};
  if (!stays_on_device) {
    make_room(piece.mesh, {first.vertex.back(), first.triangle.back()}, kPatchArrays);
    fill(placement, meshed, first, places, piece.mesh);
    return piece;
  }
  beside([&] { meshed.device->assemble(places, meshed.patches, placement); },
         [&] {
           for_each_index(meshed.progress.size(),
                          [&](std::size_t b) { meshed.progress[b].reset(); });
         });
  for_each_index(meshed.patches.size(), [&](std::size_t b) { meshed.patches[b] = {}; });
  return piece;
}

}  // namespace vdwmesh
