// Hashes of what the loops of core/lanes/multiversion.hpp make, a line each: see compare_hashes.py.
// The first line says which version of the loops runs.
#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "analysis/distances.hpp"
#include "analysis/mesh_measures.hpp"
#include "core/lanes/multiversion.hpp"
#include "creases/exact_mesher.hpp"
#include "excluded/excluded_distances.hpp"
#include "excluded/excluded_mesher.hpp"
#include "extract/extractor.hpp"
#include "extract/sampled_field.hpp"
#include "interface/interfaces.hpp"
#include "measures/arcs/arcs.hpp"
#include "refine/patch_refiner.hpp"
#include "refine/refiner.hpp"
#include "structure/reader.hpp"
#include "support/sampled_spheres.hpp"

namespace vdwmesh {
namespace {

const char* loops() {
#ifdef VDWMESH_TWO_VERSIONS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v3")) return "x86-64-v3";
#endif
  return "baseline";
}

void print(const std::string& name, const IndexedMesh& mesh) {
  const IndexedMeshHash h = hash(mesh);
  fmt::print("{}: {} triangles, {:016x} {:016x} {:016x} {:016x} {:016x}\n", name,
             mesh.triangle_count(), h.positions, h.normals, h.vertex_spheres, h.triangles,
             h.triangle_spheres);
}

void print(const std::string& name, const std::vector<double>& values) {
  fmt::print("{}:", name);
  for (const double value : values) fmt::print(" {:016x}", std::bit_cast<std::uint64_t>(value));
  fmt::print("\n");
}

void print_measures(const std::string& name, const IndexedMesh& mesh) {
  const MeshExamination found = examine(mesh);
  const auto of = [](const Distribution& d) {
    return std::vector<double>{d.min, d.p01, d.median, d.p99, d.max, d.mean};
  };
  print(name + ", area and volume",
        std::vector<double>{found.measures.area, found.measures.volume.value_or(0)});
  print(name + ", angles", of(found.quality.min_angle_deg));
  print(name + ", aspect ratios", of(found.quality.aspect_ratio));
  print(name + ", edges", of(found.quality.edge_length));
}

// Every triangle of a copy that is shifted a little crosses others of the mesh.
void print_crossings(const std::string& name, IndexedMesh mesh) {
  const auto vertices = static_cast<std::uint32_t>(mesh.vertex_count());
  const std::size_t triangles = mesh.triangle_count();
  for (std::uint32_t v = 0; v < vertices; ++v) {
    mesh.positions.push_back(mesh.positions[v] + Vec3d{0.1, 0.05, 0});
  }
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    mesh.triangles.push_back({a + vertices, b + vertices, c + vertices});
  }
  std::vector<double> numbers;
  for (const auto& [a, b] : intersecting_pairs(mesh))
    numbers.insert(numbers.end(), {1.0 * a, 1.0 * b});
  print(name + ", crossing triangles", numbers);
}

void print_distances(const std::string& name, const MeshDistances& found) {
  for (const DistanceStatistics& d : {found.mesh_to_surface, found.surface_to_mesh}) {
    print(name + ", distances", std::vector<double>{d.mean, d.rms, d.max});
  }
}

void print_surface(const std::string& name, const SphereSet& spheres, FieldKind kind,
                   Projection projection) {
  ExtractOptions options;
  options.field.kind = kind;
  options.grid.spacing = 0.7;
  options.connectivity = Connectivity::half_edges;
  const ExtractResult extracted = make_cpu_extractor()->extract(spheres, options);
  print(name, extracted.mesh);
  RefineOptions refine;
  refine.subdivisions = 1;
  refine.projection = projection;
  refine.field = options.field;
  refine.grid = extracted.grid;
  const IndexedMesh refined = make_cpu_refiner()->refine(spheres, extracted.mesh, refine).mesh;
  print(name + ", refined", refined);
  print_measures(name + ", refined", refined);
  print_measures(name, extracted.mesh);
}

void print_sampled(const SphereSet& spheres) {
  const auto mesher = make_cpu_field_mesher();
  for (const FieldKind kind :
       {FieldKind::blinn, FieldKind::soft_object, FieldKind::inverse_squared}) {
    ExtractOptions options;
    options.field.kind = kind;
    options.grid.spacing = 0.9;
    print(fmt::format("sampled field {}", static_cast<int>(kind)),
          mesher->mesh(testing::sampled_spheres(spheres, options), options).mesh);
  }
}

void print_arcs(const std::string& name, const SphereSet& spheres, double probe) {
  std::vector<Sphere> balls;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    balls.push_back({spheres[i].center, spheres[i].radius + probe});
  }
  std::vector<double> values;
  for (const SphereMeasures& m : arc_measures(SphereSet(std::move(balls))).per_sphere) {
    values.insert(values.end(), {m.area, m.volume});
  }
  print(name, values);
}

// Two groups that are everywhere at each other: every second ball is of the other.
void print_interfaces(const SphereSet& spheres) {
  std::vector<std::int32_t> group(spheres.size());
  for (std::size_t i = 0; i < group.size(); ++i) group[i] = static_cast<std::int32_t>(i % 2);
  const Interfaces found = interfaces(spheres, group);
  print("interfaces, alone", found.alone);
  print("interfaces, in the whole", found.in_whole);
  std::vector<double> contacts;
  for (const AtomContact& c : found.pairs.at(0).contacts) contacts.push_back(c.area);
  print("interfaces, contacts", contacts);
}

void print_excluded(const SphereSet& spheres) {
  ExcludedMesh mesh = mesh_excluded(spheres, {.edge_length = 0.7});
  print("excluded", mesh.mesh);
  const PatchRefineResult refined = refine_patches(spheres, std::move(mesh), {.subdivisions = 1});
  print("excluded, refined", refined.mesh.mesh);
  print_distances("excluded", excluded_distances(refined.mesh.mesh, spheres, kWaterProbe));
}

// Spheres on the nodes of the grid, whose squared distances are whole: every comparison is a tie.
SphereSet lattice() {
  std::vector<Sphere> spheres;
  for (int i = 0; i < 27; ++i)
    spheres.push_back({{1.4 * (i % 3), 1.4 * (i / 3 % 3), 1.4 * (i / 9)}, 1.4});
  return SphereSet(std::move(spheres));
}

SphereSet bpti() {
  std::vector<Sphere> spheres;
  for (const Atom& atom : read_sample("bpti").atoms)
    spheres.push_back({atom.position, atom.radius});
  return SphereSet(std::move(spheres));
}

}  // namespace
}  // namespace vdwmesh

int main() {
  using namespace vdwmesh;
  fmt::print("{}\n", loops());
  const SphereSet spheres = bpti();
  print_surface("vdw", spheres, FieldKind::vdw, Projection::vdw);
  print_surface("vdw on a lattice", lattice(), FieldKind::vdw, Projection::vdw);
  print_surface("Blinn", spheres, FieldKind::blinn, Projection::field);
  print_surface("soft object", spheres, FieldKind::soft_object, Projection::field);
  print_surface("inverse squared", spheres, FieldKind::inverse_squared, Projection::field);
  print_sampled(spheres);
  const IndexedMesh exact = mesh_union(spheres).mesh;
  print("crease-exact", exact);
  print_measures("crease-exact", exact);
  print_crossings("crease-exact", exact);
  print_distances("crease-exact", distances(exact, spheres));
  for (const double probe : {0.0, 1.4}) {
    print_arcs(fmt::format("arcs, probe {}", probe), spheres, probe);
  }
  print_interfaces(spheres);
  print_excluded(spheres);
}
