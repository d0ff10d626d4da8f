// Meshes for the page of a structure, by the meshers that all verbs have.
#include <algorithm>
#include <limits>

#include "memory_plan.hpp"
#include "remesh/surface_remesher.hpp"
#include "steps/excluded_steps.hpp"
#include "view/view.hpp"

namespace vdwmesh::apps {
namespace {

// More triangles per Å² of the excluded surface are not seen.
constexpr double kMostDensity = 8;

Vec3d middle_of(const IndexedMesh& mesh, const Triangle& t) {
  return (1.0 / 3) * (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]);
}

// Of the atoms of a patch the one whose sphere is nearest.
SphereId nearest_atom(const SurfacePatch& patch, const Vec3d& p, const Molecule& molecule) {
  SphereId nearest = patch.atoms.front();
  double least = std::numeric_limits<double>::infinity();
  for (const SphereId id : patch.atoms) {
    if (id == kNoSphere) break;
    const Atom& atom = molecule.atoms[id];
    const double distance = norm(p - atom.position) - atom.radius;
    if (distance < least) least = distance, nearest = id;
  }
  return nearest;
}

DisplayMesh display_of(PatchedMesh made, const Molecule& molecule) {
  DisplayMesh shown{.mesh = std::move(made.mesh), .atoms = {}, .kinds = {}};
  for (std::size_t t = 0; t < shown.mesh.triangle_count(); ++t) {
    const SurfacePatch& patch = made.patches[made.triangle_patch[t]];
    const Vec3d middle = middle_of(shown.mesh, shown.mesh.triangles[t]);
    shown.atoms.push_back(nearest_atom(patch, middle, molecule));
    shown.kinds.push_back(patch.kind);
  }
  return shown;
}

// Marching cubes know the atoms of vertices alone.
DisplayMesh display_of(IndexedMesh made) {
  DisplayMesh shown{.mesh = std::move(made), .atoms = {}, .kinds = {}};
  const IndexedMesh& mesh = shown.mesh;
  shown.atoms.assign(mesh.triangle_spheres.begin(), mesh.triangle_spheres.end());
  if (!shown.atoms.empty()) return shown;
  for (const Triangle& t : mesh.triangles) shown.atoms.push_back(mesh.vertex_spheres.atoms[t[0]]);
  return shown;
}

MemoryDemand demand_of(const SurfaceOptions& surface) {
  MemoryDemand demand;
  demand.surface = surface;
  demand.measures = Switch::off;
  demand.page = Switch::on;
  return demand;
}

}  // namespace

DisplayMesh make_display_mesh(const Structure& structure, double probe, SurfaceOptions surface,
                              std::uint64_t most_triangles, Session& session) {
  const auto& [molecule, spheres] = structure;
  const std::uint64_t limit = session.machine.memory_limit;
  if (surface.kind == ExactSurface::excluded) {
    const double area = session.report.excluded->complete.area;
    surface.density = std::min(kMostDensity, static_cast<double>(most_triangles) / area);
    surface.edge_length = edge_length_of_density(*surface.density);
    surface.remeshed = true;
    MemoryDemand demand = demand_of(surface);
    check_memory_before(demand, spheres, limit);
    return display_of(make_excluded_mesh(molecule, probe, surface, session), molecule);
  }
  surface = with_few_triangles(surface, spheres, most_triangles);
  MemoryDemand demand = demand_of(surface);
  check_memory_before(demand, spheres, limit);
  return display_of(make_mesh(spheres, surface, session, {.normals = Normals::none}));
}

}  // namespace vdwmesh::apps
