// Writers of text forms for the programs that compute on a mesh or plot it: MSH of Gmsh, and the
// XML of VTK, which ParaView, PyVista and meshio open. They say of each triangle which atom it is
// part of, where the mesh knows that; VTK's also its kind of patch.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <string_view>

#include "mesh/formats/formats.hpp"
#include "mesh/formats/record_writer.hpp"
#include "spheres/box.hpp"

namespace vdwmesh::formats {
namespace {

constexpr std::size_t kMostPerLine = 8 * (RecordBytes::kMostPerNumber + 1);

void write_text(ByteSink& sink, const std::string& text) { sink.write(text.data(), text.size()); }

// One line for each record, of the numbers that numbers(i) returns.
template <class Numbers>
void write_lines(ByteSink& sink, std::size_t count, const Numbers& numbers) {
  write_records(sink, count, kMostPerLine, [&](RecordBytes& out, std::size_t i) {
    const auto values = numbers(i);
    for (std::size_t k = 0; k < values.size(); ++k) {
      out.number(values[k]);
      out.character(k + 1 < values.size() ? ' ' : '\n');
    }
  });
}

std::array<double, 3> place(const MeshView& view, std::size_t v) {
  const Vec3d p = view.position(v);
  return {p.x, p.y, p.z};
}

// The atom of a triangle; -1 where the mesh does not say, or the patch is not of one atom.
std::int64_t atom_of(const MeshView& view, std::size_t t) {
  if (view.patches) {
    const SurfacePatch& patch = view.patches->patches[view.patches->triangle_patch[t]];
    return patch.kind == PatchKind::contact ? static_cast<std::int64_t>(patch.atoms[0]) : -1;
  }
  if (view.mesh.triangle_spheres.empty()) return -1;
  const SphereId id = view.mesh.triangle_spheres[t];
  return id == kNoSphere ? -1 : static_cast<std::int64_t>(id);
}

// Gmsh's tags of a triangle, from 1 on: a physical group and a surface, whose borders it keeps.
// Both are the number of the atom, or 1 without atoms. Of the excluded surface the group is the
// kind of the patch, and the surface the patch.
std::array<std::int64_t, 2> tags_of(const MeshView& view, std::size_t t) {
  if (view.patches) {
    const std::uint32_t patch = view.patches->triangle_patch[t];
    return {static_cast<std::int64_t>(view.patches->patches[patch].kind) + 1,
            std::int64_t{patch} + 1};
  }
  const std::int64_t tag = std::max<std::int64_t>(atom_of(view, t), 0) + 1;
  return {tag, tag};
}

// The triangles of one surface of Gmsh, and the box around them.
struct GmshSurface {
  std::array<std::int64_t, 2> tags;  // as of tags_of()
  std::span<const std::uint32_t> triangles;
  Box box;
};

// The surfaces by their tags. `order`, in which their triangles stand, becomes that of the tags.
std::vector<GmshSurface> gmsh_surfaces(const MeshView& view, std::vector<std::uint32_t>& order) {
  const IndexedMesh& mesh = view.mesh;
  order.resize(mesh.triangle_count());
  std::iota(order.begin(), order.end(), 0U);
  const auto surface_of = [&](std::uint32_t t) { return tags_of(view, t)[1]; };
  std::ranges::stable_sort(order, {}, surface_of);
  std::vector<GmshSurface> surfaces;
  for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
    const auto tags = tags_of(view, order[first]);
    Box box = empty_box();
    for (; end < order.size() && surface_of(order[end]) == tags[1]; ++end) {
      for (const std::uint32_t v : mesh.triangles[order[end]]) include(box, view.position(v));
    }
    surfaces.push_back({tags, std::span(order).subspan(first, end - first), box});
  }
  return surfaces;
}

// A section that Gmsh skips, for lengths that are not in Å.
std::string unit_of_gmsh(const MeshView& view) {
  if (view.scale == 1) return "";
  return fmt::format("$Comments\n{}\n$EndComments\n", unit_text(view.scale));
}

// One array of a VTP file; line(i) is an array of numbers.
template <class Line>
void write_array(ByteSink& sink, const char* attributes, std::size_t count, const Line& line) {
  write_text(sink, fmt::format("<DataArray {} format=\"ascii\">\n", attributes));
  write_lines(sink, count, line);
  write_text(sink, "</DataArray>\n");
}

// What differs between the surfaces and the general grids of VTK, whose cells have a type each.
struct VtkNames {
  std::string_view grid, counter, cells;
};
constexpr VtkNames kPolyData{"PolyData", "NumberOfPolys", "Polys"},
    kUnstructuredGrid{"UnstructuredGrid", "NumberOfCells", "Cells"};

void write_corners(const IndexedMesh& mesh, ByteSink& sink, const VtkNames& names) {
  constexpr int kTriangle = 5;
  const std::size_t triangles = mesh.triangle_count();
  write_array(sink, "type=\"Int64\" Name=\"connectivity\"", triangles,
              [&](std::size_t t) { return mesh.triangles[t]; });
  write_array(sink, "type=\"Int64\" Name=\"offsets\"", triangles,
              [&](std::size_t t) { return std::array{3 * t + 3}; });
  if (names.grid == kUnstructuredGrid.grid)
    write_array(sink, "type=\"UInt8\" Name=\"types\"", triangles,
                [&](std::size_t) { return std::array{kTriangle}; });
}

void write_vtk(const MeshView& view, ByteSink& sink, const VtkNames& names) {
  const IndexedMesh& mesh = view.mesh;
  const std::size_t vertices = mesh.vertex_count(), triangles = mesh.triangle_count();
  // An estimate: three floats and three doubles per vertex, and five 7-digit numbers per triangle.
  sink.expect(93 * vertices + 42 * triangles);
  write_text(sink,
             fmt::format("<?xml version=\"1.0\"?>\n"
                         "<!-- made by vdwmesh; {4} -->\n"
                         "<VTKFile type=\"{0}\" version=\"1.0\" "
                         "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
                         "<{0}><Piece NumberOfPoints=\"{1}\" {2}=\"{3}\">\n"
                         "<PointData Normals=\"normals\">\n",
                         names.grid, vertices, names.counter, triangles, unit_text(view.scale)));
  write_array(sink, "type=\"Float32\" Name=\"normals\" NumberOfComponents=\"3\"", vertices,
              [&](std::size_t v) {
                const Vec3f& n = view.normals[v];
                return std::array<float, 3>{n.x, n.y, n.z};
              });
  write_text(sink, "</PointData>\n<CellData Scalars=\"atom\">\n");
  write_array(sink, "type=\"Int64\" Name=\"atom\"", triangles,
              [&](std::size_t t) { return std::array{atom_of(view, t)}; });
  if (view.patches)
    write_array(sink, "type=\"Int32\" Name=\"patch_kind\"", triangles, [&](std::size_t t) {
      return std::array{
          static_cast<int>(view.patches->patches[view.patches->triangle_patch[t]].kind)};
    });
  write_text(sink, "</CellData>\n<Points>\n");
  write_array(sink, "type=\"Float64\" NumberOfComponents=\"3\"", vertices,
              [&](std::size_t v) { return place(view, v); });
  write_text(sink, fmt::format("</Points>\n<{}>\n", names.cells));
  write_corners(mesh, sink, names);
  write_text(sink, fmt::format("</{}>\n</Piece></{}>\n</VTKFile>\n", names.cells, names.grid));
}

}  // namespace

void write_msh(const MeshView& view, ByteSink& sink) {
  const IndexedMesh& mesh = view.mesh;
  // An estimate: three doubles of about 18 characters and a 7-digit number per vertex, and per
  // triangle eight numbers, four of which have 7 digits.
  sink.expect(66 * mesh.vertex_count() + 52 * mesh.triangle_count());
  write_text(sink, fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{}$Nodes\n{}\n",
                               unit_of_gmsh(view), mesh.vertex_count()));
  write_records(sink, mesh.vertex_count(), kMostPerLine, [&](RecordBytes& out, std::size_t v) {
    out.number(v + 1);
    for (const double x : place(view, v)) {
      out.character(' ');
      out.number(x);
    }
    out.character('\n');
  });
  write_text(sink, fmt::format("$EndNodes\n$Elements\n{}\n", mesh.triangle_count()));
  write_lines(sink, mesh.triangle_count(), [&](std::size_t t) {
    constexpr std::int64_t kTriangleType = 2, kTags = 2;
    const auto [group, surface] = tags_of(view, t);
    const Triangle& corners = mesh.triangles[t];
    return std::array<std::int64_t, 8>{static_cast<std::int64_t>(t) + 1,
                                       kTriangleType,
                                       kTags,
                                       group,
                                       surface,
                                       std::int64_t{corners[0]} + 1,
                                       std::int64_t{corners[1]} + 1,
                                       std::int64_t{corners[2]} + 1};
  });
  write_text(sink, "$EndElements\n");
}

// All nodes stand in the block of the first surface: MSH wants each in one.
void write_msh4(const MeshView& view, ByteSink& sink) {
  const IndexedMesh& mesh = view.mesh;
  const std::size_t vertices = mesh.vertex_count(), triangles = mesh.triangle_count();
  std::vector<std::uint32_t> order;
  const std::vector<GmshSurface> surfaces = gmsh_surfaces(view, order);
  // An estimate as that of version 2.2, without the tags of triangles.
  sink.expect(66 * vertices + 36 * triangles);
  write_text(
      sink, fmt::format("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{}$Entities\n", unit_of_gmsh(view)));
  write_text(sink, fmt::format("0 0 {} 0\n", surfaces.size()));
  for (const auto& [tags, _, box] : surfaces) {
    const Vec3d &a = box.lower, &b = box.upper;
    write_text(sink, fmt::format("{} {} {} {} {} {} {} 1 {} 0\n", tags[1], a.x, a.y, a.z, b.x, b.y,
                                 b.z, tags[0]));
  }
  const std::int64_t home = surfaces.empty() ? 1 : surfaces.front().tags[1];
  write_text(sink, fmt::format("$EndEntities\n$Nodes\n1 {0} 1 {0}\n2 {1} 0 {0}\n", vertices, home));
  write_lines(sink, vertices, [](std::size_t v) { return std::array{v + 1}; });
  write_lines(sink, vertices, [&](std::size_t v) { return place(view, v); });
  write_text(sink,
             fmt::format("$EndNodes\n$Elements\n{0} {1} 1 {1}\n", surfaces.size(), triangles));
  for (const GmshSurface& surface : surfaces) {
    constexpr int kTriangleType = 2;
    write_text(sink, fmt::format("2 {} {} {}\n", surface.tags[1], kTriangleType,
                                 surface.triangles.size()));
    write_lines(sink, surface.triangles.size(), [&](std::size_t i) {
      const std::uint32_t t = surface.triangles[i];
      const Triangle& c = mesh.triangles[t];
      return std::array<std::uint64_t, 4>{std::uint64_t{t} + 1, std::uint64_t{c[0]} + 1,
                                          std::uint64_t{c[1]} + 1, std::uint64_t{c[2]} + 1};
    });
  }
  write_text(sink, "$EndElements\n");
}

void write_vtp(const MeshView& view, ByteSink& sink) { write_vtk(view, sink, kPolyData); }

void write_vtu(const MeshView& view, ByteSink& sink) { write_vtk(view, sink, kUnstructuredGrid); }

}  // namespace vdwmesh::formats
