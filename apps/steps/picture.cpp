// Paints meshes and has them drawn. Colours are values at triangles or vertices, with a scale that
// shows all but one in a hundred of them; the renderer knows nothing of molecules or distances.
#include "steps/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "analysis/mesh_measures.hpp"
#include "cuda/backend.hpp"
#include "render/crease_split.hpp"
#include "report/output.hpp"
#include "request/refuse.hpp"
#include "steps/atom_colors.hpp"
#include "steps/exact_steps.hpp"
#include "steps/stopwatch.hpp"
#include "structure/reference_areas.hpp"

namespace vdwmesh::apps {
namespace {

// Share of the values that a colour map shows in full; the rest have the colours of its ends.
constexpr double kInside = 0.99;

// Contact, saddle and concave patches: colours that people with colour-blindness tell apart, after
// Okabe and Ito (2008), made lighter.
constexpr std::array<Rgb, kPatchKinds> kKindColors = {
    Rgb{0.55f, 0.75f, 0.90f}, Rgb{0.95f, 0.75f, 0.30f}, Rgb{0.80f, 0.47f, 0.65f}};

// What was asked for comes before what suits the values.
ColorScale scale_for(const std::vector<float>& values, ColorMap map, const ColorRange& range,
                     const std::string& title, const PictureOptions& options) {
  const ColorRange bounds = options.range.value_or(range);
  ColorScale scale{options.color_map.value_or(map), bounds.lower, bounds.upper, title};
  scale.tails = find_tails(scale, values);
  return scale;
}

std::uint64_t left_of(std::uint64_t limit, std::uint64_t taken) {
  return limit > taken ? limit - taken : 0;
}

PictureReport report_of(const PictureOptions& options, const MeshSource& source,
                        const std::string& device) {
  const ColorScale* scale = source.scale();
  return {options.path,
          options.view,
          device,
          options.render.width,
          options.render.height,
          source.triangle_count(),
          scale ? std::optional(*scale) : std::nullopt};
}

// Calls visit(v, patch) for the corners of all triangles. Every vertex of `shown`, which
// split_at_patches() made of the mesh, belongs to one patch.
template <class Visit>
void visit_corners(const IndexedMesh& shown, const PatchedMesh& mesh, const Visit& visit) {
  for (std::size_t t = 0; t < shown.triangle_count(); ++t) {
    const SurfacePatch& patch = mesh.patches[mesh.triangle_patch[t]];
    for (const std::uint32_t v : shown.triangles[t]) visit(v, patch);
  }
}

VertexColors paint_by_kind(const IndexedMesh& shown, const PatchedMesh& mesh) {
  VertexColors paint;
  paint.colors.resize(shown.vertex_count());
  visit_corners(shown, mesh, [&](std::uint32_t v, const SurfacePatch& patch) {
    paint.colors[v] = kKindColors.at(static_cast<std::size_t>(patch.kind));
  });
  return paint;
}

// The scale is that of the spheres, which are most of the surface. The few thin saddles curve
// hundreds of times as much, and have many vertices. In cusps they curve infinitely, which cannot
// be interpolated, so values end at the bounds of the scale.
VertexValues paint_by_curvature(const IndexedMesh& shown, const PatchedMesh& mesh,
                                const PictureOptions& options) {
  const bool is_mean = options.color == ColorBy::mean_curvature;
  const auto curvature = [&](const SurfacePatch& patch, const Vec3d& p) {
    const PrincipalCurvatures c = patch_curvatures(patch, p);
    return static_cast<float>(is_mean ? c.mean() : c.gaussian());
  };
  std::vector<float> values(shown.vertex_count()), of_spheres;
  visit_corners(shown, mesh, [&](std::uint32_t v, const SurfacePatch& patch) {
    values[v] = curvature(patch, shown.positions[v]);
  });
  for (const SurfacePatch& patch : mesh.patches) {
    if (patch.kind != PatchKind::saddle) of_spheres.push_back(curvature(patch, patch.center));
  }
  const double bound = symmetric_bound(of_spheres, 1);
  ColorScale scale = scale_for(values, ColorMap::cool_warm, {-bound, bound},
                               is_mean ? "Mean curvature, 1/Å (positive: convex)"
                                       : "Gaussian curvature, 1/Å² (negative: saddle-shaped)",
                               options);
  for (float& value : values) {
    value = std::clamp(value, static_cast<float>(scale.lower), static_cast<float>(scale.upper));
  }
  return {std::move(values), std::move(scale)};
}

// From 0 on, unless some are negative.
ColorScale scale_of_b_factors(const std::vector<float>& values, const PictureOptions& options) {
  const double bound = symmetric_bound(values, kInside);
  const bool has_negative = std::ranges::any_of(values, [](float b) { return b < 0; });
  return scale_for(values, has_negative ? ColorMap::cool_warm : ColorMap::viridis,
                   {has_negative ? -bound : 0, bound}, "B factor of each atom", options);
}

}  // namespace

void check_references(const PictureOptions& options, const Molecule& molecule) {
  refuse_if(options.color == ColorBy::exposure && !reference_areas(molecule.radius_set, "LEU"),
            "--color exposure: extended residues are known for three sets of radii; add --radii "
            "protor (or naccess, oons)");
}

Paint paint_by_atom(const IndexedMesh& mesh, const Molecule& molecule,
                    const PictureOptions& options, Session& session) {
  const ColorBy color = options.color.value_or(ColorBy::element);
  const auto of_vertices = [&mesh](const auto& of_atoms, auto& vertices) {
    vertices.resize(mesh.vertex_count());
    std::ranges::transform(mesh.vertex_spheres.atoms, vertices.begin(),
                           [&](SphereId atom) { return of_atoms.at(atom); });
  };
  VertexValues values;
  if (color == ColorBy::hydropathy) {
    of_vertices(atom_hydropathies(molecule), values.values);
    values.scale = scale_for(values.values, ColorMap::cool_warm, {-4.5, 4.5},
                             "Hydropathy, Kyte-Doolittle (positive: hydrophobic)", options);
    return values;
  }
  if (color == ColorBy::exposure) {
    of_vertices(atom_exposures(molecule, session.monitor), values.values);
    values.scale = scale_for(values.values, ColorMap::viridis, {0, 100},
                             "Exposure of the residue, % of an extended one", options);
    return values;
  }
  if (color == ColorBy::b_factor) {
    of_vertices(atom_b_factors(molecule), values.values);
    values.scale = scale_of_b_factors(values.values, options);
    return values;
  }
  const AtomColors atoms = color == ColorBy::chain     ? colors_of_chains(molecule)
                           : color == ColorBy::residue ? colors_of_residues(molecule)
                                                       : colors_of_elements(molecule);
  if (!atoms.key.empty()) session.report.note("colours: {}", atoms.key);
  VertexColors paint;
  of_vertices(atoms.colors, paint.colors);
  return paint;
}

Paint paint_by_distance(const IndexedMesh& mesh, const SphereSet& spheres,
                        const PictureOptions& options, Session& session) {
  std::vector<float> values = measure_centers(mesh, spheres, session);
  const double bound = symmetric_bound(values, kInside);
  ColorScale scale =
      scale_for(values, ColorMap::cool_warm, {-bound, bound},
                "Triangle centres to the exact surface, Å (positive: outside)", options);
  return TriangleValues{std::move(values), std::move(scale)};
}

Paint paint_by_patch(const IndexedMesh& shown, const PatchedMesh& mesh,
                     const PictureOptions& options) {
  return options.color == ColorBy::kind ? Paint(paint_by_kind(shown, mesh))
                                        : Paint(paint_by_curvature(shown, mesh, options));
}

Paint paint_by_angle(const IndexedMesh& mesh, const PictureOptions& options) {
  std::vector<float> values = min_angles_deg(mesh);
  constexpr ColorRange kPossible{0, 60};
  ColorScale scale = scale_for(values, ColorMap::viridis, kPossible,
                               "Smallest angle of each triangle, degrees", options);
  return TriangleValues{std::move(values), std::move(scale)};
}

void draw_mesh(const IndexedMesh& mesh, const Painter& painter, const PictureOptions& options,
               Session& session) {
  Paint paint = painter(mesh);
  begin_stage(session.monitor, "picture", 1);
  Report& report = session.report;
  const Backend backend = report.backend ? report.backend->used : resolve(session.machine.backend);
  const Renderer renderer;
  MeshSource source(mesh, std::move(paint));
  RenderOptions render = options.render;
  if (options.ambient_occlusion) {
    source.shade();
    render.material = kSkyLight;
  }
  render.memory_limit = left_of(session.machine.memory_limit, indexed_mesh_bytes(mesh));
  if (backend == Backend::cuda) release_device_memory();  // OpenGL needs it now
  write_file(options.path, encode_png(renderer.draw(source, render)));
  report.picture = report_of(options, source, renderer.device());
  session.end_stage(&Timing::picture);
  advance(session.monitor, 1);
}

void draw_surface(const IndexedMesh& mesh, const SphereSet& spheres, const Painter& painter,
                  const PictureOptions& options, Session& session) {
  IndexedMesh split;
  if (mesh.triangle_labels() != TriangleLabels::none) split = split_at_creases(mesh, spheres);
  draw_mesh(split.triangles.empty() ? mesh : split, painter, options, session);
}

void draw_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                    const PictureOptions& options, Session& session) {
  const auto painter = [&](const IndexedMesh& shown) {
    return paint_by_distance(shown, spheres, options, session);
  };
  draw_surface(mesh, spheres, painter, options, session);
}

}  // namespace vdwmesh::apps
