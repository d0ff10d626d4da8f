// close_room(): finds the triangles on both sides of each edge; corners that are joined across
// edges are one vertex.
#include "pockets/rooms/close_room.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "core/disjoint_sets.hpp"
#include "core/no_index.hpp"

namespace vdwmesh {
namespace {

class RoomCloser {
 public:
  RoomCloser(const WallMesh& walls, const std::vector<RoomTriangle>& triangles)
      : walls_(walls), triangles_(triangles), corners_(3 * triangles.size()) {}

  std::optional<PocketMesh> run() && {
    std::vector<std::pair<EdgeKey, std::uint32_t>> edges;  // with the half-edge
    for (std::uint32_t h = 0; h < 3 * triangles_.size(); ++h) {
      edges.push_back({edge_key(start(h), end(h)), h});
    }
    std::ranges::sort(edges);
    for (std::size_t first = 0; first < edges.size();) {
      std::vector<std::uint32_t> around;
      const EdgeKey key = edges[first].first;
      for (; first < edges.size() && edges[first].first == key; ++first) {
        around.push_back(edges[first].second);
      }
      if (!pair_up(around)) return std::nullopt;
    }
    return mesh();
  }

 private:
  // Half-edge 3 t + k runs from corner k of triangle t to the next.
  std::uint32_t start(std::uint32_t h) const { return triangles_[h / 3].vertices[h % 3]; }
  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  std::uint32_t end(std::uint32_t h) const { return start(next(h)); }
  const Vec3d& at(std::uint32_t v) const { return walls_.positions[v]; }

  // All half-edges of one edge. The room is behind a triangle whose half-edge runs upwards, in the
  // sense of a right-handed turn around the edge, and before one whose half-edge runs downwards.
  bool pair_up(std::vector<std::uint32_t>& around) {
    const auto is_up = [&](std::uint32_t h) { return start(h) < end(h); };
    const auto ups = static_cast<std::size_t>(std::ranges::count_if(around, is_up));
    if (2 * ups != around.size()) return false;
    if (around.size() > 2) sort_around(around);
    for (std::size_t i = 0; i < around.size(); ++i) {
      if (is_up(around[i])) continue;
      const std::uint32_t other = around[(i + 1) % around.size()];
      if (!is_up(other)) return false;
      join(around[i], other);
    }
    return true;
  }

  void sort_around(std::vector<std::uint32_t>& around) const {
    const std::uint32_t low = std::min(start(around[0]), end(around[0]));
    const std::uint32_t high = std::max(start(around[0]), end(around[0]));
    const Vec3d axis = at(high) - at(low);
    const auto out = [&](std::uint32_t h) {
      const Vec3d d = at(start(next(next(h)))) - at(low);
      return d - dot(d, axis) / squared_norm(axis) * axis;
    };
    const Vec3d x = out(around[0]), y = 1 / norm(axis) * cross(axis, x);
    const auto angle = [&](std::uint32_t h) {
      const Vec3d d = out(h);
      const double turn = std::atan2(dot(d, y), dot(d, x));
      return h == around[0] ? 0 : turn < 0 ? turn + 2 * std::numbers::pi : turn;
    };
    std::vector<std::pair<double, std::uint32_t>> turns;
    for (const std::uint32_t h : around) turns.push_back({angle(h), h});
    std::ranges::sort(turns);
    for (std::size_t i = 0; i < turns.size(); ++i) around[i] = turns[i].second;
  }

  void join(std::uint32_t down, std::uint32_t up) {
    corners_.join(down, next(up));
    corners_.join(next(down), up);
  }

  PocketMesh mesh() {
    PocketMesh out;
    std::vector<std::uint32_t> numbers(3 * triangles_.size(), kNoIndex);  // by set of corners
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      Triangle triangle;
      for (std::uint32_t k = 0; k < 3; ++k) {
        std::uint32_t& number = numbers[corners_.find(3 * t + k)];
        if (number == kNoIndex) {
          number = static_cast<std::uint32_t>(out.mesh.positions.size());
          out.mesh.positions.push_back(at(start(3 * t + k)));
          out.mesh.vertex_spheres.push_back(walls_.labels[start(3 * t + k)]);
        }
        triangle[k] = number;
      }
      out.mesh.triangles.push_back(triangle);
      out.mesh.triangle_spheres.push_back(triangles_[t].sphere);
      out.parts.push_back(triangles_[t].part);
    }
    return out;
  }

  const WallMesh& walls_;
  const std::vector<RoomTriangle>& triangles_;
  DisjointSets corners_;
};

}  // namespace

std::optional<PocketMesh> close_room(const WallMesh& walls,
                                     const std::vector<RoomTriangle>& triangles) {
  return RoomCloser(walls, triangles).run();
}

}  // namespace vdwmesh
