// What Python finds out about meshes: measures, quality, comparison with the union or the excluded
// surface, distances.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include "analysis/comparison.hpp"
#include "analysis/distances.hpp"
#include "analysis/mesh_measures.hpp"
#include "analysis/signed_distance.hpp"
#include "arrays.hpp"
#include "call.hpp"
#include "core/errors.hpp"
#include "excluded/excluded_bounds.hpp"
#include "excluded/excluded_comparison.hpp"
#include "excluded/excluded_distances.hpp"
#include "mesh/connect/weld.hpp"
#include "mesh/mesh_io.hpp"
#include "mesh_handle.hpp"
#include "request/memory_limit.hpp"
#include "requests.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

using namespace py::literals;

py::dict dict_of(const Distribution& d) {
  return py::dict("min"_a = d.min, "p01"_a = d.p01, "median"_a = d.median, "p99"_a = d.p99,
                  "max"_a = d.max, "mean"_a = d.mean);
}

// With the keys of the report.
py::dict dict_of(const MeshTopology& t, const MeshMeasures& m) {
  return py::dict("vertices"_a = t.vertices, "edges"_a = t.edges, "triangles"_a = t.triangles,
                  "area"_a = m.area, "volume"_a = m.volume, "outer_area"_a = m.outer_area,
                  "void_area"_a = m.void_area, "shells"_a = t.shells, "components"_a = t.components,
                  "voids"_a = t.voids, "genus"_a = t.genus,
                  "euler_characteristic"_a = t.euler_characteristic, "closed"_a = t.closed,
                  "manifold"_a = t.manifold, "oriented"_a = t.oriented);
}

py::dict summary(const MeshHandle& h) {
  const MeshSummary found = call({}, [&](Monitor&) { return summarize(*h.mesh); });
  return dict_of(found.topology, found.measures);
}

py::dict quality(const MeshHandle& h, bool with_self_intersections) {
  std::optional<std::uint64_t> crossings;
  const MeshExamination found = call({}, [&](Monitor& monitor) {
    const MeshExamination examined = examine(*h.mesh);
    if (with_self_intersections) {
      crossings = self_intersections(*h.mesh, &monitor, edges_of(examined.topology), h.grid);
    }
    return examined;
  });
  py::dict result = dict_of(found.topology, found.measures);
  result["degenerate_triangles"] = found.quality.degenerate_triangles;
  result["self_intersections"] = crossings;
  result["min_angle_deg"] = dict_of(found.quality.min_angle_deg);
  result["aspect_ratio"] = dict_of(found.quality.aspect_ratio);
  result["edge_length"] = dict_of(found.quality.edge_length);
  return result;
}

// A mesh file; vertices in one place are merged where that closes the mesh, as the program does it.
py::tuple read_file(const std::string& path) {
  MeshFile file = call({}, [&](Monitor&) {
    MeshFile read = read_mesh(path, default_memory_limit());
    if (read.mesh.triangles.empty()) {
      throw FileFormatError(path + ": holds no triangles; a triangle mesh is needed");
    }
    if (read.welded || topology(read.mesh).closed) return read;
    IndexedMesh merged = welded(read.mesh);
    const std::size_t before = read.mesh.vertex_count(), after = merged.vertex_count();
    if (after == before || !topology(merged).closed) return read;
    read.notes.push_back(fmt::format(
        "{} of the mesh's {} vertices lay where others do and were merged, which closes it",
        before - after, before));
    read.mesh = std::move(merged);
    return read;
  });
  return py::make_tuple(handle_of(std::move(file.mesh)), file.notes);
}

std::vector<Vec3d> face_centers(const IndexedMesh& mesh) {
  std::vector<Vec3d> centers(mesh.triangle_count());
  for (std::size_t t = 0; t < centers.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    centers[t] = (1.0 / 3) * (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]);
  }
  return centers;
}

py::dict dict_of(const DistanceStatistics& d) {
  return py::dict("mean"_a = d.mean, "rms"_a = d.rms, "max"_a = d.max, "p50"_a = d.p50,
                  "p95"_a = d.p95, "p99"_a = d.p99, "mean_error"_a = d.mean_error,
                  "rms_error"_a = d.rms_error, "samples"_a = d.samples);
}

struct Compared {
  Comparison comparison;
  double exact_area, exact_volume;  // Å², Å³
  MeshSummary mesh;
  std::vector<double> face_distance;
  std::optional<HausdorffBounds> bounds;  // of the excluded surface
};

Compared compare_all(const IndexedMesh& mesh, const SphereSet& spheres,
                     const DistanceOptions& options) {
  Compared all{};
  all.mesh = summarize(mesh);
  const ExactUnion exact = exact_union(spheres, {UnionMethod::cgal, options.monitor});
  all.exact_area = exact.area, all.exact_volume = exact.volume;
  all.comparison = compare(all.mesh.topology, all.mesh.measures, exact);
  all.comparison.distances = distances(mesh, spheres, options);
  all.face_distance = signed_distances(face_centers(mesh), spheres, options.monitor);
  return all;
}

// The same for the excluded surface of atoms.
Compared compare_excluded(const IndexedMesh& mesh, const SphereSet& atoms, double probe,
                          const DistanceOptions& options) {
  Compared all{};
  all.mesh = summarize(mesh);
  const ExcludedSurface exact =
      excluded_measures(atoms, {.probe = probe, .monitor = options.monitor}).complete;
  all.exact_area = exact.area, all.exact_volume = exact.volume;
  all.comparison = compare(all.mesh.topology, all.mesh.measures, exact);
  all.comparison.distances = excluded_distances(mesh, atoms, probe, options);
  all.bounds = excluded_distance_bounds(mesh, atoms, probe, {.monitor = options.monitor});
  all.face_distance = excluded_signed_distances(face_centers(mesh), atoms, probe, options.monitor);
  return all;
}

py::dict compare(const MeshHandle& h, const py::buffer& coords, const py::buffer& radii,
                 const std::string& surface, std::optional<double> given, double samples,
                 std::uint64_t seed) {
  const bool excluded = is_excluded(surface);
  const double probe = probe_of(surface, given);
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  Compared all = call({}, [&](Monitor& monitor) {
    DistanceOptions options;
    options.samples_per_area = checked_samples(samples, fmt::format("{}", samples), Door::python);
    options.seed = seed;
    options.monitor = &monitor;
    return excluded ? compare_excluded(*h.mesh, spheres_of(centers, sizes, 0), probe, options)
                    : compare_all(*h.mesh, spheres_of(centers, sizes, probe), options);
  });
  const Comparison& c = all.comparison;
  return py::dict(
      "area"_a = all.mesh.measures.area, "volume"_a = all.mesh.measures.volume,
      "exact_area"_a = all.exact_area, "exact_volume"_a = all.exact_volume,
      "area_relative_error"_a = c.area_relative_error,
      "volume_relative_error"_a = c.volume_relative_error,
      "euler_characteristic_difference"_a = c.euler_characteristic_difference,
      "mesh_to_surface"_a = dict_of(c.distances->mesh_to_surface),
      "surface_to_mesh"_a = dict_of(c.distances->surface_to_mesh),
      "hausdorff_lower_bound"_a = c.distances->hausdorff_lower_bound,
      "hausdorff_upper_bound"_a = all.bounds ? std::optional(all.bounds->upper()) : std::nullopt,
      "face_distance"_a = array_of(std::move(all.face_distance)));
}

Array signed_distance(const py::buffer& points, const py::buffer& coords, const py::buffer& radii,
                      const std::string& surface, std::optional<double> given) {
  const bool excluded = is_excluded(surface);
  const double probe = probe_of(surface, given);
  const Numbers places(points, "points", 2), centers(coords, "coords", 2), sizes(radii, "radii", 1);
  return array_of(call({}, [&](Monitor& monitor) {
    const std::vector<Vec3d> measured = points_of(places);
    if (excluded) {
      return excluded_signed_distances(measured, spheres_of(centers, sizes, 0), probe, &monitor);
    }
    return signed_distances(measured, spheres_of(centers, sizes, probe), &monitor);
  }));
}

}  // namespace

void bind_checks(py::module_& module) {
  module.def("summary", &summary);
  module.def("quality", &quality);
  module.def("read_mesh", &read_file);
  module.def("compare", &compare);
  module.def("signed_distance", &signed_distance);
}

}  // namespace vdwmesh::python
