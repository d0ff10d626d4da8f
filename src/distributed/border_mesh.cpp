// make_border_mesh(): the numbers of vertices say which rank owns them, because ranks own runs of
// numbers. A rank asks the owners for the positions of the vertices that it names but does not own,
// and sends them its triangles at these vertices. Vertices are then numbered anew, in the order of
// their numbers in the whole mesh.
#include "distributed/border_mesh.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

struct NumberedVertex {
  std::uint64_t number;  // in the whole mesh
  Vec3d position;
};

// A triangle with all that another rank has to know of it.
struct SentTriangle {
  std::array<NumberedVertex, 3> corners;
};

class Builder {
 public:
  Builder(const Ranks& ranks, const SurfacePiece& piece)
      : ranks_(ranks),
        piece_(piece),
        first_(piece.first.vertices),
        own_(piece.mesh.vertex_count()) {}

  BorderMesh run() {
    share_owners();
    ranks_.together([&] { find_vertices_elsewhere(); });
    asked_for_ = ranks_.exchange(elsewhere_);
    std::vector<std::vector<Vec3d>> answers;
    ranks_.together([&] { answers = positions_asked_for(); });
    const std::vector<std::vector<Vec3d>> positions = ranks_.exchange(answers);
    std::vector<std::vector<SentTriangle>> sent;
    ranks_.together([&] {
      keep_positions(positions);
      sent = triangles_for_owners();
    });
    const std::vector<std::vector<SentTriangle>> received = ranks_.exchange(sent);
    BorderMesh result;
    ranks_.together([&] { result = build(received); });
    return result;
  }

 private:
  // The numbers of the corners in the whole mesh.
  std::array<std::uint64_t, 3> numbers_of(const Triangle& corners) const {
    const auto& [a, b, c] = corners;
    return {piece_.number_of(a), piece_.number_of(b), piece_.number_of(c)};
  }

  // False for lower numbers too, from which the difference wraps around to a large one.
  bool is_own(std::uint64_t number) const { return number - first_ < own_; }

  // Ranks without vertices begin where the next one does.
  std::size_t owner_of(std::uint64_t number) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(firsts_, number) - firsts_.begin()) -
           1;
  }

  void share_owners() {
    firsts_ = ranks_.collect(std::span<const std::uint64_t>(&piece_.first.vertices, 1));
    ranks_.share(firsts_);
  }

  void find_vertices_elsewhere() {
    std::vector<std::uint64_t> numbers;
    for (const Triangle& corners : piece_.mesh.triangles) {
      for (const std::uint64_t number : numbers_of(corners)) {
        if (!is_own(number)) numbers.push_back(number);
      }
    }
    std::ranges::sort(numbers);
    numbers.erase(std::ranges::unique(numbers).begin(), numbers.end());
    elsewhere_.resize(static_cast<std::size_t>(ranks_.count()));
    for (const std::uint64_t number : numbers) elsewhere_[owner_of(number)].push_back(number);
  }

  std::vector<std::vector<Vec3d>> positions_asked_for() const {
    std::vector<std::vector<Vec3d>> positions(asked_for_.size());
    for (std::size_t rank = 0; rank < asked_for_.size(); ++rank) {
      for (const std::uint64_t number : asked_for_[rank]) {
        positions[rank].push_back(piece_.mesh.positions[number - first_]);
      }
    }
    return positions;
  }

  void keep_positions(const std::vector<std::vector<Vec3d>>& positions) {
    for (std::size_t rank = 0; rank < elsewhere_.size(); ++rank) {
      for (std::size_t i = 0; i < elsewhere_[rank].size(); ++i) {
        near_.push_back({elsewhere_[rank][i], positions[rank][i]});
      }
    }
  }

  // The place of a vertex in near_, which is sorted.
  std::size_t place_of(std::uint64_t number) const {
    return static_cast<std::size_t>(
        std::ranges::lower_bound(near_, number, {}, &NumberedVertex::number) - near_.begin());
  }

  NumberedVertex vertex(std::uint64_t number) const {
    return is_own(number) ? NumberedVertex{number, piece_.mesh.positions[number - first_]}
                          : near_[place_of(number)];
  }

  // A triangle goes once to each owner of one of its corners.
  std::vector<std::vector<SentTriangle>> triangles_for_owners() const {
    std::vector<std::vector<SentTriangle>> sent(elsewhere_.size());
    for (const Triangle& corners : piece_.mesh.triangles) {
      const auto [a, b, c] = numbers_of(corners);
      if (is_own(a) && is_own(b) && is_own(c)) continue;
      std::array<std::size_t, 3> owners{owner_of(a), owner_of(b), owner_of(c)};
      std::ranges::sort(owners);
      for (std::size_t k = 0; k < owners.size(); ++k) {
        const bool again = k > 0 && owners[k] == owners[k - 1];
        if (again || owners[k] == static_cast<std::size_t>(ranks_.number())) continue;
        sent[owners[k]].push_back({{vertex(a), vertex(b), vertex(c)}});
      }
    }
    return sent;
  }

  // Adds the vertices of the received triangles to those that are near.
  void add_near(const std::vector<std::vector<SentTriangle>>& received) {
    for (const std::vector<SentTriangle>& from : received) {
      for (const SentTriangle& triangle : from) {
        for (const NumberedVertex& v : triangle.corners) {
          if (!is_own(v.number)) near_.push_back(v);
        }
      }
    }
    std::ranges::sort(near_, {}, &NumberedVertex::number);
    const auto repeated = std::ranges::unique(near_, {}, &NumberedVertex::number);
    near_.erase(repeated.begin(), repeated.end());
  }

  std::uint32_t local_of(std::uint64_t number) const {
    if (is_own(number)) return static_cast<std::uint32_t>(before_ + (number - first_));
    const std::size_t place = place_of(number);
    return static_cast<std::uint32_t>(place < before_ ? place : place + own_);
  }

  void check_size() const {
    if (near_.size() + own_ <= kMaxVertices) return;
    throw LimitExceeded("a rank has more than 2^32 vertices to measure: more ranks would do");
  }

  BorderMesh build(const std::vector<std::vector<SentTriangle>>& received) {
    add_near(received);
    check_size();
    before_ = place_of(first_);
    BorderMesh result;
    result.first_vertex = before_;
    result.end_vertex = before_ + own_;
    result.triangles = piece_.mesh.triangle_count();
    fill_positions(result.mesh.positions);
    fill_triangles(received, result.mesh.triangles);
    result.elsewhere = border_vertices(elsewhere_);
    result.asked_for = border_vertices(asked_for_);
    return result;
  }

  void fill_positions(Buffer<Vec3d>& positions) const {
    positions.resize(near_.size() + own_);
    for (std::size_t i = 0; i < near_.size(); ++i) {
      positions[i < before_ ? i : i + own_] = near_[i].position;
    }
    std::ranges::copy(piece_.mesh.positions,
                      positions.begin() + static_cast<std::ptrdiff_t>(before_));
  }

  void fill_triangles(const std::vector<std::vector<SentTriangle>>& received,
                      Buffer<Triangle>& triangles) const {
    const std::size_t own = piece_.mesh.triangle_count();
    std::size_t count = own;
    for (const auto& from : received) count += from.size();
    triangles.resize(count);
    for_each_index(own, [&](std::size_t t) {
      const auto [a, b, c] = numbers_of(piece_.mesh.triangles[t]);
      triangles[t] = {local_of(a), local_of(b), local_of(c)};
    });
    std::size_t next = own;
    for (const auto& from : received) {
      for (const auto& [corners] : from) {
        triangles[next++] = {local_of(corners[0].number), local_of(corners[1].number),
                             local_of(corners[2].number)};
      }
    }
  }

  std::vector<BorderVertex> border_vertices(
      const std::vector<std::vector<std::uint64_t>>& by_rank) const {
    std::vector<BorderVertex> vertices;
    for (std::size_t rank = 0; rank < by_rank.size(); ++rank) {
      for (const std::uint64_t number : by_rank[rank]) {
        vertices.push_back({static_cast<int>(rank), local_of(number)});
      }
    }
    return vertices;
  }

  const Ranks& ranks_;
  const SurfacePiece& piece_;
  const std::uint64_t first_, own_;    // the own vertices are [first_, first_ + own_)
  std::vector<std::uint64_t> firsts_;  // the first vertex of every rank
  // [rank]: what this rank asks of it, and what it asks of this one.
  std::vector<std::vector<std::uint64_t>> elsewhere_, asked_for_;
  std::vector<NumberedVertex> near_;  // vertices of the part that are not own, by number
  std::size_t before_ = 0;            // those of near_ that come before the own ones
};

}  // namespace

BorderMesh make_border_mesh(const Ranks& ranks, const SurfacePiece& piece) {
  return Builder(ranks, piece).run();
}

}  // namespace vdwmesh
