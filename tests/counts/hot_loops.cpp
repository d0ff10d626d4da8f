// Hot loops on fixed inputs, for counting their instructions: see compare_counts.py. Each loop is
// one dump of callgrind, under its name. Without valgrind the loops just run.
#include <tbb/global_control.h>
#include <valgrind/callgrind.h>

#include <cstdio>
#include <functional>
#include <string>

#include "analysis/distances.hpp"
#include "analysis/mesh_measures.hpp"
#include "extract/extractor.hpp"
#include "measures/exact_union.hpp"
#include "mesh/mesh_io.hpp"
#include "mesh/surface_mesh.hpp"
#include "refine/refiner.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {
namespace {

// The result is taken so that no compiler can leave the work out.
volatile std::uint64_t result;

void count(const char* name, const std::function<std::uint64_t()>& work) {
  result = work();  // once before: what is only made once is not counted
  CALLGRIND_ZERO_STATS;
  CALLGRIND_TOGGLE_COLLECT;
  result = work();
  CALLGRIND_TOGGLE_COLLECT;
  CALLGRIND_DUMP_STATS_AT(name);
}

SphereSet ubiquitin(double probe = 0) {
  std::vector<Sphere> spheres;
  for (const Atom& atom : read_sample("ubiquitin").atoms)
    spheres.push_back({atom.position, atom.radius + probe});
  return SphereSet(std::move(spheres));
}

IndexedMesh extract(const SphereSet& spheres, FieldKind field, double spacing,
                    Connectivity connectivity) {
  ExtractOptions options;
  options.field.kind = field;
  options.grid.spacing = spacing;
  options.connectivity = connectivity;
  return make_cpu_extractor()->extract(spheres, options).mesh;
}

void count_geometry(const SphereSet& spheres) {
  count("read_pdb", [] { return read_sample("ubiquitin").atoms.size(); });
  count("union_by_arcs", [&] {
    return exact_union(spheres, {UnionMethod::arcs, nullptr}).per_sphere.size();
  });
  const SphereSet accessible = ubiquitin(1.4);
  count("accessible_by_arcs", [&] {
    return exact_union(accessible, {UnionMethod::arcs, nullptr}).per_sphere.size();
  });
  count("extract_vdw", [&] {
    return extract(spheres, FieldKind::vdw, 0.5, Connectivity::half_edges).triangle_count();
  });
  count("extract_blinn", [&] {
    return extract(spheres, FieldKind::blinn, 1, Connectivity::triangles).triangle_count();
  });
}

void count_mesh(const SphereSet& spheres) {
  const IndexedMesh mesh = extract(spheres, FieldKind::vdw, 1.5, Connectivity::half_edges);
  count("refine_vdw", [&] {
    RefineOptions options;
    options.subdivisions = 1;
    options.projection = Projection::vdw;
    return make_cpu_refiner()->refine(spheres, mesh, options).mesh.triangle_count();
  });
  count("quality", [&] { return static_cast<std::uint64_t>(quality(mesh).min_angle_deg.median); });
  count("topology", [&] { return topology(mesh).shells; });
  count("distances", [&] {
    const MeshDistances found = distances(mesh, spheres, {1, 1, kNoMemoryLimit, nullptr});
    return static_cast<std::uint64_t>(1e6 * found.mesh_to_surface.mean);
  });
}

void count_half_edges(const SphereSet& spheres) {
  IndexedMesh mesh = extract(spheres, FieldKind::vdw, 0.7, Connectivity::half_edges);
  const IndexedMesh with_opposites = mesh;
  count("build_from_opposites", [&] { return to_surface_mesh(mesh).n_edges(); });
  mesh.opposite = {};
  count("build_from_indices", [&] { return to_surface_mesh(mesh).n_edges(); });
  struct Format {
    const char *write, *read;
    MeshFormat format;
  };
  for (const auto& [write, read, format] : {Format{"write_ply", "read_ply", MeshFormat::ply},
                                            {"write_stl", "read_stl", MeshFormat::stl},
                                            {"write_obj", "read_obj", MeshFormat::obj},
                                            {"write_off", "read_off", MeshFormat::off}}) {
    const std::string bytes = encode_mesh(with_opposites, format).bytes;
    count(write, [&] { return encode_mesh(with_opposites, format).bytes.size(); });
    count(read, [&] { return decode_mesh(bytes, format).mesh.triangle_count(); });
  }
}

}  // namespace
}  // namespace vdwmesh

int main() {
  using namespace vdwmesh;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  // Which version of the loops runs (core/lanes/multiversion.hpp): the counts are of one of them.
  __builtin_cpu_init();
  std::printf("%s\n", __builtin_cpu_supports("x86-64-v3") ? "x86-64-v3" : "baseline");
  std::fflush(stdout);
  const SphereSet spheres = ubiquitin();
  count_geometry(spheres);
  count_mesh(spheres);
  count_half_edges(spheres);
}
