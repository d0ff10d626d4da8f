// number_edges_together(): most half-edges have their opposites in the same piece. The others,
// called open, are sent to the rank that owns the edge's vertex of lower number. There the two of
// an edge meet, and each sender is told the opposite. A prefix sum over the counts of own edges
// gives each rank its first number. The owner of an edge on a border then tells the edge's number
// to the rank of the upper half-edge.
#include "distributed/together/edges_together.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/blocks.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "refine/half_edges.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {
namespace {

// A half-edge whose opposite is not in its piece, by numbers of the whole mesh.
struct OpenHalfEdge {
  std::uint64_t from, to, half_edge;
  SphereId sphere;  // of its triangle; kNoSphere if triangles have no labels
};

// What the sender of an open half-edge is told.
struct Opposite {
  std::uint64_t half_edge;
  SphereId sphere;
};

// What the owner of an edge says to the owner of its upper half-edge.
struct ToldEdge {
  std::uint64_t half_edge, edge;
};

// An open half-edge at the rank where the two of an edge meet.
struct MetHalfEdge {
  OpenHalfEdge what;
  std::size_t rank, place;  // who sent it, and where it stands in that message

  std::pair<std::uint64_t, std::uint64_t> ends() const { return std::minmax(what.from, what.to); }
};

using ByRank = std::vector<std::vector<Opposite>>;

// Answers each half-edge by its opposite.
ByRank answer(const std::vector<std::vector<OpenHalfEdge>>& received) {
  std::vector<MetHalfEdge> met;
  ByRank answers(received.size());
  for (std::size_t rank = 0; rank < received.size(); ++rank) {
    answers[rank].resize(received[rank].size());
    for (std::size_t i = 0; i < received[rank].size(); ++i) {
      met.push_back({received[rank][i], rank, i});
    }
  }
  std::ranges::sort(met, {}, [](const MetHalfEdge& m) { return m.ends(); });
  for (std::size_t i = 0; i < met.size(); i += 2) {
    const bool is_pair = i + 1 < met.size() && met[i].what.from == met[i + 1].what.to &&
                         met[i].what.to == met[i + 1].what.from &&
                         (i + 2 == met.size() || met[i + 2].ends() != met[i].ends());
    if (!is_pair) throw InternalError("the mesh of all ranks is not closed or not oriented");
    const MetHalfEdge &a = met[i], &b = met[i + 1];
    answers[a.rank][a.place] = {b.what.half_edge, b.what.sphere};
    answers[b.rank][b.place] = {a.what.half_edge, a.what.sphere};
  }
  return answers;
}

class EdgeNumberer {
 public:
  EdgeNumberer(const Ranks& ranks, const SurfacePiece& piece)
      : ranks_(ranks), piece_(piece), first_(3 * piece.first_triangle) {}

  NumberedEdges run() {
    first_triangles_ = ranks_.of_all(piece_.first_triangle);
    ranks_.together([&] { find_open(); });
    const std::vector<std::vector<OpenHalfEdge>> met = ranks_.exchange(open_);
    ByRank answers;
    ranks_.together([&] { answers = answer(met); });
    opposites_ = ranks_.exchange(answers);
    ranks_.together([&] {
      number_own();
      if (piece_.labels == TriangleLabels::spheres) find_other_spheres();
    });
    edges_.first = ranks_.sum_before(std::uint64_t{edges_.own});
    std::vector<std::vector<ToldEdge>> told;
    ranks_.together([&] { told = edges_to_tell(); });
    const std::vector<std::vector<ToldEdge>> heard = ranks_.exchange(told);
    ranks_.together([&] { number_others(heard); });
    return std::move(edges_);
  }

 private:
  SphereId sphere_of(std::size_t triangle) const {
    return piece_.labels == TriangleLabels::spheres ? piece_.mesh.triangle_spheres[triangle]
                                                    : kNoSphere;
  }

  void find_open() {
    opposite_ =
        match_half_edges(piece_.mesh.triangles, piece_.numbers.own() + piece_.elsewhere.size());
    open_.resize(static_cast<std::size_t>(ranks_.count()));
    for (std::size_t h = 0; h < opposite_.size(); ++h) {
      if (opposite_[h] != kUnmatched) continue;
      const Triangle& corners = piece_.mesh.triangles[h / 3];
      const std::uint64_t from = piece_.number_of(corners[h % 3]),
                          to = piece_.number_of(corners[(h + 1) % 3]);
      open_[piece_.numbers.owner_of(std::min(from, to))].push_back(
          {from, to, first_ + h, sphere_of(h / 3)});
    }
  }

  // Calls visit(half-edge of the piece, its opposite) for all open half-edges.
  template <class Visit>
  void for_each_open(const Visit& visit) const {
    for (std::size_t rank = 0; rank < open_.size(); ++rank) {
      for (std::size_t i = 0; i < open_[rank].size(); ++i) {
        visit(static_cast<std::size_t>(open_[rank][i].half_edge - first_), opposites_[rank][i]);
      }
    }
  }

  // Numbers the edges whose lower half-edge is of this rank.
  void number_own() {
    const std::size_t count = opposite_.size();
    edges_.edge.resize(count);
    edges_.is_lower.resize(count);
    for_all(count, [&](std::size_t h) {
      edges_.is_lower[h] = opposite_[h] != kUnmatched && h < opposite_[h] ? 1 : 0;
    });
    for_each_open([&](std::size_t h, const Opposite& opposite) {
      edges_.is_lower[h] = first_ + h < opposite.half_edge ? 1 : 0;
    });
    edges_.own = number_all(
        count, [&](std::size_t h) { return edges_.is_lower[h] != 0; },
        [&](std::size_t h, std::uint32_t number) {
          edges_.edge[h] = number;
          if (opposite_[h] != kUnmatched) edges_.edge[opposite_[h]] = number;
        });
  }

  void find_other_spheres() {
    edges_.other_sphere.resize(opposite_.size());
    for_all(opposite_.size(), [&](std::size_t h) {
      if (opposite_[h] != kUnmatched) edges_.other_sphere[h] = sphere_of(opposite_[h] / 3);
    });
    for_each_open(
        [&](std::size_t h, const Opposite& opposite) { edges_.other_sphere[h] = opposite.sphere; });
  }

  // A rank without triangles begins where the next one does, so the last rank that begins there has
  // it.
  std::size_t owner_of_half_edge(std::uint64_t half_edge) const {
    const auto behind = std::ranges::upper_bound(first_triangles_, half_edge / 3);
    return static_cast<std::size_t>(behind - first_triangles_.begin()) - 1;
  }

  std::vector<std::vector<ToldEdge>> edges_to_tell() const {
    std::vector<std::vector<ToldEdge>> told(open_.size());
    for_each_open([&](std::size_t h, const Opposite& opposite) {
      if (edges_.is_lower[h] == 0) return;
      told[owner_of_half_edge(opposite.half_edge)].push_back(
          {opposite.half_edge, edges_.first + edges_.edge[h]});
    });
    return told;
  }

  // Each of these edges has one half-edge here.
  void number_others(const std::vector<std::vector<ToldEdge>>& heard) {
    std::vector<ToldEdge> all;
    for (const std::vector<ToldEdge>& from : heard) all.insert(all.end(), from.begin(), from.end());
    std::ranges::sort(all, {}, &ToldEdge::edge);
    for (const ToldEdge& told : all) {
      edges_.edge[told.half_edge - first_] =
          static_cast<std::uint32_t>(edges_.own + edges_.elsewhere.size());
      edges_.elsewhere.push_back(told.edge);
    }
  }

  const Ranks& ranks_;
  const SurfacePiece& piece_;
  const std::uint64_t first_;                    // of the half-edges of the piece in the whole mesh
  std::vector<std::uint64_t> first_triangles_;   // [rank]
  Buffer<std::uint32_t> opposite_;               // kUnmatched for open half-edges
  std::vector<std::vector<OpenHalfEdge>> open_;  // [rank at which they meet]
  ByRank opposites_;                             // of open_
  NumberedEdges edges_;
};

}  // namespace

NumberedEdges number_edges_together(const Ranks& ranks, const SurfacePiece& piece) {
  return EdgeNumberer(ranks, piece).run();
}

// Local numbers of the vertices of the children: first come the own vertices of the parent, then
// the own midpoints, then the vertices of other ranks: those that the parent has, and behind them
// the midpoints, because the numbers in `elsewhere` must ascend.
void make_children(const NumberedEdges& edges, std::span<const std::uint64_t> counts,
                   SurfacePiece& piece) {
  const std::size_t parents = piece.numbers.own();
  const std::uint64_t whole = piece.numbers.whole();
  piece.numbers.append(counts);
  const std::size_t own = piece.numbers.own(), others = piece.elsewhere.size();
  if (own + others + edges.elsewhere.size() > kMaxVertices) {
    throw LimitExceeded("a rank has more than 2^32 vertices to refine: more ranks would do");
  }
  const auto vertex = [=](std::uint32_t corner) {
    return static_cast<std::uint32_t>(corner < parents ? corner : corner + (own - parents));
  };
  const auto middle = [=](std::uint32_t edge) {
    return static_cast<std::uint32_t>(edge < own - parents ? parents + edge
                                                           : parents + others + edge);
  };
  IndexedMesh& mesh = piece.mesh;
  const Buffer<Triangle> parent = std::exchange(mesh.triangles, {});
  const Buffer<SphereId> spheres = std::exchange(mesh.triangle_spheres, {});
  mesh.triangles.resize(4 * parent.size());
  mesh.triangle_spheres.resize(4 * spheres.size());
  for_all(parent.size(), [&](std::size_t t) {
    std::array<std::uint32_t, 6> patch;
    for (std::size_t k = 0; k < 3; ++k) {
      patch[k] = vertex(parent[t][k]);
      patch[k + 3] = middle(edges.edge[3 * t + k]);
    }
    for (int child = 0; child < 4; ++child) {
      Triangle& corners = mesh.triangles[4 * t + static_cast<std::size_t>(child)];
      for (int k = 0; k < 3; ++k) {
        corners[static_cast<std::size_t>(k)] =
            patch[static_cast<std::size_t>(child_corner(child, k))];
      }
    }
    if (!spheres.empty()) std::fill_n(&mesh.triangle_spheres[4 * t], 4, spheres[t]);
  });
  for (const std::uint64_t edge : edges.elsewhere) piece.elsewhere.push_back(whole + edge);
  piece.first_triangle *= 4;
  piece.whole = {piece.numbers.whole(), 4 * piece.whole.triangles};
}

}  // namespace vdwmesh
