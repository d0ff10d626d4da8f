// One kernel (place_patches()) writes patches into a mesh in device memory. It does what the host
// would do, so the mesh has the host's bits. For a mesh in host memory the kernel writes one
// section of it at a time, which is then downloaded. A whole mesh in device memory also gets its
// boundary from a kernel, and the patches that the host has meshed are uploaded for it.
//
// In this file, a patch's "numbers" are those of its first vertex and triangle in the mesh
// (PatchPlace), and its "offsets" say where its results begin in the arrays of a batch.
#include <algorithm>
#include <type_traits>

#include "core/buffer.hpp"
#include "core/fixed_blocks.hpp"
#include "creases/share/mesh_placement.hpp"
#include "cuda/memory/transfer.cuh"
#include "cuda/mesher/mesh_parts.cuh"

namespace vdwmesh::mesher {
namespace {

// Bytes of an interior point and of a triangle in a crease-exact mesh.
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

// The patch as the kernel writes it into the part of a mesh that begins with this vertex and this
// triangle.
PlacedPatch patch_to_write(const PatchPlace& numbers, const PatchArrays& from,
                           const MeshSize& first) {
  return {.sphere = numbers.sphere,
          .interior = from.interior,
          .triangles = from.triangles,
          .sources = from.sources,
          .vertex = numbers.first_vertex - first.vertices,
          .triangle = numbers.first_triangle - first.triangles,
          .first_vertex = static_cast<std::uint32_t>(numbers.first_vertex),
          .points = static_cast<std::uint32_t>(from.points),
          .interiors = numbers.interior,
          .corners = 3 * numbers.triangles,
          .id = numbers.id};
}

PatchArrays kept_arrays(const PatchPlace& patch, const KeptBatches& batches) {
  const KeptName name = KeptName::of(patch.kept);
  const KeptBatch& batch = batches[name.batch];
  const ResultOffsets& from = batch.offsets[name.index];
  const std::uint64_t source = batch.first_sources[name.index];
  return {batch.interior.data() + from.interior, batch.triangles.data() + from.triangle,
          batch.sources.data() + source, batch.first_sources[name.index + 1] - source};
}

// Uploads the `uploads` and `count` patches, patch(i), in one transfer, and writes these patches
// into a mesh.
template <class Patch>
void write_patches(std::size_t count, const Patch& patch, std::vector<UploadPart> uploads,
                   const std::uint32_t* first_vertices, double unit, const DeviceMeshView& to,
                   const Stream& stream) {
  Buffer<PlacedPatch> patches(count);
  for_each_index(count, [&](std::size_t i) { patches[i] = patch(i); });
  const DeviceArray<PlacedPatch> there(count, stream);
  uploads.push_back({there.data(), patches.data(), there.bytes()});
  upload_parts(uploads, stream);
  place_patches(there.data(), static_cast<std::uint32_t>(count), first_vertices, unit, to, stream);
}

// Copies a section into the mesh.
void download_section(const MeshSection& section, const DeviceMesh& from, IndexedMesh& mesh,
                      const Stream& stream) {
  std::vector<DownloadPart> parts;
  const auto add = [&](auto* to, const auto* first, std::uint64_t count) {
    parts.push_back({to, first, count * sizeof(*to)});
  };
  const std::uint64_t vertex = section.patches.front().first_vertex,
                      triangle = section.patches.front().first_triangle;
  add(mesh.positions.data() + vertex, from.positions.data(), section.vertices);
  add(mesh.normals.data() + vertex, from.normals.data(), section.vertices);
  add(mesh.vertex_spheres.atoms.data() + vertex, from.vertex_spheres.atoms.data(),
      section.vertices);
  add(mesh.vertex_spheres.others.data() + vertex, from.vertex_spheres.others.data(),
      section.vertices);
  add(mesh.triangles.data() + triangle, from.corners.data(), section.triangles);
  add(mesh.triangle_spheres.data() + triangle, from.triangle_spheres.data(), section.triangles);
  download_parts(parts, stream);
}

// Uploads the boundary between patches, and writes it into the mesh.
void write_boundary(const MeshPlacement& boundary, const std::uint32_t* first_vertices,
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

  // Bytes of device memory that they take while they are written.
  std::uint64_t bytes() const {
    const First& end = first_.back();
    return end.interior * sizeof(Vec3d) + end.triangle * sizeof(Triangle) +
           end.source * sizeof(PointSource) + patches_.size() * sizeof(PlacedPatch);
  }

  // Uploads the patches, and writes them into the mesh.
  void write_to(const std::uint32_t* first_vertices, double unit, const DeviceMesh& mesh,
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
      return patch_to_write(
          patches_[i].place,
          {interior_there.data() + at.interior, triangles_there.data() + at.triangle,
           sources_there.data() + at.source, first_[i + 1].source - at.source},
          {0, 0});
    };
    write_patches(patches_.size(), patch,
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

// Bytes of a crease-exact mesh in device memory.
std::uint64_t device_mesh_bytes(const MeshSize& size) {
  return size.vertices * kVertexBytes + size.triangles * kTriangleBytes;
}

}  // namespace

MeshSection::MeshSection(std::span<const PatchPlace> some)
    : patches(some),
      vertices(some.back().first_vertex + some.back().interior - some.front().first_vertex),
      triangles(some.back().first_triangle + some.back().triangles - some.front().first_triangle) {}

std::uint64_t MeshSection::device_bytes() const {
  return device_mesh_bytes({vertices, triangles}) + patches.size() * sizeof(PlacedPatch);
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

std::vector<MeshSection> sections_of(std::span<const PatchPlace> patches,
                                     std::uint64_t most_bytes) {
  std::vector<MeshSection> sections;
  for (std::size_t begin = 0, end = 0; begin < patches.size(); begin = end) {
    do ++end;
    while (end < patches.size() &&
           MeshSection(patches.subspan(begin, end + 1 - begin)).device_bytes() <= most_bytes);
    sections.emplace_back(patches.subspan(begin, end - begin));
  }
  return sections;
}

void write_section(const MeshSection& section, const KeptBatches& batches,
                   const std::uint32_t* first_vertices, double unit, IndexedMesh& mesh,
                   const Stream& stream) {
  const DeviceMesh written = empty_mesh({section.vertices, section.triangles}, stream);
  clear(written.positions, stream);
  clear(written.normals, stream);
  clear(written.vertex_spheres.atoms, stream);
  clear(written.vertex_spheres.others, stream);
  clear(written.corners, stream);
  clear(written.triangle_spheres, stream);
  const PatchPlace& front = section.patches.front();
  const auto patch = [&](std::size_t i) {
    return patch_to_write(section.patches[i], kept_arrays(section.patches[i], batches),
                          {front.first_vertex, front.first_triangle});
  };
  write_patches(section.patches.size(), patch, {}, first_vertices, unit, written.view(), stream);
  // Before the transfer, not within it: a transfer holds the lock on the page-locked buffers, which
  // another thread may want meanwhile.
  stream.wait();
  download_section(section, written, mesh, stream);
}

DeviceMesh assemble_mesh(const MeshToAssemble& parts, const KeptBatches& batches,
                         const Stream& stream) {
  const PatchPlaces& kept = parts.kept;
  DeviceMesh mesh = empty_mesh(parts.size, stream);
  const DeviceArray<std::uint32_t> first_vertices(kept.first_vertices.size(), stream);
  const auto kept_patch = [&](std::size_t i) {
    return patch_to_write(kept.places[i], kept_arrays(kept.places[i], batches), {0, 0});
  };
  write_patches(kept.places.size(), kept_patch,
                {{first_vertices.data(), kept.first_vertices.data(), first_vertices.bytes()}},
                first_vertices.data(), kept.unit, mesh.view(), stream);
  write_boundary(parts.boundary, first_vertices.data(), mesh, stream);
  for (const HostPatches& run : runs_of(parts.of_host)) {
    run.write_to(first_vertices.data(), kept.unit, mesh, stream);
  }
  stream.wait();
  return mesh;
}

}  // namespace vdwmesh::mesher
