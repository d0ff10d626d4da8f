// mesh_excluded(): samples the curves between patches, and meshes the patches in rounds.
//
// 1. CurveComplex names all patches, curves and corners.
// 2. In each round every patch that has changed is meshed by itself, on all cores: contact and
//    concave patches by the mesher of spheres less caps, saddles by mesh_saddle(). Patches may ask
//    for pieces of their curves to be split; those beside such a piece are meshed again. First the
//    boundaries alone, then the patches.
// 3. The vertices are numbered (corners, points of curves, then patch by patch) and the patches
//    copied. The triangles of concave patches are turned over, because the surface is seen from
//    inside of the probe.
// 4. χ and the number of shells are held against those of the surface.
#include "excluded/excluded_mesher.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "core/errors.hpp"
#include "creases/plane/flat_boundary.hpp"
#include "creases/share/mesh_team.hpp"
#include "excluded/mesher/curve_complex.hpp"
#include "excluded/mesher/saddle_mesher.hpp"
#include "excluded/probes/excluded_shells.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh {
namespace {

using namespace excluded;
using MesherClock = std::chrono::steady_clock;

// Limits, as for the mesh of the union: the rounds in which pieces are split for quality; all
// rounds; and the pieces that a curve may have, and all curves together, besides 64 for each piece
// that there was at first. More pieces are asked for only if two curves are some 10⁻¹¹ of a radius
// from each other along a part of their length. Double precision hardly tells these apart, or not
// at all, so millions of pieces would be needed, or no number would suffice. In a small set the
// limit of all ends the splitting of several curves; in a large molecule that of one curve ends it.
constexpr int kRoundsForQuality = 12, kRoundsInAll = 60;
constexpr std::uint64_t kGrowth = std::uint64_t{1} << 16;
// The cosine of the widest angle, 127°, under which points inside patches may see pieces. In the
// union's mesher it is 110°. Here patches are narrow, and many have pieces of very different
// lengths on both sides, because those on one side were split for the patch beyond. Points between
// them see the longer pieces under wide angles, and without these points triangles across the strip
// are thinner than those with them (docs/excluded_surface.md).
constexpr double kWidestViewHere = -0.6;
// The triangles that an area gets, divided by the ideal number; the bytes of a triangle before the
// patches are joined.
constexpr double kFill = 1.4;
constexpr std::uint64_t kScratchBytes = 44;
// What the mesh holds beside positions, normals and triangles.
constexpr MeshArrays kArrays = {.width = LabelWidth::one};

double elapsed(MesherClock::time_point begin) {
  return std::chrono::duration<double>(MesherClock::now() - begin).count();
}

class ExcludedMesher {
 public:
  // `area`: of the surface, scaled.
  ExcludedMesher(const CurveComplex& complex, double area, const ExcludedMeshOptions& options)
      : options_(options),
        complex_(complex),
        unit_(std::ldexp(1.0, complex.grown().exponent)),
        edge_length_(options.edge_length / unit_),
        sampling_(complex.curves, std::vector<double>(complex.face_count(), edge_length_)),
        pieces_at_first_(sampling_.pieces()),
        all_at_first_(sampling_.all_pieces()),
        least_triangles_(kFill * area / (std::sqrt(0.1875) * edge_length_ * edge_length_)),
        faces_(complex.face_count()) {}

  ExcludedMesh run() && {
    check_memory();
    std::vector<std::uint32_t> all;
    for (std::uint32_t f = 0; f < faces_.size(); ++f) all.push_back(f);
    run_rounds(all, PatchStage::boundary);
    run_rounds(all, PatchStage::triangles);
    sampling_.number_vertices();
    ExcludedMesh out;
    assemble(out);
    stats_.curves = complex_.curves.arcs.size();
    stats_.pieces = sampling_.all_pieces();
    out.stats = stats_;
    return out;
  }

 private:
  // What is known of a patch between rounds, and at last its mesh. Points of the boundary come
  // first among its vertices.
  struct FaceMesh {
    std::unique_ptr<PatchProgress> progress;  // of a sphere with curves
    std::vector<CurvePoint> boundary;
    PatchVector<Vec3d> interior, normals;  // scaled, relative to the origin; unit
    PatchVector<std::array<std::uint32_t, 3>> triangles;
    PatchVector<PieceSplit> splits;
    bool coincident = false;
  };
  struct Scratch {
    PatchScratch patch;
    PlaneTriangulation plane;
  };

  bool is_sphere(std::uint32_t face) const { return face < complex_.spheres.size(); }

  static bool has_grown(std::uint64_t now, std::uint64_t at_first) {
    return now > kGrowth + 64 * at_first;
  }

  // Gives up if a curve of the pieces just split has too many pieces, or all curves together.
  void check_growth() const {
    for (const PieceSplit& s : last_splits_) {
      const std::uint32_t now = sampling_.pieces(s.piece.arc);
      if (has_grown(now, pieces_at_first_[s.piece.arc]))
        refuse(s.piece, fmt::format("by {} points on one of them", now));
    }
    if (!has_grown(sampling_.all_pieces(), all_at_first_)) return;
    const auto longest = std::max_element(
        last_splits_.begin(), last_splits_.end(), [&](const PieceSplit& a, const PieceSplit& b) {
          return sampling_.pieces(a.piece.arc) < sampling_.pieces(b.piece.arc);
        });
    refuse(longest->piece, fmt::format("by {} points on all of them", sampling_.all_pieces()));
  }

  // The number of triangles is estimated from the area, and four for each piece.
  void check_memory() const {
    const double triangles = least_triangles_ + 4 * static_cast<double>(sampling_.all_pieces());
    const auto count = static_cast<std::uint64_t>(std::min(triangles, 1e17));
    const std::uint64_t need =
        indexed_mesh_bytes({count / 2, count}, kArrays) + kScratchBytes * count;
    if (need <= options_.memory_limit && count / 2 <= kMaxVertices) return;
    throw LimitExceeded(fmt::format(
        "an edge length of {} Å needs about {} triangles and {} bytes, {} are allowed: choose a "
        "larger edge length or a higher memory limit",
        options_.edge_length, count, need, options_.memory_limit));
  }

  void run_rounds(std::vector<std::uint32_t> faces, PatchStage stage) {
    last_splits_.clear();
    for (int round = 1; !faces.empty(); ++round) {
      begin_stage(options_.monitor,
                  stage == PatchStage::boundary ? "sample curves" : "mesh patches", faces.size());
      const Demand demand = round <= kRoundsForQuality ? Demand::quality : Demand::validity;
      tbb::parallel_for(std::size_t{0}, faces.size(), [&](std::size_t i) {
        mesh_face(faces[i], demand, stage);
        advance(options_.monitor, 1);
      });
      last_splits_ = wanted_splits(faces);
      if (last_splits_.empty()) return;
      if (round == kRoundsInAll)
        refuse(last_splits_.front().piece, fmt::format("in {} rounds of splitting them", round));
      check_growth();
      stats_.split += last_splits_.size();
      sampling_.split(last_splits_);
      check_memory();
      faces = sides_of(complex_.curves, last_splits_);
    }
  }

  std::vector<PieceSplit> wanted_splits(const std::vector<std::uint32_t>& faces) const {
    std::vector<PieceSplit> splits;
    for (const std::uint32_t f : faces) {
      if (faces_[f].coincident) refuse({complex_.curves_of(f).front(), 0}, kByDoubles);
      splits.insert(splits.end(), faces_[f].splits.begin(), faces_[f].splits.end());
    }
    merge_splits(splits);
    return splits;
  }

  // Threads run this at the same time for different faces, so an error is only noted here.
  void mesh_face(std::uint32_t face, Demand demand, PatchStage stage) {
    Scratch& scratch = scratch_.local();
    try {
      if (is_sphere(face)) {
        mesh_sphere_face(face, demand, stage, scratch.patch);
      } else {
        mesh_saddle_face(face, demand, stage, scratch.plane);
      }
    } catch (const CoincidentPoints&) {
      faces_[face].coincident = true;
    }
  }

  PatchOptions options_for(double edge_length, Demand demand, PatchStage stage) const {
    return {edge_length, demand, stage, options_.monitor, kWidestViewHere};
  }

  void mesh_saddle_face(std::uint32_t face, Demand demand, PatchStage stage,
                        PlaneTriangulation& plane) {
    const SaddleFace& saddle = complex_.saddles[face - complex_.spheres.size()];
    SaddleMesh made =
        mesh_saddle(complex_, sampling_, saddle, options_for(edge_length_, demand, stage), plane);
    FaceMesh& out = faces_[face];
    out.boundary = std::move(made.boundary);
    out.interior = std::move(made.interior);
    out.normals = std::move(made.normals);
    out.triangles = std::move(made.triangles);
    out.splits = std::move(made.splits);
  }

  void mesh_sphere_face(std::uint32_t face, Demand demand, PatchStage stage,
                        PatchScratch& scratch) {
    const SphereFace& sphere = complex_.spheres[face];
    const double radius = sphere.sphere.radius;
    FaceMesh& out = faces_[face];
    if (complex_.curves_of(face).empty()) {
      PatchMesh whole = mesh_sphere(edge_length_ / radius);
      place(sphere, whole, out);
      return;
    }
    PatchProgress& progress = up_to_date(face);
    PatchMesh made =
        mesh_patch(progress, options_for(edge_length_ / radius, demand, stage), scratch);
    if (!made.triangles.empty()) {
      out.boundary = boundary_points(face, progress.boundary);
      out.progress.reset();
    }
    place(sphere, made, out);
  }

  static void place(const SphereFace& sphere, PatchMesh& made, FaceMesh& out) {
    out.normals = made.interior;
    for (Vec3d& n : out.normals) n = (sphere.concave ? -1.0 : 1.0) * n;
    out.interior = std::move(made.interior);
    for (Vec3d& u : out.interior) u = sphere.sphere.center + sphere.sphere.radius * u;
    out.triangles = std::move(made.triangles);
    out.splits = std::move(made.splits);
    for (auto& t : out.triangles) {
      if (sphere.concave) std::swap(t[1], t[2]);
    }
  }

  PatchProgress& up_to_date(std::uint32_t face) {
    const SphereFace& sphere = complex_.spheres[face];
    std::unique_ptr<PatchProgress>& progress = faces_[face].progress;
    if (progress) {
      split_pieces(complex_.curves, sampling_, sphere.sphere, face, last_splits_,
                   progress->boundary, progress->chains);
      return *progress;
    }
    progress = std::make_unique<PatchProgress>();
    gather_pieces(complex_.curves, sampling_, sphere.sphere, face, complex_.rims_of(face),
                  progress->boundary);
    progress->boundary.caps = complex_.caps_of(sphere);
    return *progress;
  }

  // The sample points that are the points of a sphere's boundary.
  std::vector<CurvePoint> boundary_points(std::uint32_t face, const PatchBoundary& boundary) const {
    std::vector<CurvePoint> points(boundary.points.size());
    for (const BoundaryPiece& p : boundary.pieces) {
      const auto [curve, k] = p.source;
      const bool backwards = complex_.curves.arcs[curve].balls[0] == face;
      points[p.from] = {curve, backwards ? k + 1 : k};
      points[p.to] = {curve, backwards ? k : k + 1};
    }
    return points;
  }

  void assemble(ExcludedMesh& out) {
    std::vector<std::uint64_t> first_vertex(faces_.size() + 1), first_triangle(faces_.size() + 1);
    first_vertex[0] = sampling_.vertex_count();
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      first_vertex[f + 1] = first_vertex[f] + faces_[f].interior.size();
      first_triangle[f + 1] = first_triangle[f] + faces_[f].triangles.size();
    }
    if (first_vertex.back() > kMaxVertices) {
      throw LimitExceeded(
          fmt::format("{} vertices; a mesh holds at most {}: choose a larger edge "
                      "length",
                      first_vertex.back(), kMaxVertices));
    }
    make_room(out.mesh, {first_vertex.back(), first_triangle.back()}, kArrays);
    for (std::uint32_t f = 0; f < faces_.size(); ++f) out.patches.push_back(patch_of(f));
    out.triangle_patch.resize(first_triangle.back());
    place_curves(out);
    tbb::parallel_for(std::size_t{0}, faces_.size(), [&](std::size_t f) {
      place_face(static_cast<std::uint32_t>(f), first_vertex[f], first_triangle[f], out);
      faces_[f] = {};
    });
  }

  // Writes a vertex (scaled, relative to the origin) of a patch.
  void set_vertex(ExcludedMesh& out, std::uint64_t vertex, const Vec3d& at, const Vec3d& normal,
                  std::uint32_t face) const {
    out.mesh.positions[vertex] = place_of(at);
    out.mesh.normals[vertex] = cast<float>(normal);
    out.mesh.vertex_spheres.set(vertex, on_sphere(nearest_atom(face, at)));
  }

  // Of the atoms of a patch the one whose sphere a point is nearest to.
  SphereId nearest_atom(std::uint32_t face, const Vec3d& at) const {
    const GrownAtoms& grown = complex_.grown();
    std::uint32_t nearest = kNoIndex;
    double least = 0;
    for (const std::uint32_t ball : balls_of(face)) {
      if (ball == kNoIndex) break;
      const double distance = norm(at - grown.surface.center(ball)) - grown.radius[ball];
      if (nearest != kNoIndex && !(distance < least)) continue;
      nearest = ball;
      least = distance;
    }
    return grown.triangulation.ids[nearest];
  }

  void place_curves(ExcludedMesh& out) {
    const BoundaryArcs& curves = complex_.curves;
    // Corners lie on the curves that end there. A curve has a face on its left.
    for (const BoundaryArc& curve : curves.arcs) {
      if (curve.is_circle()) continue;
      for (const std::uint32_t c : curve.ends) {
        set_vertex(out, c, curves.corners[c].position, complex_.normals[c], curve.balls[1]);
      }
    }
    tbb::parallel_for(std::size_t{0}, curves.arcs.size(), [&](std::size_t i) {
      const auto c = static_cast<std::uint32_t>(i);
      for (std::uint32_t k = curves.arcs[i].is_circle() ? 0 : 1; k < sampling_.pieces(c); ++k) {
        const Vec3d at = sampling_.point(c, k);
        set_vertex(out, sampling_.vertex(c, k), at, complex_.normal_on(c, at),
                   curves.arcs[i].balls[1]);
      }
    });
  }

  void place_face(std::uint32_t f, std::uint64_t first_vertex, std::uint64_t first_triangle,
                  ExcludedMesh& out) {
    const FaceMesh& face = faces_[f];
    std::vector<std::uint32_t> vertices;
    for (const CurvePoint& p : face.boundary) {
      vertices.push_back(sampling_.vertex(p.curve, p.index));
    }
    for (std::size_t i = 0; i < face.interior.size(); ++i) {
      set_vertex(out, first_vertex + i, face.interior[i], face.normals[i], f);
      vertices.push_back(static_cast<std::uint32_t>(first_vertex + i));
    }
    for (std::size_t t = 0; t < face.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        out.mesh.triangles[first_triangle + t][k] = vertices[face.triangles[t][k]];
      }
      out.triangle_patch[first_triangle + t] = f;
    }
  }

  // The first three balls that a patch is made by; kNoIndex for unused places.
  std::array<std::uint32_t, 3> balls_of(std::uint32_t f) const {
    const AccessibleSurface& surface = complex_.grown().surface;
    if (!is_sphere(f)) {
      const SaddleFace& saddle = complex_.saddles[f - complex_.spheres.size()];
      const auto& [a, b] = surface.arcs[saddle.arc].ball;
      return {a, b, kNoIndex};
    }
    const SphereFace& s = complex_.spheres[f];
    if (!s.concave) return {s.element, kNoIndex, kNoIndex};
    return surface.triangle_of(surface.probes[s.element].corner).vertices;
  }

  SurfacePatch patch_of(std::uint32_t f) const {
    SurfacePatch patch = is_sphere(f) ? sphere_patch(complex_.spheres[f])
                                      : saddle_patch(complex_.saddles[f - complex_.spheres.size()]);
    const std::array<std::uint32_t, 3> balls = balls_of(f);
    for (std::size_t k = 0; k < 3 && balls[k] != kNoIndex; ++k) {
      patch.atoms[k] = complex_.grown().triangulation.ids[balls[k]];
    }
    std::sort(patch.atoms.begin(), patch.atoms.end());
    return patch;
  }

  // From scaled and relative to the origin to Å.
  Vec3d place_of(const Vec3d& at) const { return unit_ * (at + complex_.grown().surface.origin); }

  SurfacePatch sphere_patch(const SphereFace& face) const {
    SurfacePatch patch;
    patch.kind = face.concave ? PatchKind::concave : PatchKind::contact;
    patch.radius = unit_ * face.sphere.radius;
    patch.center = place_of(face.sphere.center);
    return patch;
  }

  SurfacePatch saddle_patch(const SaddleFace& face) const {
    const RolledArc& arc = complex_.grown().surface.arcs[face.arc];
    SurfacePatch patch;
    patch.kind = PatchKind::saddle;
    patch.radius = unit_ * complex_.grown().surface.probe_radius;
    patch.center = place_of(arc.center);
    patch.axis = arc.axis;
    patch.ring_radius = unit_ * arc.circle_radius;
    return patch;
  }

  static constexpr const char* kByDoubles = "in double precision";
  // Gives up at a piece, naming the atoms of the patches beside it, and what did not tell the
  // curves apart.
  [[noreturn]] void refuse(const ArcPiece& piece, const std::string& by) const {
    std::vector<SphereId> atoms;
    for (const std::uint32_t f : complex_.curves.arcs[piece.arc].balls) {
      for (const SphereId id : patch_of(f).atoms) {
        if (id != kNoSphere) atoms.push_back(id);
      }
    }
    std::sort(atoms.begin(), atoms.end());
    atoms.erase(std::unique(atoms.begin(), atoms.end()), atoms.end());
    throw CurvesTooClose(fmt::format(
        "the excluded surface has no mesh: between spheres {} its curves are too close to be told "
        "apart {}",
        fmt::join(atoms, ", "), by));
  }

  const ExcludedMeshOptions& options_;
  const CurveComplex& complex_;
  const double unit_;         // of scaled lengths, in Å: a power of two
  const double edge_length_;  // scaled
  ArcSampling sampling_;
  const std::vector<std::uint32_t> pieces_at_first_;  // by curve
  const std::uint64_t all_at_first_;
  const double least_triangles_;  // estimated from the area
  std::vector<FaceMesh> faces_;
  tbb::enumerable_thread_specific<Scratch> scratch_;
  std::vector<PieceSplit> last_splits_;  // between the last round and this one
  ExcludedMeshStats stats_;
};

// Throws if the mesh has another topology than the surface.
void check_topology(const IndexedMesh& mesh, const ShellTable& exact) {
  SurfaceTopology wanted{0, static_cast<std::int64_t>(exact.shells.size())};
  for (const ExcludedShell& s : exact.shells) wanted.euler_characteristic += s.euler_characteristic;
  const SurfaceTopology found = surface_topology(mesh);
  if (found == wanted && exact.unmatched_patches == 0) return;
  if (found == wanted) {
    throw LimitExceeded(
        fmt::format("the excluded surface has no mesh: {} of its concave patches do not fit their "
                    "neighbours, so that its topology is not certain",
                    exact.unmatched_patches));
  }
  throw LimitExceeded(fmt::format(
      "the excluded surface has no mesh: χ would be {} in {} shells and should be {} in {}",
      found.euler_characteristic, found.shells, wanted.euler_characteristic, wanted.shells));
}

}  // namespace

ExcludedMesh mesh_excluded(const SphereSet& atoms, const ExcludedMeshOptions& options) {
  if (!(options.edge_length > 0) || !std::isfinite(options.edge_length)) {
    throw InvalidInput(
        fmt::format("the edge length must be positive and finite, not {} Å", options.edge_length));
  }
  const MesherClock::time_point begin = MesherClock::now();
  begin_stage(options.monitor, "excluded surface", 1);
  const GrownAtoms grown(atoms, options.probe, options.monitor);
  const std::vector<std::uint8_t> included =
      options.exterior ? grown.surface.outer_components()
                       : std::vector<std::uint8_t>(grown.surface.components.size(), 1);
  const PatchRecords records(grown.surface, included, options.monitor);
  const ShellTable shells = excluded_shells(grown.surface, records, included, grown.radius);
  const CurveComplex complex(grown, included, std::ldexp(options.edge_length, -grown.exponent),
                             options.monitor);
  const double surface_seconds = elapsed(begin);
  double area = 0;
  for (const ExcludedShell& s : shells.shells) area += s.area;
  ExcludedMesh out = ExcludedMesher(complex, area, options).run();
  check_topology(out.mesh, shells);
  out.stats.surface_seconds = surface_seconds;
  out.stats.seconds = elapsed(begin);
  return out;
}

}  // namespace vdwmesh
