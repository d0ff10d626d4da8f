// Into a mesh on the host or on the device, patches are written by one kernel (place_patches()),
// which does what the host would, so the bits are the host's.
#include <algorithm>
#include <type_traits>

#include "core/buffer.hpp"
#include "core/fixed_blocks.hpp"
#include "cuda/memory/transfer.cuh"
#include "cuda/mesher/mesh_parts.cuh"

namespace vdwmesh::mesher {
namespace {

// Of an interior point and of a triangle in a mesh.
constexpr std::uint64_t kVertexBytes = sizeof(Vec3d) + sizeof(Vec3f) + 3 * sizeof(SphereId),
                        kTriangleBytes = sizeof(Triangle) + sizeof(SphereId);

DeviceMesh empty_mesh(const MeshSize& size, const Stream& stream) {
  DeviceMesh mesh(size.vertices, size.triangles, stream, LabelWidth::three, Normals::gradients,
                  Connectivity::triangles);
  mesh.triangle_spheres = DeviceArray<SphereId>(size.triangles, stream);
  return mesh;
}

// Where the results of a patch lie on the device.
struct PatchArrays {
  const Vec3d* interior;
  const std::array<std::uint32_t, 3>* triangles;
  const PointSource* sources;
  std::uint64_t points;  // on its boundary
};

// In a part of a mesh that begins with this vertex and this triangle.
PlacedPatch placed(const PatchPlace& place, const PatchArrays& from, const MeshSize& first) {
  return {place.sphere,
          from.interior,
          from.triangles,
          from.sources,
          place.first_vertex - first.vertices,
          place.first_triangle - first.triangles,
          static_cast<std::uint32_t>(place.first_vertex),
          static_cast<std::uint32_t>(from.points),
          place.interior,
          3 * place.triangles,
          place.id};
}

PatchArrays kept_arrays(const PatchPlace& place, const KeptBatches& batches) {
  const KeptName name = KeptName::of(place.kept);
  const KeptBatch& batch = batches[name.batch];
  const GatherPlace& from = batch.places[name.place];
  const std::uint64_t source = batch.first_sources[name.place];
  return {batch.interior.data() + from.interior, batch.triangles.data() + from.triangle,
          batch.sources.data() + source, batch.first_sources[name.place + 1] - source};
}

// Uploads what `uploads` says and `count` patches, patch(i), in one go, and writes these into a
// mesh.
template <class Patch>
void place_all(std::size_t count, const Patch& patch, std::vector<UploadPart> uploads,
               const std::uint32_t* first_vertices, double unit, const DeviceMeshView& to,
               const Stream& stream) {
  Buffer<PlacedPatch> patches(count);
  for_each_index(count, [&](std::size_t i) { patches[i] = patch(i); });
  const DeviceArray<PlacedPatch> there(count, stream);
  uploads.push_back({there.data(), patches.data(), there.bytes()});
  upload_parts(uploads, stream);
  place_patches(there.data(), static_cast<std::uint32_t>(count), first_vertices, unit, to, stream);
}

// Copies a part to its place in the mesh.
void download_part(const MeshPart& part, const DeviceMesh& from, IndexedMesh& mesh,
                   const Stream& stream) {
  std::vector<DownloadPart> parts;
  const auto add = [&](auto* to, const auto* first, std::uint64_t count) {
    parts.push_back({to, first, count * sizeof(*to)});
  };
  const std::uint64_t vertex = part.places.front().first_vertex,
                      triangle = part.places.front().first_triangle;
  add(mesh.positions.data() + vertex, from.positions.data(), part.vertices);
  add(mesh.normals.data() + vertex, from.normals.data(), part.vertices);
  add(mesh.vertex_spheres.atoms.data() + vertex, from.vertex_spheres.atoms.data(), part.vertices);
  add(mesh.vertex_spheres.others.data() + vertex, from.vertex_spheres.others.data(), part.vertices);
  add(mesh.triangles.data() + triangle, from.corners.data(), part.triangles);
  add(mesh.triangle_spheres.data() + triangle, from.triangle_spheres.data(), part.triangles);
  download_parts(parts, stream);
}

// Copies what the boundary is placed from to the device, and places it.
void place_first_vertices(const MeshPlacement& boundary, const std::uint32_t* first_vertices,
                          const DeviceMesh& mesh, const Stream& stream) {
  std::vector<UploadPart> uploads;
  const auto copy = [&](const auto& values) {
    DeviceArray<std::remove_cvref_t<decltype(values[0])>> there(values.size(), stream);
    uploads.push_back({there.data(), values.data(), there.bytes()});
    return there;
  };
  const ArcSampling::Fractions unequal = boundary.sampling().unequal_fractions();
  const auto balls = copy(boundary.balls().balls);
  const auto ids = copy(boundary.balls().ids);
  const auto corners = copy(boundary.boundary().corners);
  const auto arcs = copy(boundary.boundary().arcs);
  const auto pieces = copy(boundary.sampling().pieces());
  const auto first_fractions = copy(unequal.first);
  const auto fractions = copy(unequal.values);
  upload_parts(uploads, stream);
  place_boundary({{balls.data(), ids.data(), boundary.unit()},
                  corners.data(),
                  arcs.data(),
                  static_cast<std::uint32_t>(corners.size()),
                  static_cast<std::uint32_t>(arcs.size()),
                  pieces.data(),
                  first_vertices,
                  first_fractions.data(),
                  fractions.data()},
                 mesh.view(), stream);
}

// Patches of the host on their way to the device, one after another in each array.
class HostPatches {
 public:
  explicit HostPatches(std::span<const PatchOfHost> patches)
      : patches_(patches), first_(patches.size() + 1, First{0, 0, 0}) {
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const PatchMesh& patch = *patches[i].patch;
      first_[i + 1] = {first_[i].interior + patch.interior.size(),
                       first_[i].triangle + patch.triangles.size(),
                       first_[i].source + patch.sources.size()};
    }
  }

  // Of the device, while they are written.
  std::uint64_t bytes() const {
    const First& end = first_.back();
    return end.interior * sizeof(Vec3d) + end.triangle * sizeof(Triangle) +
           end.source * sizeof(PointSource) + patches_.size() * sizeof(PlacedPatch);
  }

  // Writes them into the mesh.
  void place(const std::uint32_t* first_vertices, double unit, const DeviceMesh& mesh,
             const Stream& stream) const {
    const First& end = first_.back();
    Buffer<Vec3d> interior(end.interior);
    Buffer<std::array<std::uint32_t, 3>> triangles(end.triangle);
    Buffer<PointSource> sources(end.source);
    for_each_index(patches_.size(), [&](std::size_t i) {
      const PatchMesh& patch = *patches_[i].patch;
      std::ranges::copy(patch.interior, interior.data() + first_[i].interior);
      std::ranges::copy(patch.triangles, triangles.data() + first_[i].triangle);
      std::ranges::copy(patch.sources, sources.data() + first_[i].source);
    });
    const DeviceArray<Vec3d> interior_there(end.interior, stream);
    const DeviceArray<std::array<std::uint32_t, 3>> triangles_there(end.triangle, stream);
    const DeviceArray<PointSource> sources_there(end.source, stream);
    const auto patch = [&](std::size_t i) {
      const First& at = first_[i];
      return placed(patches_[i].place,
                    {interior_there.data() + at.interior, triangles_there.data() + at.triangle,
                     sources_there.data() + at.source, first_[i + 1].source - at.source},
                    {0, 0});
    };
    place_all(patches_.size(), patch,
              {{interior_there.data(), interior.data(), interior_there.bytes()},
               {triangles_there.data(), triangles.data(), triangles_there.bytes()},
               {sources_there.data(), sources.data(), sources_there.bytes()}},
              first_vertices, unit, mesh.view(), stream);
  }

 private:
  std::span<const PatchOfHost> patches_;
  // Where the arrays of each patch begin; the last one is the end.
  struct First {
    std::uint64_t interior, triangle, source;
  };
  std::vector<First> first_;
};

// The host's patches travel in runs of about so many triangles, so that they take little memory
// beside the mesh.
std::vector<HostPatches> runs_of(std::span<const PatchOfHost> patches) {
  constexpr std::uint64_t kTrianglesAtOnce = std::uint64_t{4} << 20;
  std::vector<HostPatches> runs;
  for (std::size_t begin = 0, end = 0; begin < patches.size(); begin = end) {
    std::uint64_t triangles = 0;
    while (end < patches.size() && triangles < kTrianglesAtOnce) {
      triangles += patches[end++].place.triangles;
    }
    runs.emplace_back(patches.subspan(begin, end - begin));
  }
  return runs;
}

}  // namespace

MeshPart::MeshPart(std::span<const PatchPlace> some)
    : places(some),
      vertices(some.back().first_vertex + some.back().interior - some.front().first_vertex),
      triangles(some.back().first_triangle + some.back().triangles - some.front().first_triangle) {}

namespace {

// Of a crease-exact mesh.
std::uint64_t device_mesh_bytes(const MeshSize& size) {
  return size.vertices * kVertexBytes + size.triangles * kTriangleBytes;
}

}  // namespace

std::uint64_t MeshPart::device_bytes() const {
  return device_mesh_bytes({vertices, triangles}) + places.size() * sizeof(PlacedPatch);
}

// The arrays of the boundary are counted as if all arcs had unequal pieces.
std::uint64_t assembly_bytes(const MeshToAssemble& parts) {
  const BoundaryArcs& boundary = parts.boundary.boundary();
  const std::uint64_t of_arc = sizeof(BoundaryArc) + 3 * sizeof(std::uint32_t);
  std::uint64_t of_run = 0;
  for (const HostPatches& run : runs_of(parts.of_host)) of_run = std::max(of_run, run.bytes());
  return device_mesh_bytes(parts.size) + boundary.corners.size() * sizeof(BoundaryCorner) +
         boundary.arcs.size() * of_arc + parts.boundary.sampling().vertex_count() * sizeof(double) +
         parts.boundary.balls().balls.size() * (sizeof(Sphere) + sizeof(SphereId)) +
         parts.kept.places.size() * sizeof(PlacedPatch) + of_run;
}

std::vector<MeshPart> parts_of(std::span<const PatchPlace> places, std::uint64_t most_bytes) {
  std::vector<MeshPart> parts;
  for (std::size_t begin = 0, end = 0; begin < places.size(); begin = end) {
    do ++end;
    while (end < places.size() &&
           MeshPart(places.subspan(begin, end + 1 - begin)).device_bytes() <= most_bytes);
    parts.emplace_back(places.subspan(begin, end - begin));
  }
  return parts;
}

void write_part(const MeshPart& part, const KeptBatches& batches,
                const std::uint32_t* first_vertices, double unit, IndexedMesh& mesh,
                const Stream& stream) {
  const DeviceMesh written = empty_mesh({part.vertices, part.triangles}, stream);
  clear(written.positions, stream);
  clear(written.normals, stream);
  clear(written.vertex_spheres.atoms, stream);
  clear(written.vertex_spheres.others, stream);
  clear(written.corners, stream);
  clear(written.triangle_spheres, stream);
  const PatchPlace& front = part.places.front();
  const auto patch = [&](std::size_t i) {
    return placed(part.places[i], kept_arrays(part.places[i], batches),
                  {front.first_vertex, front.first_triangle});
  };
  place_all(part.places.size(), patch, {}, first_vertices, unit, written.view(), stream);
  // Before the transfer, not within it: a transfer holds the lock on the page-locked buffers, which
  // another thread may want meanwhile.
  stream.wait();
  download_part(part, written, mesh, stream);
}

DeviceMesh assemble_mesh(const MeshToAssemble& parts, const KeptBatches& batches,
                         const Stream& stream) {
  const PatchPlaces& kept = parts.kept;
  DeviceMesh mesh = empty_mesh(parts.size, stream);
  const DeviceArray<std::uint32_t> first_vertices(kept.first_vertices.size(), stream);
  const auto kept_patch = [&](std::size_t i) {
    return placed(kept.places[i], kept_arrays(kept.places[i], batches), {0, 0});
  };
  place_all(kept.places.size(), kept_patch,
            {{first_vertices.data(), kept.first_vertices.data(), first_vertices.bytes()}},
            first_vertices.data(), kept.unit, mesh.view(), stream);
  place_first_vertices(parts.boundary, first_vertices.data(), mesh, stream);
  for (const HostPatches& run : runs_of(parts.of_host)) {
    run.place(first_vertices.data(), kept.unit, mesh, stream);
  }
  stream.wait();
  return mesh;
}

}  // namespace vdwmesh::mesher
