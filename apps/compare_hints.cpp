// Looks for what is commonly wrong with mesh files before their figures mislead: vertices that
// several triangles hold apart, units other than Å, and a mesh that was moved. Nothing is put right
// but what closes the mesh, and that is noted; for the rest a warning says what it looks like.
#include "compare_hints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/mesh_measures.hpp"
#include "mesh/weld.hpp"

namespace vdwmesh::apps {
namespace {

// A mesh of the molecule is about as large as its spheres; these are far outside of that.
constexpr double kSmall = 0.5, kLarge = 2;
// Of the diagonal of the spheres' box: how far apart the middles of the two boxes may be.
constexpr double kAside = 0.25;

// Of the vertices that triangles use: what no triangle names is no part of the surface.
Box box_of(const IndexedMesh& mesh) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::min(box.lower[axis], mesh.positions[v][axis]);
        box.upper[axis] = std::max(box.upper[axis], mesh.positions[v][axis]);
      }
  return box;
}

// What a ratio of sizes looks like; empty where it is that of no unit.
std::string unit_of(double ratio) {
  const auto about = [ratio](double unit) { return std::abs(std::log(ratio / unit)) < 0.3; };
  if (about(0.1)) return ": as if in nm; its coordinates times 10 would be Å";
  if (about(100)) return ": as if in pm; its coordinates divided by 100 would be Å";
  if (about(10)) return ": its coordinates divided by 10 would fit";
  return ": is it in Å, and of this molecule?";
}

}  // namespace

// Only open meshes come here: a closed one is as its author meant it, whatever lies in one place.
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
void warn_of_place(const IndexedMesh& mesh, const SphereSet& spheres, Report& report) {
  const Box ours = bounding_box(spheres), theirs = box_of(mesh);
  const double size = norm(ours.upper - ours.lower);
  const double ratio = norm(theirs.upper - theirs.lower) / size;
  if (ratio < kSmall || ratio > kLarge) {
    report.warn_if(true, "the mesh is {:.3g} times as large as the molecule{}", ratio,
                   unit_of(ratio));
    return;
  }
  const double aside = norm(0.5 * (theirs.lower + theirs.upper) - 0.5 * (ours.lower + ours.upper));
  if (!(aside > kAside * size)) return;
  report.warn_if(
      true,
      "the mesh lies {:.3g} Å from the molecule, middle to middle: was one of them moved, "
      "to the origin for example?",
      aside);
}

}  // namespace vdwmesh::apps
