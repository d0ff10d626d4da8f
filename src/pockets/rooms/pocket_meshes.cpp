// pocket_meshes(): the crease-exact mesh of the union is cut along the mouths; the parts of it that
// the rims enclose are the walls, and with the mouths' triangles they are closed. The walls of
// voids are whole pieces of that mesh.
//
// What is smaller than the triangles may be cut in a way that does not close. Such pockets are cut
// again in a finer mesh.
#include "pockets/pocket_meshes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "complex/power_triangulation.hpp"
#include "core/disjoint_sets.hpp"
#include "core/monitor.hpp"
#include "core/sum.hpp"
#include "creases/exact_mesher.hpp"
#include "pockets/rooms/close_room.hpp"
#include "pockets/rooms/mouth_plane.hpp"
#include "pockets/rooms/wall_mesh.hpp"

namespace vdwmesh {
namespace {

using PocketIndex = std::uint32_t;

// Å²: of a closed mesh, and Å³.
struct RoomSize {
  double area, volume;
};

RoomSize size_of(const IndexedMesh& mesh) {
  WideSum area, volume;
  const Vec3d origin = mesh.positions.empty() ? Vec3d{} : mesh.positions[0];
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3d a = mesh.positions[i] - origin, b = mesh.positions[j] - origin,
                c = mesh.positions[k] - origin;
    area.add(norm(cross(b - a, c - a)) / 2);
    volume.add(dot(a, cross(b, c)) / 6);
  }
  return {area.value(), volume.value()};
}

class RoomMesher {
 public:
  RoomMesher(const SphereSet& spheres, std::span<const Pocket> pockets,
             const PocketMeshOptions& options)
      : spheres_(spheres), pockets_(pockets), options_(options), out_(pockets.size()) {}

  std::vector<PocketMesh> run() && {
    constexpr int kAttempts = 6;
    constexpr double kFiner = 0.4;
    const IndexedMesh mesh = mesh_union(spheres_, {.edge_length = options_.edge_length,
                                                   .memory_limit = options_.memory_limit,
                                                   .monitor = options_.monitor})
                                 .mesh;
    std::vector<PocketIndex> open(pockets_.size());
    std::iota(open.begin(), open.end(), 0u);
    double share = 1;
    for (int i = 0; i < kAttempts && !open.empty(); ++i, share *= kFiner) {
      advance(options_.monitor, 0);
      open = attempt(mesh, open, share);
    }
    return std::move(out_);
  }

 private:
  // Meshes these pockets, with edges that share of their length along the rims. Returns those that
  // did not close.
  std::vector<PocketIndex> attempt(const IndexedMesh& mesh, const std::vector<PocketIndex>& wanted,
                                   double share) {
    WallMesh walls(spheres_, mesh);
    std::vector<MouthPlane> planes = planes_of(wanted, share);
    const std::vector<std::uint8_t> is_cut = cut_walls(walls, spheres_, planes);
    std::map<PocketIndex, std::vector<RoomTriangle>> rooms;
    for (auto& [p, wall] : walls_of(walls, wanted, planes)) {
      walls.divide_longer(wall, longest_of(p));
      for (const std::uint32_t t : wall) {
        const auto& [a, b, c] = walls.triangles[t];
        rooms[p].push_back({{a, c, b}, walls.triangle_spheres[t], 0});
      }
    }
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const MouthPlane& m = planes[i];
      const auto room = rooms.find(m.pocket);
      if (room == rooms.end() || m.rim.empty()) continue;
      const auto filled = fill_mouth(walls, m, m.edge_length);
      if (!is_cut[i] || filled.empty()) {
        rooms.erase(room);
        continue;
      }
      for (const Triangle& t : filled) room->second.push_back({t, kNoSphere, m.part});
    }
    std::vector<PocketIndex> open;
    for (const PocketIndex p : wanted) {
      const auto room = rooms.find(p);
      auto closed = room == rooms.end() ? std::nullopt : close_room(walls, room->second);
      if (closed && is_plausible(p, closed->mesh)) {
        out_[p] = std::move(*closed);
      } else {
        open.push_back(p);
      }
    }
    return open;
  }

  // Å: longest edge of a pocket's wall. Small ones get a hundred triangles too.
  double longest_of(PocketIndex p) const {
    constexpr double kOfWall = 0.15;
    return std::min(2 * options_.edge_length, kOfWall * std::sqrt(pockets_[p].area));
  }

  // Flat triangles on spheres leave out less than this.
  bool is_plausible(PocketIndex p, const IndexedMesh& mesh) const {
    const RoomSize size = size_of(mesh);
    const double missed = std::abs(size.volume - pockets_[p].volume);
    return mesh.triangle_count() > 0 && missed <= 0.1 * options_.edge_length * size.area;
  }

  // Rims of small mouths get several edges.
  std::vector<MouthPlane> planes_of(const std::vector<PocketIndex>& wanted, double share) const {
    constexpr double kOfMouth = 0.3, kShortest = 1e-3;
    std::vector<MouthPlane> planes;
    for (const PocketIndex p : wanted) {
      std::uint32_t part = 0;
      for (const Mouth& mouth : pockets_[p].mouths) {
        ++part;
        const double longest = std::clamp(kOfMouth * std::sqrt(mouth.area),
                                          kShortest * options_.edge_length, options_.edge_length);
        for (const auto& balls : mouth.triangles) {
          const Vec3d a = center(balls[0]), b = center(balls[1]), c = center(balls[2]);
          const Vec3d normal = cross(b - a, c - a);
          planes.push_back({.pocket = p,
                            .part = part,
                            .balls = balls,
                            .corners = {a, b, c},
                            .plane = {1 / norm(normal) * normal, a},
                            .edge_length = share * longest});
        }
      }
    }
    return planes;
  }

  const Vec3d& center(SphereId s) const { return spheres_[s].center; }

  // The triangles of the walls that the rims of a pocket enclose, and of pieces without a rim that
  // are in it. Pockets whose rims enclose nothing, or the outside, are missing.
  std::map<PocketIndex, std::vector<std::uint32_t>> walls_of(
      const WallMesh& walls, const std::vector<PocketIndex>& wanted,
      const std::vector<MouthPlane>& planes) const {
    std::map<Step, PocketIndex> rims;  // by half-edges on the pockets' side
    for (const MouthPlane& m : planes) {
      for (const Step& s : m.rim) rims[s] = m.pocket;
    }
    std::unordered_map<std::uint32_t, PocketIndex> pocket_of;  // by piece
    std::vector<std::uint8_t> is_wrong(pockets_.size(), 0);
    DisjointSets pieces = pieces_of(walls, rims);
    const auto is_rim = [&](const Step& s) {
      return rims.contains(s) || rims.contains({s[1], s[0]});
    };
    std::vector<std::pair<std::uint32_t, PocketIndex>> beyond;  // pieces outside of a rim
    for (std::uint32_t t = 0; t < walls.triangles.size(); ++t) {
      const Triangle& v = walls.triangles[t];
      for (std::size_t k = 0; k < 3; ++k) {
        const Step step{v[k], v[(k + 1) % 3]};
        if (!is_on_rim(walls, step) || !is_rim(step)) continue;
        const auto inner = rims.find(step);
        if (inner == rims.end()) {
          beyond.push_back({pieces.find(t), rims.at({step[1], step[0]})});
          continue;
        }
        const auto [known, is_new] = pocket_of.try_emplace(pieces.find(t), inner->second);
        if (known->second != inner->second) is_wrong[inner->second] = is_wrong[known->second] = 1;
      }
    }
    for (const auto& [piece, p] : beyond) {
      const auto known = pocket_of.find(piece);
      if (known != pocket_of.end() && known->second == p) is_wrong[p] = 1;
      pocket_of.try_emplace(piece, kNoIndex);
    }
    std::map<PocketIndex, std::vector<std::uint32_t>> found;
    for (std::uint32_t t = 0; t < walls.triangles.size(); ++t) {
      const auto [known, is_new] = pocket_of.try_emplace(pieces.find(t), kNoIndex);
      if (is_new) known->second = pocket_around(walls, t, wanted);
      const PocketIndex p = known->second;
      if (p != kNoIndex && !is_wrong[p]) found[p].push_back(t);
    }
    return found;
  }

  static bool is_on_rim(const WallMesh& walls, const Step& s) {
    return walls.is_fixed[s[0]] && walls.is_fixed[s[1]];
  }

  // Triangles that are joined across edges which are no rims.
  static DisjointSets pieces_of(const WallMesh& walls, const std::map<Step, PocketIndex>& rims) {
    std::vector<std::pair<EdgeKey, std::uint32_t>> edges;
    for (std::uint32_t t = 0; t < walls.triangles.size(); ++t) {
      const Triangle& v = walls.triangles[t];
      for (std::size_t k = 0; k < 3; ++k) {
        const Step step{v[k], v[(k + 1) % 3]};
        if (is_on_rim(walls, step) && (rims.contains(step) || rims.contains({step[1], step[0]})))
          continue;
        edges.push_back({edge_key(step[0], step[1]), t});
      }
    }
    std::ranges::sort(edges);
    DisjointSets pieces(walls.triangles.size());
    for (std::size_t i = 1; i < edges.size(); ++i) {
      if (edges[i].first == edges[i - 1].first) pieces.join(edges[i - 1].second, edges[i].second);
    }
    return pieces;
  }

  // The pocket with a tetrahedron around a triangle of a piece without a rim, which is in one
  // pocket or outside. The triangle's middle is moved onto its sphere.
  PocketIndex pocket_around(const WallMesh& walls, std::uint32_t triangle,
                            const std::vector<PocketIndex>& wanted) const {
    const auto& [a, b, c] = walls.triangles[triangle];
    const auto middle =
        walls.onto(on_sphere(walls.triangle_spheres[triangle]),
                   1.0 / 3 * (walls.positions[a] + walls.positions[b] + walls.positions[c]));
    for (const PocketIndex p : wanted) {
      const auto holds = [&](const auto& cell) { return middle && contains(cell, *middle); };
      if (std::ranges::any_of(pockets_[p].cells, holds)) return p;
    }
    return kNoIndex;
  }

  bool contains(const std::array<SphereId, 4>& cell, const Vec3d& p) const {
    for (const auto& f : kFacetVertices) {
      const Vec3d a = center(cell[f[0]]);
      const Vec3d inward = cross(center(cell[f[1]]) - a, center(cell[f[2]]) - a);
      if (dot(inward, p - a) < 0) return false;
    }
    return true;
  }

  const SphereSet& spheres_;
  std::span<const Pocket> pockets_;
  const PocketMeshOptions& options_;
  std::vector<PocketMesh> out_;
};

}  // namespace

std::vector<PocketMesh> pocket_meshes(const SphereSet& spheres, std::span<const Pocket> pockets,
                                      const PocketMeshOptions& options) {
  if (!(options.edge_length > 0) || !std::isfinite(options.edge_length)) {
    throw InvalidInput(
        fmt::format("an edge length of {} Å: is above 0 and finite", options.edge_length));
  }
  if (pockets.empty()) return {};
  return RoomMesher(spheres, pockets, options).run();
}

}  // namespace vdwmesh
