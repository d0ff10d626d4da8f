// Looks for what is commonly wrong with mesh files before their figures mislead: vertices that
// several triangles hold apart, units other than Å, a mesh that was moved or is of another surface.
// Nothing is put right but what closes the mesh, and that is noted; for the rest a warning says
// what it looks like.
#include "verbs/compare_hints.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analysis/mesh_measures.hpp"
#include "mesh/connect/weld.hpp"
#include "spheres/box.hpp"

namespace vdwmesh::apps {
namespace {

// The diagonals of the boxes of a mesh and of its molecule's spheres are about equal. A ratio
// outside of these limits is warned of.
constexpr double kSmall = 0.5, kLarge = 2;
// So is a distance between the middles of the two boxes above this share of the spheres' diagonal.
constexpr double kAside = 0.25;
// And a volume above this many times that of the balls. Meshes of their surface have less, but the
// excluded surface of a protein has 1.4 times the volume of its atoms, the accessible one 2.3
// times.
constexpr double kOtherVolume = 1.15;

// Vertices that no triangle names are no part of the surface.
Box box_of_triangles(const IndexedMesh& mesh) {
  Box box = empty_box();
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) include(box, mesh.positions[v]);
  return box;
}

// What a ratio of sizes suggests about the unit of the mesh, as the end of the warning.
std::string unit_of(double ratio) {
  const auto about = [ratio](double unit) { return std::abs(std::log(ratio / unit)) < 0.3; };
  if (about(0.1)) return ": as if in nm; its coordinates times 10 would be Å";
  if (about(100)) return ": as if in pm; its coordinates divided by 100 would be Å";
  if (about(10)) return ": its coordinates divided by 10 would fit";
  return ": is it in Å, and of this molecule?";
}

}  // namespace

// The caller asks for open meshes alone. A closed mesh is taken as its author meant it, even if
// vertices coincide.
bool weld_if_that_closes(MeshFile& file, std::uint64_t memory_limit, Report& report) {
  const IndexedMesh& mesh = file.mesh;
  const std::uint64_t need =
      indexed_mesh_bytes(mesh) + welding_bytes({mesh.vertex_count(), mesh.triangle_count()});
  if (file.welded || need > memory_limit) return false;
  IndexedMesh merged = welded(mesh);
  const std::size_t before = mesh.vertex_count(), after = merged.vertex_count();
  if (after == before) return false;
  if (!topology(merged).closed) {
    report.warnings.push_back(fmt::format(
        "{} of the mesh's {} vertices lie where others do, so triangles that meet there "
        "are not connected; merging them would not close the mesh",
        before - after, before));
    return false;
  }
  file.notes.push_back(fmt::format(
      "{} of the mesh's {} vertices lay where others do and were merged, which closes it",
      before - after, before));
  file.mesh = std::move(merged);
  return true;
}

// Sizes are compared first, because a mesh in other units lies elsewhere as well.
bool warn_of_place(const IndexedMesh& mesh, const SphereSet& spheres, Report& report) {
  const Box ours = bounding_box(spheres), theirs = box_of_triangles(mesh);
  const double size = norm(ours.upper - ours.lower);
  const double ratio = norm(theirs.upper - theirs.lower) / size;
  if (ratio < kSmall || ratio > kLarge) {
    report.warn_if(true, "the mesh is {:.3g} times as large as the molecule{}", ratio,
                   unit_of(ratio));
    return true;
  }
  const double aside = norm(0.5 * (theirs.lower + theirs.upper) - 0.5 * (ours.lower + ours.upper));
  if (!(aside > kAside * size)) return false;
  report.warn_if(
      true,
      "the mesh lies {:.3g} Å from the molecule, middle to middle: was one of them moved, "
      "to the origin for example?",
      aside);
  return true;
}

void warn_of_surface(Report& report) {
  const std::optional<double>& volume = report.mesh->measures.volume;  // empty: not closed
  if (!volume) return;
  const double ratio = std::abs(*volume) / report.exact->volume;  // below 0: turned inside out
  report.warn_if(ratio > kOtherVolume,
                 "the mesh has {:.3g} times the exact volume: is it of another surface? --surface "
                 "ses is the solvent-excluded one, --surface sas the accessible one",
                 ratio);
}

}  // namespace vdwmesh::apps
