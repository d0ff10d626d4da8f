// fill_mouth(): the constrained Delaunay triangulation of the rim and the stretches in the plane of
// the mouth's triangle. What lies to the left of all its bounds is free.
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cmath>
#include <map>
#include <set>

#include "core/no_index.hpp"
#include "pockets/rooms/mouth_plane.hpp"

namespace vdwmesh {
namespace {

using Plane2 = CGAL::Exact_predicates_inexact_constructions_kernel;
// Faces: 0 unknown, 1 free, -1 not.
using FlatFaces = CGAL::Triangulation_data_structure_2<
    CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Plane2>,
    CGAL::Constrained_triangulation_face_base_2<
        Plane2, CGAL::Triangulation_face_base_with_info_2<int, Plane2>>>;
using Flat =
    CGAL::Constrained_Delaunay_triangulation_2<Plane2, FlatFaces, CGAL::Exact_predicates_tag>;

class MouthFiller {
 public:
  MouthFiller(WallMesh& walls, const MouthPlane& mouth, double edge_length)
      : walls_(walls), mouth_(mouth), edge_length_(edge_length) {
    const Vec3d side = mouth.corners[1] - mouth.corners[0];
    x_axis_ = 1 / norm(side) * side;
    y_axis_ = cross(mouth.plane.normal, x_axis_);
  }

  std::vector<Triangle> run() && {
    for (const auto* steps : {&mouth_.stretches, &mouth_.rim}) {
      for (const Step& s : *steps) {
        if (!bounds_.insert(s).second) return {};
        flat_.insert_constraint(vertex(s[0]), vertex(s[1]));
      }
    }
    // Bounds that cross have made vertices of their own.
    if (flat_.dimension() != 2 || flat_.number_of_vertices() != vertices_.size() || !mark_free())
      return {};
    add_inner_vertices();
    std::vector<Triangle> triangles;
    for (const auto face : flat_.finite_face_handles()) {
      if (face->info() > 0)
        triangles.push_back(
            {face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
    }
    return triangles;
  }

 private:
  Plane2::Point_2 flat(const Vec3d& p) const {
    const Vec3d d = p - mouth_.corners[0];
    return {dot(x_axis_, d), dot(y_axis_, d)};
  }

  Flat::Vertex_handle vertex(std::uint32_t v) {
    const auto [found, is_new] = vertices_.try_emplace(v);
    if (is_new) {
      found->second = flat_.insert(flat(walls_.positions[v]));
      found->second->info() = v;
    }
    return found->second;
  }

  // Marks faces from bound to bound. Returns whether all bounds around a region agree.
  bool mark_free() {
    for (const auto face : flat_.all_face_handles()) face->info() = 0;
    for (const auto face : flat_.all_face_handles()) {
      if (face->info() == 0 && !mark_region(face)) return false;
    }
    return true;
  }

  bool mark_region(Flat::Face_handle first) {
    std::set<Flat::Face_handle> region{first};
    std::vector<Flat::Face_handle> queue{first};
    int mark = 0;
    while (!queue.empty()) {
      const auto face = queue.back();
      queue.pop_back();
      if (flat_.is_infinite(face)) {
        if (mark > 0) return false;
        mark = -1;
      }
      for (int k = 0; k < 3; ++k) {
        const auto next = face->neighbor(k);
        if (!face->is_constrained(k)) {
          if (region.insert(next).second) queue.push_back(next);
          continue;
        }
        const Step step{face->vertex(Flat::ccw(k))->info(), face->vertex(Flat::cw(k))->info()};
        const int here = bounds_.contains(step) ? 1 : bounds_.contains({step[1], step[0]}) ? -1 : 0;
        if (here == 0 || here == -mark) return false;
        mark = here;
      }
    }
    for (const auto face : region) face->info() = mark;
    return mark != 0;
  }

  // On a triangular lattice, no nearer to other vertices than a good part of its step.
  void add_inner_vertices() {
    constexpr double kLeastDistance = 0.6;  // of the edge length
    double low_x = HUGE_VAL, low_y = HUGE_VAL, high_x = -HUGE_VAL, high_y = -HUGE_VAL;
    for (const auto& [v, handle] : vertices_) {
      const auto& p = handle->point();
      low_x = std::min(low_x, p.x()), high_x = std::max(high_x, p.x());
      low_y = std::min(low_y, p.y()), high_y = std::max(high_y, p.y());
    }
    const double row = edge_length_ * std::sqrt(0.75);
    std::vector<Plane2::Point_2> inner;
    for (int j = 1; low_y + j * row < high_y; ++j) {
      for (int i = 0; low_x + (i + j % 2 / 2.0) * edge_length_ < high_x; ++i) {
        const Plane2::Point_2 p(low_x + (i + j % 2 / 2.0) * edge_length_, low_y + j * row);
        const auto face = flat_.locate(p);
        if (face == nullptr || flat_.is_infinite(face) || face->info() <= 0) continue;
        if (distance_to_bounds(p) > kLeastDistance * edge_length_) inner.push_back(p);
      }
    }
    for (const auto& p : inner) insert_inner(p);
  }

  double distance_to_bounds(const Plane2::Point_2& p) const {
    double least = HUGE_VAL;
    for (const auto& [v, handle] : vertices_) {
      const auto d = handle->point() - p;
      least = std::min(least, std::hypot(d.x(), d.y()));
    }
    return least;
  }

  // New faces are free, as those are that they replace; others keep their marks.
  void insert_inner(const Plane2::Point_2& p) {
    const auto v = flat_.insert(p);
    const Vec3d place = mouth_.corners[0] + p.x() * x_axis_ + p.y() * y_axis_;
    v->info() = walls_.add_vertex(place, {kNoSphere, kNoSphere, kNoSphere});
    auto face = flat_.incident_faces(v);
    const auto end = face;
    do face->info() = 1;
    while (++face != end);
  }

  WallMesh& walls_;
  const MouthPlane& mouth_;
  double edge_length_;
  Vec3d x_axis_, y_axis_;
  Flat flat_;
  std::map<std::uint32_t, Flat::Vertex_handle> vertices_;  // by number in the walls
  std::set<Step> bounds_;
};

}  // namespace

std::vector<Triangle> fill_mouth(WallMesh& walls, const MouthPlane& mouth, double edge_length) {
  return MouthFiller(walls, mouth, edge_length).run();
}

}  // namespace vdwmesh
