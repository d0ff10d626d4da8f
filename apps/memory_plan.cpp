// Estimates the memory that each stage of a run takes from what is known before it: atoms, the area
// of the surface, the spacing. A run that would take more than is allowed is refused before it
// begins, and the message names options with which it would fit, each tried by the same estimate,
// which is mostly 1.0 to 1.25 times what is taken, and up to 1.5 (docs/notes/robustness.md).
#include "memory_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/errors.hpp"
#include "extract/area_estimate.hpp"
#include "refine/crossings/preparation.hpp"

namespace vdwmesh::apps {
namespace {

constexpr std::uint64_t kProgram = std::uint64_t{19} << 20;  // itself, libraries, threads
constexpr std::uint64_t kReading = 1250;                     // bytes per atom, at the most
constexpr std::uint64_t kBytesPerAtom = 450;                 // atoms, names, spheres, cell lists
constexpr double kRefineSlack = 1.15;  // of refine_bytes(): what the allocator holds on to

// Edges of a cubic grid that a surface crosses, per area and spacing², for directions at
// random: 1.5 vertices, and twice as many triangles.
constexpr double kTrianglesPerCell = 3.0;
// Of the crease-exact mesher: equilateral ones, and per Å² those that arcs and corners take,
// however long the edges; of balls larger than atoms no more than so many per ball.
constexpr double kTrianglesPerPatch = 2.4, kTrianglesOfArcs = 3.5, kTrianglesOfBall = 256;
// Of the mesher of the excluded surface: per Å² those that its many short curves take. Edges of 3 Å
// gave 14 to 30.4, the most of a capsid without hydrogens.
constexpr double kTrianglesOfCurves = 32;
// remesh_excluded() makes the exact mesh with edges of this share.
constexpr double kExactShareOfRemeshed = 0.9;
// By what factor a bound on the angles adds triangles, at most.
constexpr double kMoreForAngles = 1.3;
// Of a mesh in a page, per triangle: its arrays as bytes, packed, as text, and in the page.
constexpr std::uint64_t kPageBytes = 160;
constexpr std::uint64_t kPatchSlack = 32;  // bytes per triangle held by arrays that grew

// The number of triangles before any of them is made, from the area of the surface and the size of
// a cell or edge.
MeshSize first_level(const MemoryDemand& d) {
  const SurfaceOptions& surface = *d.surface;
  const bool exact = surface.mesher == Mesher::exact;
  double step = exact ? surface.edge_length.value() : surface.grid.spacing;
  // Such a mesh is made of one along the curves, which has shorter edges.
  if (surface.remeshed) step = std::min(kExactShareOfRemeshed * step, kLongestAlongCurves);
  const double by_area = (exact ? kTrianglesPerPatch : kTrianglesPerCell) * d.area / (step * step);
  const double of_arcs =
      surface.kind == ExactSurface::excluded
          ? kTrianglesOfCurves * d.area
          : std::min(kTrianglesOfArcs * d.area, kTrianglesOfBall * static_cast<double>(d.spheres));
  const double factor = surface.min_angle ? kMoreForAngles : 1;
  const double most = std::ldexp(1e16, -2 * surface.subdivisions);  // in bytes it fits 64 bits
  const auto triangles =
      static_cast<std::uint64_t>(std::min(factor * (by_area + (exact ? of_arcs : 0)), most));
  return {triangles / 2, triangles};
}

TriangleLabels labels_of(const MemoryDemand& d) {
  return d.surface && d.surface->mesher == Mesher::exact ? TriangleLabels::spheres
                                                         : TriangleLabels::none;
}

// Bytes per triangle that arrays hold beside what they are filled with. The patches of the excluded
// surface are smaller, and each has arrays of its own until they are joined.
std::uint64_t patch_slack(const MemoryDemand& d) {
  const bool excluded = d.surface && d.surface->kind == ExactSurface::excluded;
  return excluded ? 2 * kPatchSlack : kPatchSlack;
}

// What a refinement of the mesh will make. That of the excluded surface leaves nothing out.
RefineOptions refinement_of(const MemoryDemand& d) {
  RefineOptions refine;
  refine.subdivisions = d.surface->subdivisions;
  if (d.surface->kind == ExactSurface::excluded) return refine;
  refine.normals = d.normals;
  refine.half_edges_up_to = d.half_edges_up_to;
  return refine;
}

// As the arrays will be laid out, where the mesher of patches grows its arrays as it goes. After a
// refinement, half-edges and normals count also where it has not made them because nobody reads
// them: the stages behind it do not find room for all their arrays in what it has freed.
std::uint64_t mesh_bytes(const MemoryDemand& d, const MeshSize& m) {
  if (d.mesh_bytes) return *d.mesh_bytes;
  const bool refined = d.surface && d.surface->subdivisions > 0;
  const bool by_patches = labels_of(d) == TriangleLabels::spheres;
  const bool grown = by_patches && !refined;
  return indexed_mesh_bytes(m, {.connectivity = refined ? Connectivity::half_edges : d.connectivity,
                                .labels = labels_of(d),
                                .normals = refined || by_patches ? Normals::gradients : d.normals,
                                .width = d.surface ? label_width(*d.surface) : LabelWidth::three}) +
         (grown ? patch_slack(d) * m.triangles : 0);
}

// Goes through the stages in their order and keeps the one that takes the most, with what is held
// while it runs.
class Estimate {
 public:
  explicit Estimate(const MemoryDemand& demand) : d_(demand) {}

  MemoryNeed run() {
    take("read", d_.spheres * (kReading - kBytesPerAtom));
    MeshSize mesh = d_.mesh;
    if (d_.surface && mesh.triangles == 0) mesh = make();
    need_.triangles = mesh.triangles;
    const std::uint64_t held = mesh.triangles > 0 ? mesh_bytes(d_, mesh) : 0;
    if (mesh.triangles > 0 && d_.measures == Switch::on) {
      look_at(mesh, held + beside_measures(mesh));
    }
    if (d_.page == Switch::on) take("page", held + kPageBytes * mesh.triangles);
    if (d_.exact) take("exact union", held + union_bytes(d_.spheres, *d_.exact, d_.exposed));
    if (d_.distances == Switch::on) {
      take("distances", held + union_result() + distances_bytes(mesh, d_.spheres));
    }
    return std::move(need_);
  }

 private:
  // Extraction and refinement; the finished mesh.
  MeshSize make() {
    MeshSize mesh = first_level(d_);
    const int levels = d_.surface->subdivisions;
    const std::uint64_t patches = labels_of(d_) == TriangleLabels::spheres
                                      ? (8 + patch_slack(d_)) * mesh.triangles +
                                            union_bytes(d_.spheres, UnionMethod::cgal, d_.exposed)
                                      : mesh.triangles / 4;  // bricks: their counts and sums
    if (d_.backend == Backend::cpu) take("extract", mesh_bytes(d_, mesh) + patches);
    if (levels > 0 && d_.backend == Backend::cpu) {
      const std::uint64_t bytes = refine_bytes(mesh, d_.spheres, refinement_of(d_), labels_of(d_));
      take("refine", static_cast<std::uint64_t>(kRefineSlack * static_cast<double>(bytes)));
    }
    mesh = subdivided(mesh, levels);
    take("mesh", mesh_bytes(d_, mesh) + beside_mesh());
    return mesh;
  }

  // Of the exact union, while a device makes the mesh.
  std::uint64_t beside_mesh() const {
    return d_.beside == Switch::on && d_.exact ? union_bytes(d_.spheres, *d_.exact, d_.exposed) : 0;
  }
  // Of the exact union that is there already, and of the distances, while the mesh is measured. If
  // the device has too little memory for them, the CPU measures them.
  std::uint64_t beside_measures(const MeshSize& mesh) const {
    if (d_.beside != Switch::on) return 0;
    const bool distances = d_.distances == Switch::on;
    return union_result() + (distances ? distances_bytes(mesh, d_.spheres) : 0);
  }

  // Stages that look at the finished mesh, one after the other, which is why their needs do not add
  // up.
  void look_at(const MeshSize& mesh, std::uint64_t held) {
    const std::uint64_t measures = d_.surface ? measures_bytes(mesh) : measures_of_soup_bytes(mesh);
    take("measure", held + measures);
    if (d_.self_intersections == SelfIntersections::count) {
      take("self-intersections", held + self_intersections_bytes(mesh));
    }
    if (checks_with_cgal(d_.cgal_check, mesh.triangles)) {
      take("check by CGAL", held + surface_mesh_bytes(mesh, d_.connectivity));
    }
  }

  std::uint64_t union_result() const { return d_.exact ? d_.spheres * sizeof(SphereMeasures) : 0; }

  void take(const char* stage, std::uint64_t bytes) {
    bytes += kProgram + kBytesPerAtom * d_.spheres;
    if (bytes <= need_.bytes) return;
    need_.bytes = bytes;
    need_.stage = stage;
  }

  const MemoryDemand& d_;
  MemoryNeed need_;
};

bool fits(const MemoryDemand& demand, std::uint64_t limit) {
  return estimate_memory(demand).bytes <= limit;
}

// The demand as it would be with another size of the cells or triangles.
MemoryDemand scaled(MemoryDemand d, double factor) {
  d.surface->grid.spacing *= factor;
  if (d.surface->edge_length) *d.surface->edge_length *= factor;
  const double shrunk = 1 / (factor * factor);
  d.mesh = {static_cast<std::uint64_t>(static_cast<double>(d.mesh.vertices) * shrunk),
            static_cast<std::uint64_t>(static_cast<double>(d.mesh.triangles) * shrunk)};
  return d;
}

// Each level fewer is a quarter of the triangles.
MemoryDemand with_subdivisions(MemoryDemand d, int levels) {
  for (int l = d.surface->subdivisions; l > levels; --l) {
    d.mesh = {d.mesh.vertices / 4, d.mesh.triangles / 4};
  }
  d.surface->subdivisions = levels;
  return d;
}

// Tries ever larger steps until one fits, so that what the message names is about the finest that
// would do.
std::optional<std::string> fitting_step(const MemoryDemand& demand, std::uint64_t limit) {
  constexpr double kGrain = 1.05, kWidest = 1e12;  // Å
  const bool exact = demand.surface->mesher == Mesher::exact;
  const double step = exact ? demand.surface->edge_length.value() : demand.surface->grid.spacing;
  for (double factor = kGrain; step * factor < kWidest; factor *= kGrain) {
    if (!fits(scaled(demand, factor), limit)) continue;
    if (!demand.surface->edge_lengths.empty()) {
      return fmt::format("edge lengths {:.2f} times as long", factor);
    }
    return fmt::format("{} {:.2g}", exact ? "--edge-length" : "--spacing",
                       std::ceil(step * factor * 100) / 100);
  }
  return std::nullopt;
}

// How many triangles of a page would fit.
std::optional<std::string> fitting_triangles(const MemoryDemand& demand, std::uint64_t limit) {
  constexpr double kGrain = 1.05, kMost = 10;
  for (double factor = kGrain; factor < kMost; factor *= kGrain) {
    const MemoryDemand less = scaled(demand, factor);
    if (fits(less, limit)) return fmt::format("--page-triangles {}", first_level(less).triangles);
  }
  return std::nullopt;
}

// The most levels that fit.
std::optional<std::string> fitting_subdivisions(const MemoryDemand& demand, std::uint64_t limit) {
  for (int levels = demand.surface->subdivisions - 1; levels >= 0; --levels) {
    if (fits(with_subdivisions(demand, levels), limit)) {
      return fmt::format("--subdivide {}", levels);
    }
  }
  return std::nullopt;
}

// In the largest unit of which there is at least a hundredth.
std::string amount(std::uint64_t bytes) {
  const double count = static_cast<double>(bytes);
  if (count >= 0.01 * 0x1p30) return fmt::format("{:.3g} GiB", count / 0x1p30);
  if (count >= 0.01 * 0x1p20) return fmt::format("{:.3g} MiB", count / 0x1p20);
  return fmt::format("{} bytes", bytes);
}

// "--spacing 0.7, --subdivide 0 or --memory-limit 32G", with what would fit.
std::string remedies(const MemoryDemand& demand, std::uint64_t need, std::uint64_t limit) {
  std::string list;
  const auto add = [&](const std::optional<std::string>& remedy) {
    if (remedy) list += *remedy + ", ";
  };
  const bool of_page = demand.page == Switch::on;  // whose verb has no other options of these
  if (demand.surface && of_page) add(fitting_triangles(demand, limit));
  if (demand.surface && !of_page) {
    add(fitting_step(demand, limit));
    add(fitting_subdivisions(demand, limit));
  }
  const auto add_without = [&](const char* option, auto change) {
    MemoryDemand less = demand;
    change(less);
    if (!of_page && fits(less, limit)) add(option);
  };
  add_without("--distances off", [](MemoryDemand& d) { d.distances = Switch::off; });
  add_without("--topology off", [](MemoryDemand& d) {
    if (d.exact) d.exact = UnionMethod::arcs;
  });
  add_without("--cgal-check off", [](MemoryDemand& d) { d.cgal_check = CgalCheck::skip; });
  constexpr std::uint64_t kNobodyHas = std::uint64_t{1} << 46;
  if (need < kNobodyHas) {
    list += fmt::format("{}--memory-limit {}M, ", list.empty() ? "" : "or ", (need >> 20) + 1);
  }
  if (list.empty()) return "there is no setting that fits";
  return list.substr(0, list.size() - 2) + " would do";
}

// Of the surface that is meshed, Å².
double area_of_surface(const SphereSet& spheres, const MemoryDemand& demand, double of_union) {
  if (!demand.surface || demand.surface->mesher == Mesher::exact ||
      demand.surface->field.kind == FieldKind::vdw) {
    return of_union;
  }
  const GridSpec grid = make_grid(spheres, demand.surface->grid);
  return estimate_area(spheres, make_field_model(demand.surface->field, grid));
}

// The edge length that would make as many triangles if all spheres had it and were exposed whole.
double equivalent_edge_length(const SphereSet& spheres, const std::vector<double>& lengths) {
  double areas = 0, triangles = 0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const double r = spheres[i].radius;
    areas += r * r, triangles += r * r / (lengths[i] * lengths[i]);
  }
  return std::sqrt(areas / triangles);
}

// The area is known well enough without a mesh, from points on a sample of the spheres.
void fill_in(const SphereSet& spheres, MemoryDemand& demand) {
  double all = 0;  // Å²
  for (const Sphere& s : spheres.spheres()) all += 4 * std::numbers::pi * s.radius * s.radius;
  demand.spheres = spheres.size();
  const double of_union = estimate_area(spheres);
  if (demand.surface && !demand.surface->edge_lengths.empty()) {
    demand.surface->edge_length = equivalent_edge_length(spheres, demand.surface->edge_lengths);
  }
  demand.exposed = of_union / all;
  demand.area = area_of_surface(spheres, demand, of_union);
}

// What a run without a mesh takes at most, which it does if nothing of the spheres is exposed;
// nothing if that is more than the limit. To estimate the exposed part takes longer than to measure
// the union by arcs.
std::optional<std::uint64_t> bytes_if_all_buried(MemoryDemand demand, std::uint64_t spheres,
                                                 std::uint64_t limit) {
  if (demand.surface) return std::nullopt;
  demand.spheres = spheres;
  demand.exposed = 0;
  const std::uint64_t bytes = estimate_memory(demand).bytes;
  return bytes <= limit ? std::optional(bytes) : std::nullopt;
}

}  // namespace

LabelWidth label_width(const SurfaceOptions& surface) {
  const bool names_creases = surface.mesher == Mesher::exact || surface.subdivisions > 0;
  return names_creases ? LabelWidth::three : LabelWidth::one;
}

MemoryNeed estimate_memory(const MemoryDemand& demand) { return Estimate(demand).run(); }

std::uint64_t check_memory(const MemoryDemand& demand, std::uint64_t limit) {
  const MemoryNeed need = estimate_memory(demand);
  if (need.bytes <= limit) return need.bytes;
  const std::string mesh =
      need.triangles > 0 ? fmt::format(" for a mesh of {}{} triangles",
                                       demand.mesh.triangles > 0 ? "" : "about ", need.triangles)
                         : "";
  throw LimitExceeded(fmt::format("the stage \"{}\" needs {} of memory{}, {} are allowed: {}",
                                  need.stage, amount(need.bytes), mesh, amount(limit),
                                  remedies(demand, need.bytes, limit)));
}

std::uint64_t check_memory_before(MemoryDemand& demand, const SphereSet& spheres,
                                  std::uint64_t limit) {
  if (const auto bytes = bytes_if_all_buried(demand, spheres.size(), limit)) return *bytes;
  fill_in(spheres, demand);
  if (demand.beside == Switch::on && !fits(demand, limit)) demand.beside = Switch::off;
  return check_memory(demand, limit);
}

SurfaceOptions with_few_triangles(const SurfaceOptions& surface, const SphereSet& spheres,
                                  std::uint64_t most_triangles) {
  constexpr double kGrain = 1.05, kLongest = 1.4;  // Å
  MemoryDemand demand;
  demand.surface = surface;
  fill_in(spheres, demand);
  while (first_level(demand).triangles > most_triangles) {
    if (demand.surface->mesher == Mesher::exact && demand.surface->edge_length > kLongest) {
      demand.surface->mesher = Mesher::marching_cubes;
      demand.surface->grid.spacing = surface.edge_length.value();
    }
    demand = scaled(demand, kGrain);
  }
  return *demand.surface;
}

void check_memory_after(MemoryDemand& demand, const SphereSet& spheres, const IndexedMesh& mesh,
                        std::uint64_t limit) {
  if (demand.spheres == 0) fill_in(spheres, demand);
  demand.mesh = {mesh.vertex_count(), mesh.triangle_count()};
  if (!demand.surface) demand.mesh_bytes = indexed_mesh_bytes(mesh);
  if (demand.beside == Switch::on && !fits(demand, limit)) demand.beside = Switch::off;
  check_memory(demand, limit);
}

}  // namespace vdwmesh::apps
