// Meshes for Python: made of spheres by both meshers, or the excluded surface of atoms, taken from
// arrays, and written. A mesh may take as much memory as the machine leaves; more is refused before
// it is taken, as by the program.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "arrays.hpp"
#include "call.hpp"
#include "core/errors.hpp"
#include "creases/exact_mesher.hpp"
#include "cuda/backend.hpp"
#include "cuda_array.hpp"
#include "excluded/excluded_mesher.hpp"
#include "mesh/mesh_io.hpp"
#include "mesh_handle.hpp"
#include "refine/patch_refiner.hpp"
#include "remesh/surface_remesher.hpp"
#include "request/memory_limit.hpp"
#include "requests.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

// What vdwmesh.mesh is asked for.
struct MeshCall {
  explicit MeshCall(const py::kwargs& given)
      : surface(surface_options_of(given)),
        probe(probe_of(given["surface"].cast<std::string>(), value_of<double>(given, "probe"))),
        normals(given["normals"].cast<bool>()),
        fixed_grid(given["fixed_grid"].cast<bool>()),
        backend(backend_of(given["device"].cast<std::string>())) {
    if (backend != Backend::cuda) return;
    if (surface.min_angle) {
      throw BackendUnavailable("device: meshes with a min_angle are made on the CPU");
    }
    if (is_excluded())
      throw BackendUnavailable("device: the excluded surface is meshed on the CPU");
  }
  bool is_exact() const { return surface.mesher == Mesher::exact; }
  bool is_excluded() const { return surface.kind == ExactSurface::excluded; }

  SurfaceOptions surface;
  double probe;  // Å
  bool normals, fixed_grid;
  Backend backend;
};

RefineOptions refinement(const MeshCall& request, Monitor& monitor) {
  RefineOptions refine;
  refine.subdivisions = request.surface.subdivisions;
  refine.crossings = request.surface.crossings;
  refine.projection = request.surface.projection;
  refine.field = request.surface.field;
  refine.memory_limit = default_memory_limit();
  refine.monitor = &monitor;
  return refine;
}

// It looks at the edge lengths of the request.
ExactMeshOptions exact_options(const MeshCall& request, Monitor& monitor) {
  const SurfaceOptions& surface = request.surface;
  return {.edge_length = surface.edge_lengths.empty() ? surface.edge_length.value_or(0) : 0,
          .edge_lengths = surface.edge_lengths,
          .min_angle = surface.min_angle.value_or(0),
          .memory_limit = default_memory_limit(),
          .monitor = &monitor};
}

// The crease-exact mesher and the refiner, each on the device asked for.
IndexedMesh mesh_exactly(const SphereSet& spheres, const MeshCall& request, Monitor& monitor) {
  const RefineOptions refine = refinement(request, monitor);
  const auto mesher = make_exact_mesher(request.backend);
  IndexedMesh mesh = std::move(mesher->mesh(spheres, exact_options(request, monitor)).mesh);
  if (request.surface.subdivisions == 0) return mesh;
  return std::move(make_refiner(request.backend)->refine(spheres, std::move(mesh), refine).mesh);
}

// A ball holds a grid node for certain if the spacing is at most 2/√3 of its radius.
[[noreturn]] void throw_too_coarse(double least_radius, double spacing) {
  throw InvalidInput(
      fmt::format("spacing: {} is too coarse, no grid node lies inside the surface; try {:.2g}",
                  spacing, least_radius));
}

double least_radius(const SphereSet& spheres) {
  return std::ranges::min(spheres.spheres(), {}, &Sphere::radius).radius;
}

// The grid with its first node moved down to multiples of the spacing, and with one more cell along
// each axis to reach as far as before. So all such grids have the nodes of one lattice.
GridSpec at_multiples(GridSpec grid) {
  for (int axis = 0; axis < 3; ++axis) {
    grid.origin[axis] = grid.spacing * std::floor(grid.origin[axis] / grid.spacing);
    ++grid.cells[axis];
  }
  return grid;
}

// Of marching cubes, on a grid around the boxes of the balls and of their centres.
ExtractOptions extraction(const MeshCall& request, const Box& balls, const Box& centers,
                          Monitor& monitor) {
  ExtractOptions extract;
  extract.field = request.surface.field;
  extract.grid = request.surface.grid;
  const GridSpec grid = make_grid(balls, centers, extract.grid);
  extract.grid.given = request.fixed_grid ? at_multiples(grid) : grid;
  extract.normals = request.normals ? Normals::gradients : Normals::none;
  extract.monitor = &monitor;
  return extract;
}

// Sets `grid` to the one on which the mesh is made.
IndexedMesh march(const SphereSet& spheres, const MeshCall& request, Monitor& monitor,
                  std::optional<GridSpec>& grid) {
  ExtractOptions extract =
      extraction(request, bounding_box(spheres), center_bounding_box(spheres), monitor);
  const RefineOptions refine = refinement(request, monitor);
  extract.memory_limit = refine.memory_limit;
  grid = extract.grid.given;
  const auto pipeline = make_pipeline(request.backend);
  IndexedMesh mesh = std::move(pipeline->run(spheres, extract, refine).mesh);
  if (mesh.triangles.empty()) throw_too_coarse(least_radius(spheres), request.surface.grid.spacing);
  return mesh;
}

// Meshes of many sets by marching cubes, all in one call of the library.
std::vector<MeshHandle> march_many(const SphereBatch& sets, const MeshCall& request,
                                   Monitor& monitor) {
  check_sets(sets);
  ExtractOptions extract;
  std::vector<GridOptions> grids;
  for (std::size_t set = 0; set < sets.set_count(); ++set) {
    const SphereSet own = SphereSet::view(sets.set(set));
    extract = extraction(request, bounding_box(own), center_bounding_box(own), monitor);
    grids.push_back(extract.grid);
  }
  extract.memory_limit = default_memory_limit();
  const BatchExtraction made =
      make_batch_extractor(request.backend)->extract({sets, grids}, extract);
  std::vector<MeshHandle> meshes;
  for (std::size_t set = 0; set < made.set_count(); ++set) {
    if (made.size(set).triangles == 0) {
      throw_too_coarse(least_radius(SphereSet::view(sets.set(set))), request.surface.grid.spacing);
    }
    meshes.push_back(handle_of(made.mesh(set), grids[set].given));
  }
  return meshes;
}

// The mesh takes memory of the device alone, so the host's sets no limit.
CudaMesh march_on_device(const DeviceFrames& balls, const MeshCall& request, Monitor& monitor) {
  RefineOptions refine = refinement(request, monitor);
  refine.memory_limit = kNoMemoryLimit;
  CudaMesh mesh =
      mesh_on_device(balls, extraction(request, balls.balls(), balls.centers(), monitor), refine);
  if (mesh.arrays().triangles == 0)
    throw_too_coarse(balls.least_radius(), request.surface.grid.spacing);
  return mesh;
}

// The atoms do not grow: the probe rolls over them.
PatchedMesh mesh_excluded_surface(const SphereSet& atoms, const MeshCall& request,
                                  Monitor& monitor) {
  const std::uint64_t limit = default_memory_limit();
  const double edge_length = request.surface.edge_length.value_or(0);
  const auto make = [&]() -> PatchedMesh {
    const RemeshOptions options = {.probe = request.probe,
                                   .edge_length = edge_length,
                                   .memory_limit = limit,
                                   .monitor = &monitor};
    if (request.surface.max_distance)
      return remesh_within(atoms, *request.surface.max_distance, options);
    if (request.surface.remeshed) return remesh_excluded(atoms, options);
    return mesh_excluded(atoms, {.probe = request.probe,
                                 .edge_length = edge_length,
                                 .memory_limit = limit,
                                 .monitor = &monitor});
  };
  PatchedMesh mesh = make();
  if (request.surface.subdivisions > 0) {
    mesh = std::move(refine_patches(atoms, std::move(mesh),
                                    {.subdivisions = request.surface.subdivisions,
                                     .memory_limit = limit,
                                     .monitor = &monitor})
                         .mesh);
  }
  if (!request.normals) mesh.mesh.normals = {};
  return mesh;
}

MeshHandle mesh(const py::buffer& coords, const py::buffer& radii, std::optional<int> threads,
                const py::kwargs& given) {
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  const MeshCall request(given);
  if (request.is_excluded()) {
    return handle_of(call(threads, [&](Monitor& monitor) {
      return mesh_excluded_surface(spheres_of(centers, sizes, 0), request, monitor);
    }));
  }
  return call(threads, [&](Monitor& monitor) {
    const SphereSet spheres = spheres_of(centers, sizes, request.probe);
    std::optional<GridSpec> grid;
    IndexedMesh mesh = request.is_exact() ? mesh_exactly(spheres, request, monitor)
                                          : march(spheres, request, monitor, grid);
    if (!request.normals) mesh.normals = {};
    return handle_of(std::move(mesh), grid);
  });
}

// Meshes of sets that stand one after another: set i has the rows from offsets[i] on.
std::vector<MeshHandle> mesh_many(const py::buffer& coords, const py::buffer& radii,
                                  const std::vector<std::size_t>& offsets,
                                  std::optional<int> threads, const py::kwargs& given) {
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  const MeshCall request(given);
  return call(threads, [&](Monitor& monitor) {
    const SphereSet spheres = spheres_of(centers, sizes, request.probe);
    const std::span<const Sphere> all = spheres.spheres();
    return march_many({.spheres = all.data(), .size = all.size(), .offsets = offsets}, request,
                      monitor);
  });
}

// The same for coordinates (1, N, 3) in device memory, where the mesh stays.
CudaMeshHandle mesh_there(const py::tuple& coords, const py::object& radii,
                          std::optional<int> threads, const py::kwargs& given) {
  const MeshCall request(given);
  if (request.is_excluded()) {
    throw BackendUnavailable("surface: the excluded surface is meshed on the CPU");
  }
  const DeviceFrames balls = frames_of(coords, radii, 1, request.probe);
  require_valid(balls);
  CudaMesh mesh = call(threads, [&](Monitor& monitor) {
    if (!request.is_exact()) return march_on_device(balls, request, monitor);
    return exact_mesh_on_device(balls, exact_options(request, monitor),
                                refinement(request, monitor))
        .mesh;
  });
  return {std::move(mesh), request.normals};
}

void require_faces(const IndexedMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const std::uint32_t largest = std::ranges::max(mesh.triangles[t]);
    if (largest < mesh.vertex_count()) continue;
    throw InvalidInput(fmt::format("faces[{}]: names vertex {}, but there are {} vertices", t,
                                   largest, mesh.vertex_count()));
  }
}

// A copy of the arrays: vertices (V, 3) and the 3 F vertex numbers of the faces.
MeshHandle mesh_of_arrays(const py::buffer& vertices, const py::buffer& corners) {
  const Numbers rows(vertices, "vertices", 2);
  IndexedMesh mesh;
  const std::vector<Vec3d> points = points_of(rows);
  mesh.positions.assign(points.begin(), points.end());
  const std::vector<SphereId> numbers = ids_of(corners);
  mesh.triangles.resize(numbers.size() / 3);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    mesh.triangles[t] = {numbers[3 * t], numbers[3 * t + 1], numbers[3 * t + 2]};
  }
  require_faces(mesh);
  return handle_of(std::move(mesh));
}

Array vertices(const MeshHandle& h) {
  const auto* first = reinterpret_cast<const double*>(h.mesh->positions.data());
  return array_of(h.mesh, first, h.mesh->vertex_count(), 3);
}

Array faces(const MeshHandle& h) {
  const auto* first = reinterpret_cast<const std::uint32_t*>(h.mesh->triangles.data());
  return array_of(h.mesh, first, h.mesh->triangle_count(), 3);
}

std::optional<Array> normals(const MeshHandle& h) {
  if (h.mesh->normals.empty()) return std::nullopt;
  return array_of(h.mesh, &h.mesh->normals.data()->x, h.mesh->vertex_count(), 3);
}

std::optional<Array> labels(const MeshHandle& h, const Buffer<SphereId>& ids) {
  if (ids.empty()) return std::nullopt;
  return array_of(h.mesh, ids.data(), ids.size());
}

// None for a mesh without patches, as are those of the functions that follow.
std::optional<Array> face_patches(const MeshHandle& h) {
  if (!h.patched) return std::nullopt;
  return array_of(h.patched, h.patched->triangle_patch.data(), h.patched->triangle_patch.size());
}

std::optional<Array> patch_kinds(const MeshHandle& h) {
  if (!h.patched) return std::nullopt;
  std::vector<std::uint8_t> kinds;
  for (const SurfacePatch& patch : h.patched->patches) {
    kinds.push_back(static_cast<std::uint8_t>(patch.kind));
  }
  return array_of(std::move(kinds));
}

// Rows of three, with -1 for none.
std::optional<Array> patch_atoms(const MeshHandle& h) {
  if (!h.patched) return std::nullopt;
  auto atoms = std::make_shared<std::vector<std::int32_t>>();
  for (const SurfacePatch& patch : h.patched->patches) {
    for (const SphereId id : patch.atoms) {
      atoms->push_back(id == kNoSphere ? -1 : static_cast<std::int32_t>(id));
    }
  }
  const std::int32_t* values = atoms->data();
  return array_of(std::move(atoms), values, h.patched->patches.size(), 3);
}

// Mean and Gaussian curvature by vertex.
std::optional<py::tuple> curvatures(const MeshHandle& h) {
  if (!h.patched) return std::nullopt;
  VertexCurvatures found = vertex_curvatures(*h.patched);
  return py::make_tuple(array_of(std::move(found.mean)), array_of(std::move(found.gaussian)));
}

// An array of a mesh in device memory, as are those of all functions whose name ends so.
CudaArray there(const CudaMesh& mesh, const auto* values, std::size_t rows, std::size_t columns) {
  const auto owner = std::make_shared<const CudaMesh>(mesh);
  return {array_of(owner, values, rows, columns), mesh.arrays().device};
}

CudaArray vertices_there(const CudaMeshHandle& h) {
  const CudaMeshArrays& arrays = h.mesh.arrays();
  return there(h.mesh, reinterpret_cast<const double*>(arrays.positions), arrays.vertices, 3);
}

CudaArray faces_there(const CudaMeshHandle& h) {
  return there(h.mesh, h.mesh.arrays().corners, h.mesh.arrays().triangles, 3);
}

std::optional<CudaArray> normals_there(const CudaMeshHandle& h) {
  const CudaMeshArrays& arrays = h.mesh.arrays();
  if (!h.has_normals) return std::nullopt;
  return there(h.mesh, reinterpret_cast<const float*>(arrays.normals), arrays.vertices, 3);
}

CudaArray vertex_atoms_there(const CudaMeshHandle& h) {
  return there(h.mesh, h.mesh.arrays().atoms, h.mesh.arrays().vertices, 0);
}

// Of the crease-exact mesher.
std::optional<CudaArray> face_atoms_there(const CudaMeshHandle& h) {
  const CudaMeshArrays& arrays = h.mesh.arrays();
  if (arrays.triangle_atoms == nullptr) return std::nullopt;
  return there(h.mesh, arrays.triangle_atoms, arrays.triangles, 0);
}

MeshHandle downloaded(const CudaMeshHandle& h) {
  const py::gil_scoped_release free;
  IndexedMesh mesh = h.mesh.download();
  if (!h.has_normals) mesh.normals = {};
  return handle_of(std::move(mesh));
}

std::vector<std::string> save(const MeshHandle& h, const std::string& path, bool ascii,
                              double scale) {
  const MeshFormat format = mesh_format(path);  // an unknown extension is told before any work
  if (ascii && format != MeshFormat::ply && format != MeshFormat::stl)
    throw InvalidInput("ascii: is of .ply and .stl files; the others have one form");
  const MeshEncoding encoding = ascii ? MeshEncoding::text : MeshEncoding::binary;
  return call({}, [&](Monitor& monitor) {
    return h.patched ? write_mesh(*h.patched, path, {}, &monitor, encoding, scale)
                     : write_mesh(*h.mesh, path, {}, &monitor, encoding, scale);
  });
}

}  // namespace

void bind_meshes(py::module_& module) {
  module.def("mesh", &mesh);
  module.def("mesh_many", &mesh_many);
  module.def("mesh_on_device", &mesh_there);
  module.def("mesh_of_arrays", &mesh_of_arrays);
  py::class_<CudaMeshHandle>(module, "CudaMeshHandle")
      .def("vertices", &vertices_there)
      .def("faces", &faces_there)
      .def("normals", &normals_there)
      .def("vertex_atoms", &vertex_atoms_there)
      .def("face_atoms", &face_atoms_there)
      .def("download", &downloaded);
  py::class_<MeshHandle>(module, "MeshHandle")
      .def(py::pickle(&pickled, &unpickled))
      .def("vertices", &vertices)
      .def("faces", &faces)
      .def("normals", &normals)
      .def("vertex_atoms",
           [](const MeshHandle& h) { return labels(h, h.mesh->vertex_spheres.atoms); })
      .def("face_atoms", [](const MeshHandle& h) { return labels(h, h.mesh->triangle_spheres); })
      .def("face_patches", &face_patches)
      .def("patch_kinds", &patch_kinds)
      .def("patch_atoms", &patch_atoms)
      .def("curvatures", &curvatures)
      .def("save", &save);
}

}  // namespace vdwmesh::python
