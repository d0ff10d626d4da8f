// self_intersections(): counts intersecting pairs of triangles with CGAL.
//
// CGAL's box_self_intersection_d finds the pairs of triangles whose bounding boxes overlap, in
// parallel with TBB. Each pair is tested with exact predicates (Intersector). What counts as an
// intersection depends on how many vertices the two triangles share by index: intersections in a
// shared vertex or along a shared edge are part of every mesh and are not counted.
#define CGAL_LINKED_WITH_TBB  // makes CGAL::Parallel_tag run in parallel
#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <atomic>
#include <vector>

#include "analysis/mesh_measures.hpp"

namespace vdwmesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using TriangleBox = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;

// Below this number of boxes CGAL sweeps instead of dividing further. The value is the same as in
// CGAL's own function self_intersections().
constexpr std::ptrdiff_t kSweepCutoff = 2000;

class Intersector {
 public:
  explicit Intersector(const IndexedMesh& mesh) : mesh_(mesh) {}

  // Returns whether the triangle has area 0 (exact).
  bool is_flat(const Triangle& t) const {
    return CGAL::collinear(point(t[0]), point(t[1]), point(t[2]));
  }

  // Returns whether two triangles intersect other than in the vertices and the edge that they share
  // by index. If they share one vertex and intersect elsewhere, the edge opposite to that vertex in
  // one of them meets the other triangle. Two triangles with three shared vertices coincide, which
  // counts as an intersection.
  bool operator()(std::uint32_t first, std::uint32_t second) const {
    Triangle a = mesh_.triangles[first], b = mesh_.triangles[second];
    switch (bring_shared_to_front(a, b)) {
      case 0:
        return CGAL::do_intersect(triangle(a), triangle(b));
      case 1:
        return CGAL::do_intersect(triangle(a), segment(b[1], b[2])) ||
               CGAL::do_intersect(triangle(b), segment(a[1], a[2]));
      case 2:
        return folds_over(a, b);
      default:
        return true;
    }
  }

  TriangleBox box(std::uint32_t t) const {
    const auto& [i, j, k] = mesh_.triangles[t];
    return TriangleBox(point(i).bbox() + point(j).bbox() + point(k).bbox(), t);
  }

 private:
  Point point(std::uint32_t v) const {
    const Vec3d& p = mesh_.positions[v];
    return {p.x, p.y, p.z};
  }
  Kernel::Triangle_3 triangle(const Triangle& t) const {
    return {point(t[0]), point(t[1]), point(t[2])};
  }
  Kernel::Segment_3 segment(std::uint32_t u, std::uint32_t v) const { return {point(u), point(v)}; }

  // Reorders both triangles so that shared vertices come first, in the same order. Returns the
  // number of shared vertices.
  static unsigned bring_shared_to_front(Triangle& a, Triangle& b) {
    unsigned shared = 0;
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned j = shared; j < 3; ++j)
        if (a[i] == b[j]) {
          std::swap(a[i], a[shared]);
          std::swap(b[j], b[shared]);
          ++shared;
          break;
        }
    return shared;
  }

  // Returns whether two triangles with a common edge pq overlap: they do only if they lie in one
  // plane and their third vertices r and s are on the same side of pq. Precondition: the vertices p
  // and q come first in both triangles.
  bool folds_over(const Triangle& a, const Triangle& b) const {
    const Point p = point(a[0]), q = point(a[1]), r = point(a[2]), s = point(b[2]);
    return CGAL::coplanar(p, q, r, s) && CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
  }

  const IndexedMesh& mesh_;
};

}  // namespace

std::uint64_t self_intersections(const IndexedMesh& mesh) {
  const Intersector intersect(mesh);
  std::vector<TriangleBox> boxes;
  boxes.reserve(mesh.triangle_count());
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t)
    if (!intersect.is_flat(mesh.triangles[t])) boxes.push_back(intersect.box(t));
  // CGAL reorders the sequence that it is given. Pointers are smaller to move than boxes.
  std::vector<const TriangleBox*> pointers(boxes.size());
  std::transform(boxes.begin(), boxes.end(), pointers.begin(),
                 [](const TriangleBox& b) { return &b; });
  std::atomic<std::uint64_t> pairs{0};
  CGAL::box_self_intersection_d<CGAL::Parallel_tag>(
      pointers.begin(), pointers.end(),
      [&](const TriangleBox* a, const TriangleBox* b) {
        if (intersect(a->info(), b->info())) pairs.fetch_add(1, std::memory_order_relaxed);
      },
      kSweepCutoff);
  return pairs;
}

}  // namespace vdwmesh
