// cut_walls(): where the spheres' mesh meets a triangle of a mouth, its edges get vertices exactly
// on the curves in which the spheres meet that plane, and its triangles are divided there. Curves
// end where edges of the mouth's triangle come out of the balls; these points are put into the mesh
// first, and are shared by the triangles at that edge.
//
// Before, triangles of walls along the curves are divided until they are no longer than the mouth
// asks for. Whether a curve crosses an edge depends on the sides of its ends alone, so curves are
// consistent; what is smaller than the edges is left out of both, the wall and the mouth.
#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <tuple>

#include "core/no_index.hpp"
#include "pockets/rooms/mouth_plane.hpp"
#include "spheres/box.hpp"

namespace vdwmesh {
namespace {

constexpr double kOnPlane = 1e-10;   // Å
constexpr double kNoStretch = 1e-9;  // Å: shorter ones are closed
constexpr double kNearEdge = 0.08;   // barycentric: nearer points go onto an edge
constexpr double kShift = 0.15;      // of the shortest edge: so far vertices may be moved
constexpr int kDivisions = 24;       // rounds, at most
constexpr double kMostSteps = 1000;  // of a stretch
constexpr VertexSpheres kOnNone{kNoSphere, kNoSphere, kNoSphere};

// The balls' edge between two corners of mouths, with its free stretches from the lower ball to the
// higher one.
using StretchesOfEdges = std::map<std::array<SphereId, 2>, std::vector<Step>>;

class WallCutter {
 public:
  WallCutter(WallMesh& walls, const SphereSet& spheres, std::vector<MouthPlane>& planes)
      : walls_(walls), spheres_(spheres), planes_(planes), is_cut_(planes.size(), 1) {
    for (const auto& [a, b, c] : walls.triangles) {
      margin_ = std::max({margin_, norm(at(a) - at(b)), norm(at(b) - at(c)), norm(at(c) - at(a))});
    }
    margin_ *= 2;
  }

  std::vector<std::uint8_t> run() && {
    for (MouthPlane& m : planes_) find_near(m);
    for (const MouthPlane& m : planes_) divide_along(m);
    StretchesOfEdges stretches;
    for (std::size_t i = 0; i < planes_.size(); ++i) place_stretches(i, stretches);
    for (std::size_t i = 0; i < planes_.size(); ++i) cut(i);
    for (std::size_t i = 0; i < planes_.size(); ++i) find_rim(i);
    return is_cut_;
  }

 private:
  // The one or two spheres of the triangles at an edge.
  using EdgeSpheres = std::unordered_map<EdgeKey, VertexSpheres>;

  static Box box_of(std::span<const Vec3d> points, double margin) {
    Box box = empty_box();
    for (const Vec3d& p : points) include(box, p);
    for (int k = 0; k < 3; ++k) box.lower[k] -= margin, box.upper[k] += margin;
    return box;
  }

  void find_near(MouthPlane& m) const {
    const Box box = box_of(m.corners, margin_);
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
      const auto id = static_cast<SphereId>(i);
      const Sphere& s = spheres_[i];
      if (std::abs(m.plane.height(s.center)) > s.radius + margin_) continue;
      if (!walls_.triangles_of(id).empty() && meet(box, box_of({&s.center, 1}, s.radius)))
        m.near.push_back(id);
    }
  }

  std::vector<std::uint32_t> triangles_near(const MouthPlane& m) const {
    const Box box = box_of(m.corners, margin_);
    std::vector<std::uint32_t> near;
    for (const SphereId s : m.near) {
      for (const std::uint32_t t : walls_.triangles_of(s)) {
        const auto& [a, b, c] = walls_.triangles[t];
        const std::array p{walls_.positions[a], walls_.positions[b], walls_.positions[c]};
        if (meet(box, box_of(p, 0))) near.push_back(t);
      }
    }
    return near;
  }

  EdgeSpheres spheres_of_edges(const std::vector<std::uint32_t>& triangles) const {
    EdgeSpheres edges;
    for (const std::uint32_t t : triangles) {
      const SphereId s = walls_.triangle_spheres[t];
      for (std::size_t k = 0; k < 3; ++k) {
        const auto key = edge_key(walls_.triangles[t][k], walls_.triangles[t][(k + 1) % 3]);
        const auto [at, is_new] = edges.try_emplace(key, on_sphere(s));
        if (!is_new && at->second[0] != s) {
          at->second[1] = std::max(s, at->second[0]), at->second[0] = std::min(s, at->second[0]);
        }
      }
    }
    return edges;
  }

  static std::uint32_t low(EdgeKey edge) { return static_cast<std::uint32_t>(edge >> 32); }
  static std::uint32_t high(EdgeKey edge) { return static_cast<std::uint32_t>(edge); }
  const Vec3d& at(std::uint32_t v) const { return walls_.positions[v]; }
  double length(EdgeKey edge) const { return norm(at(low(edge)) - at(high(edge))); }

  // -1, 0, 1: below the plane, which is towards the pocket, in it, above.
  int side(const MouthPlane& m, std::uint32_t v) const {
    if (m.on.contains(v)) return 0;
    const double height = m.plane.height(at(v));
    return std::abs(height) <= kOnPlane ? 0 : height < 0 ? -1 : 1;
  }

  // Where the curve crosses an edge in the triangle, exactly on the spheres.
  std::optional<Vec3d> crossing(const MouthPlane& m, EdgeKey edge,
                                const VertexSpheres& spheres) const {
    if (side(m, low(edge)) * side(m, high(edge)) >= 0) return std::nullopt;
    const Vec3d &a = at(low(edge)), &b = at(high(edge));
    const double from = m.plane.height(a), to = m.plane.height(b);
    const auto p = walls_.onto(spheres, m.plane, a + from / (from - to) * (b - a));
    return p && m.contains(*p) ? p : std::nullopt;
  }

  std::uint32_t longest_edge(std::uint32_t t) const {
    const Triangle& v = walls_.triangles[t];
    std::uint32_t longest = 0;
    for (std::uint32_t k = 1; k < 3; ++k) {
      const auto key = [&](std::uint32_t i) { return edge_key(v[i], v[(i + 1) % 3]); };
      if (std::pair(length(key(k)), key(k)) > std::pair(length(key(longest)), key(longest)))
        longest = k;
    }
    return longest;
  }

  // Divides long triangles that the curve crosses, at their longest edges.
  void divide_along(const MouthPlane& m) {
    for (int round = 0; round < kDivisions; ++round) {
      const auto near = triangles_near(m);
      const EdgeSpheres edges = spheres_of_edges(near);
      std::unordered_map<EdgeKey, std::uint32_t> points;
      for (const std::uint32_t t : near) {
        const Triangle& v = walls_.triangles[t];
        const std::uint32_t k = longest_edge(t);
        const EdgeKey longest = edge_key(v[k], v[(k + 1) % 3]);
        if (length(longest) <= m.edge_length || points.contains(longest)) continue;
        bool crosses = false;
        for (std::size_t e = 0; e < 3 && !crosses; ++e) {
          const EdgeKey edge = edge_key(v[e], v[(e + 1) % 3]);
          crosses = crossing(m, edge, edges.at(edge)).has_value();
        }
        const VertexSpheres& label = edges.at(longest);
        const auto p =
            crosses ? walls_.onto(label, 0.5 * (at(v[k]) + at(v[(k + 1) % 3]))) : std::nullopt;
        if (p) points[longest] = walls_.add_vertex(*p, label);
      }
      if (points.empty()) return;
      walls_.split(near, points);
    }
  }

  // The stretches of each edge of the triangle, made for the first triangle that has the edge.
  void place_stretches(std::size_t i, StretchesOfEdges& known) {
    MouthPlane& m = planes_[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const SphereId from = m.balls[k], to = m.balls[(k + 1) % 3];
      const std::array<SphereId, 2> edge{std::min(from, to), std::max(from, to)};
      const auto [found, is_new] = known.try_emplace(edge);
      if (is_new) found->second = stretches_of(edge, m);
      for (const Step& s : found->second) {
        if (s[0] == kNoIndex || s[1] == kNoIndex) {
          is_cut_[i] = 0;
          continue;
        }
        m.stretches.push_back(from < to ? s : Step{s[1], s[0]});
        m.on.insert(s.begin(), s.end());
      }
    }
  }

  std::vector<Step> stretches_of(const std::array<SphereId, 2>& edge, const MouthPlane& m) {
    const Vec3d from = spheres_[edge[0]].center, along = spheres_[edge[1]].center - from;
    const double squared_length = squared_norm(along);
    std::vector<std::tuple<double, double, SphereId>> covered;  // from, to, in shares of the edge
    for (const SphereId s : m.near) {
      const Vec3d d = from - spheres_[s].center;
      const double middle = -dot(d, along) / squared_length;
      const double squared_distance = squared_norm(d + middle * along);
      const double squared_half = spheres_[s].radius * spheres_[s].radius - squared_distance;
      if (!(squared_half > 0)) continue;
      const double half = std::sqrt(squared_half / squared_length);
      if (middle + half > 0 && middle - half < 1)
        covered.push_back({middle - half, middle + half, s});
    }
    std::ranges::sort(covered);
    std::vector<Step> stretches;
    double end = 0;
    SphereId last = edge[0];
    for (const auto& [low_end, high_end, s] : covered) {
      if ((low_end - end) * std::sqrt(squared_length) > kNoStretch) {
        const Vec3d leaves = from + end * along, enters = from + low_end * along;
        const std::uint32_t first = place(m, last, leaves), back = place(m, s, enters);
        add_stretch(stretches, {first, back}, leaves, enters, m.edge_length);
      }
      if (high_end > end) end = high_end, last = s;
    }
    return stretches;
  }

  // In steps of about the edge length.
  void add_stretch(std::vector<Step>& stretches, const Step& ends, const Vec3d& from,
                   const Vec3d& to, double edge_length) {
    const double steps = std::clamp(std::ceil(norm(to - from) / edge_length), 1.0, kMostSteps);
    std::uint32_t last = ends[0];
    for (double i = 1; i < steps; ++i) {
      const std::uint32_t next = new_on_rim(from + i / steps * (to - from), kOnNone);
      stretches.push_back({last, next});
      last = next;
    }
    stretches.push_back({last, ends[1]});
  }

  // Makes a point of a sphere a vertex of its triangles; kNoIndex if none of them is there. Points
  // between a crease and the chord of its edge are in no triangle: the crease gets vertices.
  std::uint32_t place(const MouthPlane& m, SphereId s, const Vec3d& p) {
    for (int round = 0; round < kDivisions; ++round) {
      const auto [t, weights] = triangle_at(s, p);
      if (t == kNoIndex) return kNoIndex;
      const Triangle v = walls_.triangles[t];
      const auto least =
          static_cast<std::size_t>(std::ranges::min_element(weights) - weights.begin());
      // The corner nearest to the point, if it is free to move there.
      const auto most =
          static_cast<std::size_t>(std::ranges::max_element(weights) - weights.begin());
      if (weights[most] > 1 - kNearEdge && walls_.labels[v[most]][1] == kNoSphere &&
          !walls_.is_fixed[v[most]]) {
        walls_.positions[v[most]] = p, walls_.is_fixed[v[most]] = 1;
        return v[most];
      }
      const EdgeKey edge = edge_key(v[(least + 1) % 3], v[(least + 2) % 3]);
      const auto around = triangles_at(m, edge);
      const VertexSpheres label = spheres_of_edges(around).at(edge);
      if (weights[least] >= kNearEdge || (weights[least] > 0 && label[1] != kNoSphere)) {
        const std::uint32_t x = new_on_rim(p, on_sphere(s));
        walls_.insert(t, x);
        return x;
      }
      if (label[1] == kNoSphere) {
        const std::uint32_t x = new_on_rim(p, on_sphere(s));
        walls_.split(around, {{edge, x}});
        return x;
      }
      const auto nearest = walls_.onto(label, p);
      if (!nearest) return kNoIndex;
      walls_.split(around, {{edge, walls_.add_vertex(*nearest, label)}});
    }
    return kNoIndex;
  }

  std::uint32_t new_on_rim(const Vec3d& p, const VertexSpheres& label) {
    const std::uint32_t v = walls_.add_vertex(p, label);
    walls_.is_fixed[v] = 1;
    return v;
  }

  // The triangle of a sphere that the point is in, seen from the centre, with its barycentric
  // coordinates; if it is in none, the one that it is nearest to.
  std::pair<std::uint32_t, std::array<double, 3>> triangle_at(SphereId s, const Vec3d& p) const {
    std::pair<std::uint32_t, std::array<double, 3>> best{kNoIndex, {}};
    double most = -1;  // of the least coordinate
    const Vec3d center = spheres_[s].center, x = p - center;
    for (const std::uint32_t t : walls_.triangles_of(s)) {
      const auto& [i, j, k] = walls_.triangles[t];
      const Vec3d a = at(i) - center, b = at(j) - center, c = at(k) - center;
      if (!(dot(x, a + b + c) > 0)) continue;
      std::array w{dot(x, cross(b, c)), dot(a, cross(x, c)), dot(a, cross(b, x))};
      const double sum = w[0] + w[1] + w[2];
      if (!(sum > 0)) continue;
      for (double& weight : w) weight /= sum;
      const double least = std::ranges::min(w);
      if (least > most) most = least, best = {t, w};
    }
    return best;
  }

  std::vector<std::uint32_t> triangles_at(const MouthPlane& m, EdgeKey edge) const {
    std::vector<std::uint32_t> found;
    const auto has = [&](std::uint32_t t, std::uint32_t v) {
      return std::ranges::count(walls_.triangles[t], v) > 0;
    };
    for (const SphereId s : m.near) {
      for (const std::uint32_t t : walls_.triangles_of(s)) {
        if (has(t, low(edge)) && has(t, high(edge))) found.push_back(t);
      }
    }
    return found;
  }

  void cut(std::size_t i) {
    MouthPlane& m = planes_[i];
    const auto near = triangles_near(m);
    const EdgeSpheres edges = spheres_of_edges(near);
    move_onto(m, edges);
    std::unordered_map<EdgeKey, std::uint32_t> points;
    for (const auto& [edge, spheres] : edges) {
      for (const std::uint32_t v : {low(edge), high(edge)}) {
        if (side(m, v) == 0 && m.contains(at(v))) m.on.insert(v), walls_.is_fixed[v] = 1;
      }
    }
    std::vector<EdgeKey> ordered;  // for numbers that do not depend on the hash
    for (const auto& [edge, spheres] : edges) ordered.push_back(edge);
    std::ranges::sort(ordered);
    for (const EdgeKey edge : ordered) {
      const auto p = crossing(m, edge, edges.at(edge));
      if (!p) continue;
      const std::uint32_t v = new_on_rim(*p, edges.at(edge));
      m.on.insert(v), points[edge] = v;
    }
    walls_.split(near, points);
  }

  // Moves vertices that are very near to the curve onto it.
  void move_onto(MouthPlane& m, const EdgeSpheres& edges) {
    std::map<std::uint32_t, double> shortest;  // at vertices
    for (const auto& [edge, spheres] : edges) {
      for (const std::uint32_t v : {low(edge), high(edge)}) {
        double& least = shortest.try_emplace(v, length(edge)).first->second;
        least = std::min(least, length(edge));
      }
    }
    for (const auto& [v, least] : shortest) {
      if (walls_.is_fixed[v] || walls_.labels[v][2] != kNoSphere) continue;
      if (std::abs(m.plane.height(at(v))) > kShift * least) continue;
      const auto p = walls_.onto(walls_.labels[v], m.plane, at(v));
      if (!p || !m.contains(*p) || norm(*p - at(v)) > kShift * least) continue;
      walls_.positions[v] = *p, walls_.is_fixed[v] = 1;
      m.on.insert(v);
    }
  }

  // On which side a triangle lies that does not cross the plane.
  int side_of(const MouthPlane& m, std::uint32_t t) const {
    Vec3d middle{};
    for (const std::uint32_t v : walls_.triangles[t]) {
      if (const int s = side(m, v)) return s;
      middle = middle + 1.0 / 3 * at(v);
    }
    const auto p = walls_.onto(on_sphere(walls_.triangle_spheres[t]), middle);
    return p && m.plane.height(*p) < 0 ? -1 : 1;
  }

  // Edges between vertices of the rim, with the pocket on one side.
  void find_rim(std::size_t i) {
    MouthPlane& m = planes_[i];
    std::map<EdgeKey, std::vector<std::pair<int, Step>>> sides;
    for (const std::uint32_t t : triangles_near(m)) {
      const Triangle& v = walls_.triangles[t];
      for (std::size_t k = 0; k < 3; ++k) {
        const Step step{v[k], v[(k + 1) % 3]};
        if (!m.on.contains(step[0]) || !m.on.contains(step[1])) continue;
        sides[edge_key(step[0], step[1])].push_back({side_of(m, t), step});
      }
    }
    std::map<std::uint32_t, int> balance;  // of ways that begin and end at a vertex
    for (const auto& [edge, two] : sides) {
      if (two.size() != 2 || two[0].first == two[1].first) continue;
      m.rim.push_back(two[0].first < 0 ? two[0].second : two[1].second);
      ++balance[m.rim.back()[1]], --balance[m.rim.back()[0]];
    }
    for (const Step& s : m.stretches) ++balance[s[1]], --balance[s[0]];
    for (const auto& [v, ways] : balance) {
      if (ways != 0) is_cut_[i] = 0;
    }
  }

  WallMesh& walls_;
  const SphereSet& spheres_;
  std::vector<MouthPlane>& planes_;
  std::vector<std::uint8_t> is_cut_;  // by plane
  double margin_ = 0;  // Å: twice the longest edge, so triangles at an edge are found with it
};

}  // namespace

std::vector<std::uint8_t> cut_walls(WallMesh& walls, const SphereSet& spheres,
                                    std::vector<MouthPlane>& planes) {
  return WallCutter(walls, spheres, planes).run();
}

}  // namespace vdwmesh
