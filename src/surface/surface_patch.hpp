// The smooth patches of a surface that probes leave free, and meshes whose triangles know theirs. A
// patch is part of a sphere or of a torus. The solvent-excluded surface has all three kinds
// (docs/excluded_surface.md).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// contact: on the sphere of an atom, which is inside.
// saddle: on the torus that a probe sweeps as it rolls over two atoms; the probe is outside.
// concave: on the sphere of a probe that touches three atoms or more; the probe is outside.
enum class PatchKind : std::uint8_t { contact, saddle, concave };
inline constexpr std::size_t kPatchKinds = 3;

// A contact patch has one atom, a saddle two, a concave patch three or more, of which the first
// three are given.
struct SurfacePatch {
  PatchKind kind = PatchKind::contact;
  // Ascending; unused places hold kNoSphere.
  std::array<SphereId, 3> atoms = {kNoSphere, kNoSphere, kNoSphere};
  double radius = 0;  // Å: of the atom, or of the probe
  Vec3d center{};     // Å: of the atom or probe; of a saddle, of the circle that the probe runs on
  // Of saddles alone: the unit vector along the axis of that circle, and its radius, Å.
  Vec3d axis{};
  double ring_radius = 0;
};

// A mesh whose triangles know their patches. If its edges follow the curves between patches,
// `vertex_patch` is empty, and every vertex lies on the patches of all triangles around it. If not,
// it names the patch of each vertex, and triangles take that of the foot of their middle.
struct PatchedMesh {
  IndexedMesh mesh;
  std::vector<SurfacePatch> patches;
  std::vector<std::uint32_t> triangle_patch;  // by triangle: an index into `patches`
  std::vector<std::uint32_t> vertex_patch;    // empty, or the same by vertex
};

// Throws InvalidInput unless every triangle names a patch of the mesh, and every vertex if any
// does.
void check_patches(const PatchedMesh& mesh);

// A point nearer to the axis of a saddle than this share of the probe's radius is on it: a cusp. A
// cusp's coordinates are rounded, to some 1e-13 Å far from the origin, while the other vertices of
// a mesh are much farther away.
inline constexpr double kOnAxis = 1e-10;

// Where a point stands to a patch. `to_center` leads from the point to the centre of the ball whose
// sphere is the patch there: the atom, the probe, or the probe of a saddle that is nearest to the
// point. `girth` is the distance of the point from the axis of a saddle, and 1 of other patches.
// On the axis, where no probe is the nearest, both are 0.
struct PatchFooting {
  Vec3d to_center;
  double girth;
};

VDWMESH_HD inline PatchFooting footing(const SurfacePatch& patch, const Vec3d& p) {
  const Vec3d to_center = patch.center - p;
  if (patch.kind != PatchKind::saddle) return {to_center, 1};
  const double height = dot(to_center, patch.axis);
  const Vec3d inward = to_center - height * patch.axis;  // towards the axis
  const double girth = norm(inward);
  if (!(girth > kOnAxis * patch.radius)) return {{0, 0, 0}, 0};
  return {to_center - (patch.ring_radius / girth) * inward, girth};
}

// The outward unit normal of a patch at a point of it; the zero vector on the axis of a saddle.
VDWMESH_HD inline Vec3d patch_normal(const SurfacePatch& patch, const Vec3d& p) {
  const Vec3d to_center = footing(patch, p).to_center;
  const double length = norm(to_center);
  if (!(length > 0)) return {0, 0, 0};
  return (patch.kind == PatchKind::contact ? -1 / length : 1 / length) * to_center;
}

// The principal curvatures of a patch at a point of it, 1/Å; positive where the surface is convex.
// Spheres have one value, 1/r or -1/p. A saddle has -1/p along the profile of the probe and cos α /
// (ρ - p cos α) around its axis, for the profile angle α and the radius ρ of the circle: ρ - p cos
// α is the distance g from the axis, so this is (ρ - g) / (p g). It is infinite on the axis.
struct PrincipalCurvatures {
  double along, around;
  VDWMESH_HD double mean() const { return 0.5 * (along + around); }
  VDWMESH_HD double gaussian() const { return along * around; }
};

VDWMESH_HD inline PrincipalCurvatures patch_curvatures(const SurfacePatch& patch, const Vec3d& p) {
  const double of_ball = (patch.kind == PatchKind::contact ? 1 : -1) / patch.radius;
  if (patch.kind != PatchKind::saddle) return {of_ball, of_ball};
  const double girth = footing(patch, p).girth;
  return {of_ball, (patch.ring_radius - girth) / (patch.radius * girth)};
}

// Curvatures by vertex, 1/Å and 1/Å²: those of its patch, or between patches the mean of theirs. In
// a cusp the saddles, which have no finite curvature there, do not count; a vertex with nothing but
// saddles of that kind has NaN. Of meshes with `vertex_patch` those of that patch.
struct VertexCurvatures {
  std::vector<float> mean, gaussian;
};
// Throws InvalidInput as check_patches() does.
VertexCurvatures vertex_curvatures(const PatchedMesh& mesh);

// The patches that meet in each vertex which lies on several: pairs of vertex and patch, ascending,
// each once. Vertices of one patch have no pair.
struct VertexPatch {
  std::uint32_t vertex, patch;
};
std::vector<VertexPatch> patches_of_shared_vertices(const PatchedMesh& mesh);

}  // namespace vdwmesh
