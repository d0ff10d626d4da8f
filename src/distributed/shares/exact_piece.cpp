// mesh_union_together(): the ranks are the team of a mesher (creases/share/mesh_team.hpp).
//
// A mesh that the team takes gets its numbers from prefix sums over the runs of all ranks. If
// corners were joined, the owner of a corner gathers its wedges from all ranks and parts its fans;
// the copies become one more generation of vertices, and the ranks that have the triangles learn
// the numbers.
#include "distributed/shares/exact_piece.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "creases/share/mesh_team.hpp"
#include "creases/share/patch_device.hpp"
#include "creases/share/split_fans.hpp"
#include "distributed/together/examine_together.hpp"
#include "distributed/together/sorted_numbers.hpp"

namespace vdwmesh {
namespace {

// A wedge, and the number of its vertex.
struct CornerWedge {
  std::uint64_t vertex;
  Wedge wedge;
};

// The corner of a triangle, both by number, goes to another vertex.
struct MovedCorner {
  std::uint64_t triangle, vertex;
  std::uint32_t corner;
};

// The wedges of the triangles of a piece at the first `count` vertices of the whole mesh, by the
// ranks that own these.
std::vector<std::vector<CornerWedge>> wedges_at(const SurfacePiece& piece, std::uint64_t count,
                                                std::size_t ranks) {
  std::vector<std::vector<CornerWedge>> by_owner(ranks);
  const IndexedMesh& mesh = piece.mesh;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    std::array<std::uint64_t, 3> v;
    for (std::size_t k = 0; k < 3; ++k) v[k] = piece.number_of(mesh.triangles[t][k]);
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (v[k] >= count) continue;
      by_owner[piece.numbers.owner_of(v[k])].push_back(
          {v[k],
           {piece.first_triangle + t, k, mesh.triangle_spheres[t], v[(k + 1) % 3],
            v[(k + 2) % 3]}});
    }
  }
  return by_owner;
}

// Parts the fans of joined corners. Collective.
class FanParting {
 public:
  FanParting(const Ranks& ranks, SurfacePiece& piece) : ranks_(ranks), piece_(piece) {}

  void run(std::uint64_t joined_corners) {
    std::vector<std::vector<CornerWedge>> told, heard;
    ranks_.together([&] { told = wedges_at(piece_, joined_corners, ranks()); });
    heard = ranks_.exchange(told);
    ranks_.together([&] { part_own(heard); });
    const std::vector<std::uint64_t> copies = ranks_.of_all(std::uint64_t{copies_});
    ranks_.together([&] { append_copies(copies); });
    const std::vector<std::vector<MovedCorner>> moved = ranks_.exchange(moved_);
    ranks_.together([&] { move_corners(moved); });
  }

 private:
  std::size_t ranks() const { return static_cast<std::size_t>(ranks_.count()); }

  struct Arrived {
    CornerWedge at;
    std::size_t rank;  // that has the triangle
  };

  // Finds the fans of the own corners. The vertices of moved_ count copies from 0 on;
  // append_copies() adds the number of the first one.
  void part_own(const std::vector<std::vector<CornerWedge>>& heard) {
    std::vector<Arrived> all;
    for (std::size_t rank = 0; rank < heard.size(); ++rank) {
      for (const CornerWedge& w : heard[rank]) all.push_back({w, rank});
    }
    std::ranges::sort(all, {}, [](const Arrived& a) {
      return std::tuple(a.at.vertex, a.at.wedge.triangle, a.at.wedge.corner);
    });
    moved_.resize(ranks());
    std::vector<Wedge> wedges;
    for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
      wedges.clear();
      for (end = begin; end < all.size() && all[end].at.vertex == all[begin].at.vertex; ++end) {
        wedges.push_back(all[end].at.wedge);
      }
      part_corner(std::span(all).subspan(begin, end - begin), wedges);
    }
  }

  void part_corner(std::span<const Arrived> arrived, const std::vector<Wedge>& wedges) {
    IndexedMesh& mesh = piece_.mesh;
    const std::size_t vertex = piece_.numbers.own_vertex(arrived.front().at.vertex).value();
    const Fans fans = fans_of(wedges, mesh.vertex_spheres[vertex]);
    mesh.vertex_spheres.set(vertex, fans.labels.front());
    for (std::size_t fan = 1; fan < fans.labels.size(); ++fan) {
      mesh.positions.push_back(Vec3d(mesh.positions[vertex]));
      mesh.normals.push_back(Vec3f(mesh.normals[vertex]));
      mesh.vertex_spheres.push_back(fans.labels[fan]);
    }
    for (std::size_t w = 0; w < wedges.size(); ++w) {
      if (fans.of_wedge[w] == 0) continue;
      moved_[arrived[w].rank].push_back(
          {wedges[w].triangle, copies_ + fans.of_wedge[w] - 1, wedges[w].corner});
    }
    copies_ += fans.labels.size() - 1;
  }

  // Gives the copies their numbers. The local numbers of vertices elsewhere grow by the number of
  // own copies.
  void append_copies(const std::vector<std::uint64_t>& copies) {
    const std::size_t before = piece_.numbers.own();
    piece_.numbers.append(copies);
    const std::size_t own = piece_.numbers.own();
    piece_.whole.vertices = piece_.numbers.whole();
    check_vertices();
    for (auto& of_rank : moved_) {
      for (MovedCorner& m : of_rank) m.vertex += piece_.numbers.runs().back().first;
    }
    for_each_index(piece_.mesh.triangle_count(), [&](std::size_t t) {
      for (std::uint32_t& v : piece_.mesh.triangles[t]) {
        if (v >= before) v = static_cast<std::uint32_t>(v + (own - before));
      }
    });
  }

  // The copies of other ranks come after all vertices elsewhere that there were.
  void move_corners(const std::vector<std::vector<MovedCorner>>& moved) {
    std::vector<std::uint64_t> elsewhere;
    for (const auto& of_rank : moved) {
      for (const MovedCorner& m : of_rank) {
        if (!piece_.numbers.own_vertex(m.vertex)) elsewhere.push_back(m.vertex);
      }
    }
    sort_without_repeats(elsewhere);
    piece_.elsewhere.insert(piece_.elsewhere.end(), elsewhere.begin(), elsewhere.end());
    check_vertices();
    for (const auto& of_rank : moved) {
      for (const MovedCorner& m : of_rank) {
        const std::size_t local = piece_.numbers.own_vertex(m.vertex).value_or(
            piece_.numbers.own() + place_in(piece_.elsewhere, m.vertex));
        piece_.mesh.triangles[m.triangle - piece_.first_triangle][m.corner] =
            static_cast<std::uint32_t>(local);
      }
    }
  }

  // Corners of triangles number the own vertices and those elsewhere in 32 bits.
  void check_vertices() const {
    if (piece_.numbers.own() + piece_.elsewhere.size() <= kMaxVertices) return;
    throw LimitExceeded("the triangles of one rank have more than 2^32 vertices");
  }

  const Ranks& ranks_;
  SurfacePiece& piece_;
  std::uint64_t copies_ = 0;                     // of own corners
  std::vector<std::vector<MovedCorner>> moved_;  // by rank
};

class AllRanks final : public MeshTeam {
 public:
  explicit AllRanks(const Ranks& ranks) : ranks_(ranks) {}

  std::size_t count() const override { return static_cast<std::size_t>(ranks_.count()); }
  std::size_t number() const override { return static_cast<std::size_t>(ranks_.number()); }
  void together(const std::function<void()>& work) const override { ranks_.together(work); }
  std::uint64_t sum(std::uint64_t mine) const override { return ranks_.sum(mine); }
  std::uint64_t sum_before(std::uint64_t mine) const override { return ranks_.sum_before(mine); }
  std::vector<std::vector<std::uint64_t>> exchange(
      const std::vector<std::vector<std::uint64_t>>& to_each) const override {
    return ranks_.exchange(to_each);
  }
  std::uint32_t least(std::uint32_t mine) const override {
    return std::ranges::min(ranks_.of_all(mine));
  }
  void merge(std::vector<PieceSplit>& splits) const override {
    std::vector<PieceSplit> all = ranks_.collect(std::span<const PieceSplit>(splits));
    ranks_.together([&] { merge_splits(all); });
    ranks_.share(all);
    splits = std::move(all);
  }

  void take(UnnumberedPiece&& piece, std::uint64_t joined_corners) override {
    taken_ = SurfacePiece();
    taken_.numbers = VertexNumbers(number());
    for (const std::uint64_t own : piece.own) taken_.numbers.append(ranks_.of_all(own));
    const auto triangles = static_cast<std::uint64_t>(piece.mesh.triangle_count());
    taken_.first_triangle = ranks_.sum_before(triangles);
    taken_.whole = {taken_.numbers.whole(), ranks_.sum(triangles)};
    taken_.mesh = std::move(piece.mesh);
    taken_.labels = TriangleLabels::spheres;
    taken_.elsewhere = std::move(piece.elsewhere);
    if (joined_corners > 0) FanParting(ranks_, taken_).run(joined_corners);
  }

  SurfaceTopology topology() override {
    const MeshTopology found = examine_together(ranks_, taken_).topology;
    const auto isolated = static_cast<std::int64_t>(found.isolated_vertices);
    return ranks_.shared(SurfaceTopology{found.euler_characteristic + isolated,
                                         static_cast<std::int64_t>(found.shells) + isolated});
  }

  void keep() override { kept_ = std::move(taken_); }
  std::uint64_t kept_bytes() const override { return indexed_mesh_bytes(kept_.mesh); }

  SurfacePiece result() && { return std::move(kept_); }

 private:
  const Ranks& ranks_;
  SurfacePiece taken_, kept_;
};

}  // namespace

ExactPiece mesh_union_together(const Ranks& ranks, const SphereSet& spheres,
                               const ExactMeshOptions& options) {
  AllRanks team(ranks);
  const ExactMeshStats stats = mesh_union_by(team, nullptr, spheres, options);
  return {std::move(team).result(), stats};
}

}  // namespace vdwmesh
