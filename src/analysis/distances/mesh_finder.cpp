// MeshFinder: the distances from points to the nearest triangle.
//
// Points are taken in groups of neighbours. One search of the tree with the box of a group lists
// the nodes of level 0 within some reach of it; each point then examines the listed nodes alone.
// If that finds a triangle within the reach, no other is nearer: every triangle so near to a point
// of the group is in a listed node. Otherwise, and if a group would list too many nodes, the tree
// is searched for the point itself. The reach follows the distances found before, so few points
// need that. The result is the least of all triangles' distances, so it does not depend, to the
// last bit, on groups and reaches.
//
// The children of a divided triangle, which are near each other, are one primitive of the tree: it
// has a quarter of the boxes, and the six vertices of four triangles are fetched once.
//
// Where only the largest distance matters, a point is searched for only if the triangle that was
// nearest to a point before it is farther than the largest distance so far. Otherwise some triangle
// is as near as that, so the point cannot raise the maximum.
#include "analysis/distances/mesh_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/crossings/triangle_runs.hpp"
#include "analysis/distances/box_tree_lanes.hpp"
#include "analysis/distances/distances_triangle.hpp"
#include "analysis/survey/mesh_area.hpp"
#include "core/lanes/multiversion.hpp"
#include "core/order/morton.hpp"
#include "spheres/box.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kGroup = 8;                // points
constexpr std::size_t kWidth = BoxNode::kWidth;  // boxes that a vector instruction measures
constexpr std::size_t kMostListed = 128;         // nodes that a group may list

// Nodes of level 0 near a group of points, with their boxes in scaled coordinates: one array for
// each side, so that vector instructions measure eight boxes.
class NodeList {
 public:
  // Lists the nodes within `reach` (Å) of the box. Returns false if there are too many.
  bool gather(const BoxTreeView& tree, const Box& box, double reach) {
    count_ = 0;
    const auto take = [&](std::uint32_t index) { return add(tree.levels[0][index], index); };
    if (!for_each_near_leaf<NearEight>(tree, tree.query(box.lower, box.upper), reach * reach,
                                       take)) {
      return false;
    }
    fill_up();
    return true;
  }

  // Does what visit_nearest() does, for the primitives of the listed nodes alone.
  template <class Visit>
  void visit_near(const BoxTreeView& tree, const Vec3d& p, double& squared, Visit&& visit) {
    const BoxQuery query = tree.query(p);
    const std::size_t first = measure(query);
    float bound = tree.bound_of(squared);
    const auto examine = [&](std::size_t i) {
      visit_primitives<NearEight>(tree, index_[i], query, squared, visit);
      bound = tree.bound_of(squared);
    };
    if (distance_[first] < bound) examine(first);
    for (std::size_t i = 0; i < count_; ++i)
      if (distance_[i] < bound && i != first) examine(i);
  }

 private:
  bool add(const BoxNode& node, std::uint32_t index) {
    if (count_ == kMostListed) return false;
    const Box box = vdwmesh::box_of(node);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower_[axis][count_] = static_cast<float>(box.lower[static_cast<int>(axis)]) - kMargin;
      upper_[axis][count_] = static_cast<float>(box.upper[static_cast<int>(axis)]) + kMargin;
    }
    index_[count_++] = index;
    return true;
  }
  // Fills the last vector of eight with boxes that are far from everything.
  void fill_up() {
    for (std::size_t i = count_; i % kWidth != 0; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) lower_[axis][i] = upper_[axis][i] = 1e9F;
  }
  // Fills distance_ with the squared distances to all boxes. Returns the place of the nearest, or
  // of one that is about as near.
  std::size_t measure(const BoxQuery& query) {
    std::array<float, kWidth> least;
    std::array<std::int32_t, kWidth> block{};
    least.fill(std::numeric_limits<float>::infinity());
    for (std::size_t base = 0; base < count_; base += kWidth) {
      for (std::size_t lane = 0; lane < kWidth; ++lane) {
        float sum = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const float below = lower_[axis][base + lane] - query.lower[axis];
          const float above = query.lower[axis] - upper_[axis][base + lane];
          const float larger = below > above ? below : above;
          const float outside = larger > 0 ? larger : 0;
          sum += outside * outside;
        }
        distance_[base + lane] = sum;
        const bool nearer = sum < least[lane];
        least[lane] = nearer ? sum : least[lane];
        block[lane] = nearer ? static_cast<std::int32_t>(base) : block[lane];
      }
    }
    std::size_t first = 0;
    for (std::size_t lane = 1; lane < kWidth; ++lane)
      first = least[lane] < least[first] ? lane : first;
    return static_cast<std::size_t>(block[first]) + first;
  }

  // The box of a node has the roundings of its decoding beside those of a query.
  static constexpr float kMargin = 2 * kBoxMargin;
  std::size_t count_ = 0;
  alignas(32) std::array<std::array<float, kMostListed>, 3> lower_, upper_;
  alignas(32) std::array<float, kMostListed> distance_;
  std::array<std::uint32_t, kMostListed> index_;
};

// The triangles of a mesh as the primitives of its tree: runs of `length` consecutive ones.
struct TriangleRuns {
  const IndexedMesh& mesh;
  std::uint32_t length;

  // Calls visit(triangle, squared distance of p) for each triangle of a run.
  template <class Visit>
  void measure(std::uint32_t run, const Vec3d& p, Visit&& visit) const {
    const std::size_t first = std::size_t{length} * run,
                      end = std::min(first + length, mesh.triangle_count());
    for (std::size_t t = first; t < end; ++t) {
      visit(static_cast<std::uint32_t>(t), squared_distance_to(p, corners_of(mesh, t)));
    }
  }
};

// The search for consecutive points.
class TriangleSearch {
 public:
  TriangleSearch(const TriangleRuns& runs, const BoxTreeView& tree) : runs_(runs), tree_(tree) {}

  void find(std::span<const Vec3d> group, double* found) {
    Box box{group[0], group[0]};
    for (const Vec3d& p : group) include(box, p);
    const bool listed = reach_ > 0 && list_.gather(tree_, box, reach_);
    double total = 0;
    for (std::size_t i = 0; i < group.size(); ++i) {
      const Vec3d& p = group[i];
      found[i] = std::sqrt(listed ? in_list(p) : in_tree(p));
      total += found[i];
    }
    // Three times the mean: few points are farther off, and a single one does not make the next
    // list long.
    reach_ = 3 * total / static_cast<double>(group.size());
  }

  // The larger of `largest` and the distance of p. The search ends at the first triangle within
  // `largest`. The root of the least of all squares is at most the root of any of them, as computed
  // too, since a rounded root keeps the order of its arguments.
  double raise(const Vec3d& p, double largest) {
    double squared = to_nearest(p);
    bool is_near = std::sqrt(squared) <= largest;
    if (is_near) return largest;
    visit_nearest<NearEight>(tree_, tree_.query(p), squared, [&](std::uint32_t run, double& best) {
      if (!lower(run, p, best)) return;
      is_near = std::sqrt(best) <= largest;
      if (is_near) best = -1;
    });
    return is_near ? largest : std::sqrt(squared);
  }

 private:
  double to_nearest(const Vec3d& p) const {
    return squared_distance_to(p, corners_of(runs_.mesh, nearest_));
  }
  // Lowers `best` to the squared distance of p from the run, and returns whether that is less.
  bool lower(std::uint32_t run, const Vec3d& p, double& best) {
    const double before = best;
    runs_.measure(run, p, [&](std::uint32_t t, double here) {
      if (here < best) best = here, nearest_ = t;
    });
    return best < before;
  }
  double in_tree(const Vec3d& p) {
    double squared = to_nearest(p);
    visit_nearest<NearEight>(tree_, tree_.query(p), squared,
                             [&](std::uint32_t run, double& best) { lower(run, p, best); });
    return squared;
  }
  double in_list(const Vec3d& p) {
    double squared = reach_ * reach_;
    bool any = false;
    list_.visit_near(tree_, p, squared,
                     [&](std::uint32_t run, double& best) { any |= lower(run, p, best); });
    return any ? squared : in_tree(p);
  }

  TriangleRuns runs_;
  const BoxTreeView& tree_;
  NodeList list_;
  double reach_ = 0;           // Å
  std::uint32_t nearest_ = 0;  // the triangle nearest to the last point
};

VDWMESH_MULTIVERSION void find_all(const TriangleRuns& runs, const BoxTreeView& tree,
                                   std::span<const Vec3d> points, double* found) {
  TriangleSearch search(runs, tree);
  for (std::size_t first = 0; first < points.size(); first += kGroup) {
    search.find(points.subspan(first, std::min(kGroup, points.size() - first)), found + first);
  }
}

VDWMESH_MULTIVERSION double raise_all(const TriangleRuns& runs, const BoxTreeView& tree,
                                      std::span<const Vec3d> points, double largest) {
  TriangleSearch search(runs, tree);
  for (const Vec3d& p : points) largest = search.raise(p, largest);
  return largest;
}

// The box around the triangles of a run.
VDWMESH_MULTIVERSION Box box_of_run(const TriangleRuns& runs, std::uint32_t run) {
  const std::size_t first = std::size_t{runs.length} * run;
  return box_of_triangles(runs.mesh, first,
                          std::min(first + runs.length, runs.mesh.triangle_count()));
}

// The indices of points along the Z-order curve in the cube around them. A key has the number of a
// cell, of which there are 2^10 along each axis, and below it the index.
std::vector<std::uint32_t> along_curve(std::span<const Vec3d> points) {
  constexpr double kCells = 1 << 10;
  const Box box = box_around(points);
  const Vec3d side = box.upper - box.lower;
  const double longest = std::max({side.x, side.y, side.z});
  const double per_unit = longest > 0 ? kCells / longest : 0;
  std::vector<std::uint64_t> keys(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto cell = [&](int axis) {
      const double place = (points[i][axis] - box.lower[axis]) * per_unit;
      return static_cast<std::uint64_t>(place < kCells ? place : kCells - 1);
    };
    keys[i] = morton_code(cell(0), cell(1), cell(2)) << 32 | i;
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(keys[i]);
  return order;
}

}  // namespace

MeshFinder::MeshFinder(const IndexedMesh& mesh, const Box& world)
    : mesh_(mesh),
      run_(static_cast<std::uint32_t>(triangles_together(mesh))),
      tree_(static_cast<std::uint32_t>((mesh.triangle_count() + run_ - 1) / run_), world,
            [&](std::uint32_t run) {
              return box_of_run({mesh, run_}, run);
            }) {}

// The points are searched in their order along the Z-order curve, in which a group of them is in
// about the smallest box. The distance of a point does not depend on the others.
void MeshFinder::find(std::span<const Vec3d> points, double* found) const {
  const std::vector<std::uint32_t> order = along_curve(points);
  std::vector<Vec3d> sorted(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = points[order[i]];
  std::vector<double> distance(points.size());
  find_all({mesh_, run_}, tree_.view(), sorted, distance.data());
  for (std::size_t i = 0; i < order.size(); ++i) found[order[i]] = distance[i];
}

double MeshFinder::largest_distance(std::span<const Vec3d> points, double largest) const {
  return raise_all({mesh_, run_}, tree_.view(), points, largest);
}

}  // namespace vdwmesh
