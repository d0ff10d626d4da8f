// Marching cubes and a refinement of any balls, with any of the fields.
#include <algorithm>

#include "extract/extractor.hpp"
#include "fuzz/extraction_promises.hpp"
#include "fuzz/sphere_maker.hpp"
#include "refine/refiner.hpp"

namespace vdwmesh::fuzz {
namespace {

constexpr int kMostSpheres = 40;
constexpr double kMostCells = 20;  // along the longest side, so that an input takes milliseconds

double longest_side(const SphereSet& spheres) {
  const Box box = bounding_box(spheres);
  const Vec3d side = box.upper - box.lower;
  return std::max({side.x, side.y, side.z});
}

// Halves of the lattice of the balls where that is fine enough, so that nodes fall on spheres.
double choose_spacing(ByteSource& bytes, double side) {
  const double lattice = 0.25 * bytes.whole(1, 4), least = side / kMostCells;
  if (bytes.one_in(2) && lattice >= least) return lattice;
  return side / bytes.whole(2, static_cast<int>(kMostCells));
}

ExtractOptions choose_options(ByteSource& bytes, double side) {
  ExtractOptions options;
  options.grid.spacing = choose_spacing(bytes, side);
  options.field.kind = static_cast<FieldKind>(bytes.whole(0, 3));
  if (bytes.one_in(4)) options.grid.padding = options.grid.spacing * bytes.whole(0, 4);
  if (bytes.one_in(4)) options.grid.box = GridBox::centers;
  if (bytes.one_in(4)) options.grid.rounding = GridRounding::floor;
  if (bytes.one_in(2)) options.connectivity = Connectivity::half_edges;
  if (bytes.one_in(3)) options.field.preset = static_cast<FieldPreset>(bytes.whole(0, 2));
  if (bytes.one_in(4)) options.field.isovalue = bytes.real(0.01, 4);
  return options;
}

void refine(ByteSource& bytes, const SphereSet& spheres, const ExtractResult& result,
            const FieldOptions& field) {
  RefineOptions options;
  options.subdivisions = bytes.whole(0, 1);
  options.projection = static_cast<Projection>(bytes.whole(0, 2));
  if (field.kind == FieldKind::vdw && options.projection == Projection::field) return;
  options.field = field;
  options.grid = result.grid;
  check_mesh(make_cpu_refiner()->refine(spheres, result.mesh, options).mesh, spheres.size());
}

}  // namespace

void run_input(const std::uint8_t* data, std::size_t size) {
  ByteSource choices(data, std::min<std::size_t>(size, 16));
  ByteSource balls(data + std::min<std::size_t>(size, 16), size - std::min<std::size_t>(size, 16));
  const SphereSet spheres = make_spheres(balls, kMostSpheres);
  allow_refusal([&] {
    const ExtractOptions options = choose_options(choices, longest_side(spheres));
    const ExtractResult result = make_cpu_extractor()->extract(spheres, options);
    const reference::MeshFacts facts = check_mesh(result.mesh, spheres.size());
    if (has_oracle(options.field)) check_against_dense(spheres, options.field, result, facts);
    // A vertex where the border cuts the surface lies on the border.
    const bool cut = result.stats.grid_clipped > 0;
    if (options.field.kind == FieldKind::vdw && !cut) check_union_vertices(spheres, result);
    if (!result.mesh.triangles.empty() && choices.one_in(4)) {
      refine(choices, spheres, result, options.field);
    }
  });
}

}  // namespace vdwmesh::fuzz
