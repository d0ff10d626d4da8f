// write_vtkhdf(): the first rank lays out the file, and every rank writes its vertices and
// triangles to their places in it, as it does in a PLY file. Arrays whose form in the file differs
// from that in memory are converted one stretch after another.
#include "distributed/files/vtkhdf_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "distributed/files/shared_file.hpp"
#include "distributed/files/vtkhdf_layout.hpp"
#include "distributed/ranks.hpp"
#include "distributed/shares/surface_piece.hpp"
#include "mesh/element_color.hpp"
#include "mesh/formats/ply_records.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint8_t kTriangleType = 5;               // VTK_TRIANGLE
constexpr std::size_t kStretch = std::size_t{1} << 18;  // elements that are copied at once

template <class T>
void write_elements(SharedFile& file, std::uint64_t place, std::uint64_t first,
                    std::span<const T> elements) {
  file.write_at(place + sizeof(T) * first, reinterpret_cast<const char*>(elements.data()),
                elements.size_bytes());
}

// Writes value(0) to value(count - 1) from element `first` of an array on.
template <class Value>
void write_made(SharedFile& file, std::uint64_t place, std::uint64_t first, std::size_t count,
                const Value& value) {
  std::vector<decltype(value(std::size_t{}))> stretch;
  for (std::size_t begin = 0; begin < count; begin += kStretch) {
    stretch.clear();
    const std::size_t end = std::min(count, begin + kStretch);
    for (std::size_t i = begin; i < end; ++i) stretch.push_back(value(i));
    write_elements(file, place, first + begin, std::span(std::as_const(stretch)));
  }
}

// Writes a run: the vertices `begin` to `end` - 1 of the piece, which are numbered from `first` on
// in the whole mesh, and so in the arrays of the file.
void write_vertices_of(const SurfacePiece& piece, const VertexNumbers::Run& run,
                       std::span<const RgbColor> colors, const VtkHdfPlaces& places,
                       SharedFile& file) {
  static_assert(sizeof(Vec3d) == 3 * sizeof(double) && sizeof(Vec3f) == 3 * sizeof(float));
  const IndexedMesh& mesh = piece.mesh;
  const std::size_t count = run.end - run.begin;
  const auto of_run = [&](const auto& array) {
    return std::span(array.data(), array.size()).subspan(run.begin, count);
  };
  write_elements(file, places.points, run.first, of_run(mesh.positions));
  write_elements(file, places.normals, run.first, of_run(mesh.normals));
  const std::span<const SphereId> atoms = of_run(mesh.vertex_spheres.atoms);
  write_made(file, places.colors, run.first, count,
             [&](std::size_t v) { return atoms[v] == kNoSphere ? kPlainColor : colors[atoms[v]]; });
  write_made(file, places.atoms, run.first, count,
             [&](std::size_t v) { return formats::ply_sphere(atoms[v]); });
}

// Offsets are the places in the connectivity at which triangles begin. One rank adds where the last
// of all triangles ends.
void write_triangles_of(const SurfacePiece& piece, bool holds_end, const VtkHdfPlaces& places,
                        SharedFile& file) {
  const Buffer<Triangle>& triangles = piece.mesh.triangles;
  const std::uint64_t first = piece.first_triangle;
  const std::size_t count = triangles.size();
  const auto number = [&](std::uint32_t corner) {
    return static_cast<std::int64_t>(piece.number_of(corner));
  };
  write_made(file, places.connectivity, first, count, [&](std::size_t t) {
    const auto& [a, b, c] = triangles[t];
    return std::array{number(a), number(b), number(c)};
  });
  write_made(file, places.offsets, first, count + (holds_end ? 1 : 0),
             [&](std::size_t t) { return static_cast<std::int64_t>(3 * (first + t)); });
  write_made(file, places.types, first, count, [](std::size_t) { return kTriangleType; });
}

// Writes everything but the contents of the arrays, and returns where these go.
VtkHdfPlaces write_layout(const MeshSize& size, SharedFile& file) {
  VtkHdfLayout layout;
  try {
    layout = lay_out_vtkhdf(size);
  } catch (const FileFormatError& error) {
    throw FileFormatError(fmt::format("{}: {}", file.path().string(), error.what()));
  }
  for (const auto& [place, bytes] : layout.around) file.write_at(place, bytes.data(), bytes.size());
  return layout.places;
}

}  // namespace

void write_vtkhdf(const Ranks& ranks, const SurfacePiece& piece, std::span<const RgbColor> colors,
                  SharedFile& file) {
  VtkHdfPlaces places{};
  // If the first rank throws, so do the others: none goes on without a layout.
  ranks.together([&] {
    if (ranks.is_first()) places = write_layout(piece.whole, file);
  });
  places = ranks.shared(places);
  ranks.together([&] {
    for (const VertexNumbers::Run& run : piece.numbers.runs()) {
      write_vertices_of(piece, run, colors, places, file);
    }
    write_triangles_of(piece, ranks.number() + 1 == ranks.count(), places, file);
  });
}

}  // namespace vdwmesh
