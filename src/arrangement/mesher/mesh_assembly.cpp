// Steps: (1) Add up vertices and triangles of the patches, so that every patch has index ranges of
// its own to write to. (2) Find the numbers of corners and points of arcs that patches of the share
// have and that are not in its runs; a mesh of all patches has none. (3) Place corners, points of
// arcs and patches, each on all cores.
#include "arrangement/mesher/mesh_assembly.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

class Assembly {
 public:
  Assembly(const MeshedPatches& meshed, const MeshShare& share)
      : t_(meshed.triangulation),
        boundary_(meshed.boundary),
        sampling_(meshed.sampling),
        index_(meshed.index),
        patches_(meshed.patches),
        share_(share),
        unit_(std::ldexp(1.0, t_.scale_exponent)),
        corners_(share.corners.second - share.corners.first),
        first_point_(sampling_.first_vertex(share.arcs.first)),
        points_(sampling_.first_vertex(share.arcs.second) - first_point_) {}

  MeshPiece run() && {
    const auto [first_ball, end_ball] = share_.balls;
    const std::size_t balls = end_ball - first_ball;
    std::vector<std::uint64_t> first_vertex(balls + 1), first_triangle(balls + 1);
    first_vertex[0] = corners_ + points_;
    for (std::size_t i = 0; i < balls; ++i) {
      const PatchMesh& patch = patches_[first_ball + i];
      first_vertex[i + 1] = first_vertex[i] + patch.interior.size();
      first_triangle[i + 1] = first_triangle[i] + patch.triangles.size();
    }
    find_elsewhere();
    piece_.own = {corners_, points_, first_vertex.back() - first_vertex.front()};
    check_count(first_vertex.back() + piece_.elsewhere.size());
    make_room(piece_.mesh, {first_vertex.back(), first_triangle.back()}, kPatchArrays);
    place_corners();
    place_arcs();
    tbb::parallel_for(std::size_t{0}, balls, [&](std::size_t i) {
      const auto ball = static_cast<std::uint32_t>(first_ball + i);
      place_patch(ball, first_vertex[i], first_triangle[i]);
      patches_[ball] = {};
    });
    return std::move(piece_);
  }

 private:
  static void check_count(std::uint64_t vertices) {
    if (vertices <= kMaxVertices) return;
    throw LimitExceeded(
        fmt::format("{} vertices; a mesh holds at most {}: choose a larger edge length", vertices,
                    kMaxVertices));
  }

  // Whether the share has all corners and arcs, so that no vertex is elsewhere.
  bool is_whole() const {
    return corners_ == boundary_.corners.size() && corners_ + points_ == sampling_.vertex_count();
  }

  bool is_own(std::uint32_t number) const {
    const auto corners = static_cast<std::uint32_t>(boundary_.corners.size());
    return number < corners ? number - share_.corners.first < corners_
                            : number - first_point_ < points_;
  }

  // The vertex of the piece that has this number of a corner or point of an arc.
  std::uint32_t local(std::uint32_t number) const {
    if (is_own(number)) {
      return number < boundary_.corners.size()
                 ? number - share_.corners.first
                 : static_cast<std::uint32_t>(corners_) + (number - first_point_);
    }
    const auto place = std::ranges::lower_bound(piece_.elsewhere, number);
    return static_cast<std::uint32_t>(piece_.mesh.vertex_count() +
                                      static_cast<std::size_t>(place - piece_.elsewhere.begin()));
  }

  void find_elsewhere() {
    if (is_whole()) return;
    const auto [first_ball, end_ball] = share_.balls;
    piece_.elsewhere = collect<std::uint64_t>(
        end_ball - first_ball, [&](std::size_t i, std::vector<std::uint64_t>& found) {
          const auto ball = static_cast<std::uint32_t>(first_ball + i);
          if (patches_[ball].triangles.empty()) return;
          std::vector<std::uint32_t> vertices;
          boundary_vertices(boundary_, sampling_, index_, ball, vertices);
          for (const std::uint32_t v : vertices) {
            if (!is_own(v)) found.push_back(v);
          }
        });
    std::ranges::sort(piece_.elsewhere);
    const auto repeats = std::ranges::unique(piece_.elsewhere);
    piece_.elsewhere.erase(repeats.begin(), repeats.end());
  }

  void place_corners() {
    for (std::uint32_t c = share_.corners.first; c < share_.corners.second; ++c) {
      const BoundaryCorner& corner = boundary_.corners[c];
      place(corner.position, corner.balls, local(c));
    }
  }

  void place_arcs() {
    tbb::parallel_for(share_.arcs.first, share_.arcs.second, [&](std::uint32_t a) {
      const BoundaryArc& arc = boundary_.arcs[a];
      for (std::uint32_t k = arc.is_circle() ? 0 : 1; k < sampling_.pieces(a); ++k) {
        place(sampling_.point(a, k), {arc.balls[0], arc.balls[1], kNoIndex},
              local(sampling_.vertex(a, k)));
      }
    });
  }

  // Writes vertex `vertex` of the mesh at p (scaled), which lies on the spheres of up to three
  // balls; unused entries of `balls` are kNoIndex. The label has the ids of the spheres in
  // ascending order. The normal is the mean of the spheres' normals. If these cancel, as at a point
  // of contact, the normal of the first sphere is taken: a sum shorter than 1e-6 would have no
  // reliable direction.
  void place(const Vec3d& p, const std::array<std::uint32_t, 3>& balls, std::size_t vertex) {
    Vec3d sum{0, 0, 0}, first{0, 0, 0};
    VertexSpheres label{kNoSphere, kNoSphere, kNoSphere};
    for (std::size_t k = 0; k < 3 && balls[k] != kNoIndex; ++k) {
      const Vec3d out = p - t_.balls[balls[k]].center;
      sum = sum + (1 / norm(out)) * out;
      if (k == 0) first = sum;
      label[k] = t_.ids[balls[k]];
    }
    std::sort(label.begin(), label.end());
    if (!(squared_norm(sum) > 1e-12)) sum = first;
    IndexedMesh& mesh = piece_.mesh;
    mesh.positions[vertex] = unscaled(p);
    mesh.normals[vertex] = cast<float>((1 / norm(sum)) * sum);
    mesh.vertex_spheres.set(vertex, label);
  }

  // Writes the interior vertices of one patch, from vertex first_vertex on, and its triangles, from
  // first_triangle on. `vertices` maps the point numbers of the patch to vertices of the mesh:
  // first the points of the boundary, which have been written already, then the interior points.
  void place_patch(std::uint32_t ball, std::uint64_t first_vertex, std::uint64_t first_triangle) {
    IndexedMesh& mesh = piece_.mesh;
    const PatchMesh& patch = patches_[ball];
    if (patch.triangles.empty()) return;
    const Sphere& s = t_.balls[ball];
    const SphereId id = t_.ids[ball];
    std::vector<std::uint32_t> vertices;
    boundary_vertices(boundary_, sampling_, index_, ball, vertices);
    for (std::uint32_t& v : vertices) v = local(v);
    for (std::size_t i = 0; i < patch.interior.size(); ++i) {
      const std::uint64_t v = first_vertex + i;
      mesh.positions[v] = unscaled(s.center + s.radius * patch.interior[i]);
      mesh.normals[v] = cast<float>(patch.interior[i]);
      mesh.vertex_spheres.set(v, on_sphere(id));
      vertices.push_back(static_cast<std::uint32_t>(v));
    }
    for (std::size_t t = 0; t < patch.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        mesh.triangles[first_triangle + t][k] = vertices[patch.triangles[t][k]];
      }
      mesh.triangle_spheres[first_triangle + t] = id;
    }
  }

  // From scaled lengths to Å. The scale is a power of two, so this does not round.
  Vec3d unscaled(const Vec3d& p) const { return unit_ * p; }

  const PowerTriangulation& t_;
  const BoundaryArcs& boundary_;
  const ArcSampling& sampling_;
  const PatchIndex& index_;
  std::vector<PatchMesh>& patches_;
  const MeshShare& share_;
  double unit_;                         // of scaled lengths, in Å: a power of two
  std::uint64_t corners_;               // of the share
  std::uint32_t first_point_, points_;  // of its arcs: the number of the first, and how many
  MeshPiece piece_;
};

}  // namespace

MeshPiece assemble(const MeshedPatches& meshed, const MeshShare& share) {
  return Assembly(meshed, share).run();
}

}  // namespace vdwmesh
