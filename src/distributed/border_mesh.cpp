// make_border_mesh(): a rank sends each of its triangles that has vertices of other ranks to the
// owners of these vertices. With the triangles that arrive it knows all vertices of its part. It
// names them to their owners (halo.hpp), which send their positions. The vertices of a part are
// sorted by owner, then by number: so the own vertices are one run, and all ranks agree which of
// two vertices comes first.
#include "distributed/border_mesh.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/large_pages.hpp"
#include "distributed/sorted_numbers.hpp"

namespace vdwmesh {
namespace {

// The numbers of the corners in the whole mesh.
using NumberedTriangle = std::array<std::uint64_t, 3>;

class Builder {
 public:
  Builder(const Ranks& ranks, const SurfacePiece& piece)
      : ranks_(ranks),
        piece_(piece),
        self_(static_cast<std::size_t>(ranks.number())),
        own_(piece.numbers.own()) {}

  BorderMesh run() {
    std::vector<std::vector<NumberedTriangle>> sent;
    ranks_.together([&] { sent = triangles_for_owners(); });
    const std::vector<std::vector<NumberedTriangle>> received = ranks_.exchange(sent);
    sent.clear();
    ranks_.together([&] { find_vertices_elsewhere(received); });
    const std::vector<std::vector<std::uint64_t>> asked_for = ranks_.exchange(elsewhere_);
    BorderMesh result;
    ranks_.together([&] { build(received, asked_for, result); });
    result.halo.refresh(ranks_, result.mesh.positions);
    return result;
  }

 private:
  bool is_own(std::uint32_t corner) const { return corner < own_; }

  // A triangle goes once to each other owner of one of its corners.
  std::vector<std::vector<NumberedTriangle>> triangles_for_owners() const {
    std::vector<std::vector<NumberedTriangle>> sent(static_cast<std::size_t>(ranks_.count()));
    for (const Triangle& corners : piece_.mesh.triangles) {
      const auto& [a, b, c] = corners;
      if (is_own(a) && is_own(b) && is_own(c)) continue;
      const NumberedTriangle numbers{piece_.number_of(a), piece_.number_of(b), piece_.number_of(c)};
      std::array<std::size_t, 3> owners;
      for (std::size_t k = 0; k < 3; ++k) {
        owners[k] = is_own(corners[k]) ? self_ : piece_.numbers.owner_of(numbers[k]);
      }
      std::ranges::sort(owners);
      for (std::size_t k = 0; k < owners.size(); ++k) {
        const bool again = k > 0 && owners[k] == owners[k - 1];
        if (!again && owners[k] != self_) sent[owners[k]].push_back(numbers);
      }
    }
    return sent;
  }

  void find_vertices_elsewhere(const std::vector<std::vector<NumberedTriangle>>& received) {
    elsewhere_.resize(static_cast<std::size_t>(ranks_.count()));
    const auto add = [&](std::uint64_t number) {
      elsewhere_[piece_.numbers.owner_of(number)].push_back(number);
    };
    for (const std::uint64_t number : piece_.elsewhere) add(number);
    for (const std::vector<NumberedTriangle>& from : received) {
      for (const NumberedTriangle& corners : from) {
        for (const std::uint64_t number : corners) {
          if (!piece_.numbers.own_vertex(number)) add(number);
        }
      }
    }
    std::size_t all = 0;
    for (std::size_t rank = 0; rank < elsewhere_.size(); ++rank) {
      if (rank == self_) before_ = all;
      sort_without_repeats(elsewhere_[rank]);
      begins_.push_back(all);
      all += elsewhere_[rank].size();
    }
    vertices_ = all + own_;
    if (vertices_ <= kMaxVertices) return;
    throw LimitExceeded(
        "a rank has more than 2^32 vertices to measure or refine: more ranks would do");
  }

  // The index of a vertex in the part.
  std::uint32_t local_of(std::uint64_t number) const {
    if (const auto own = piece_.numbers.own_vertex(number)) return local_of_own(*own);
    const std::size_t rank = piece_.numbers.owner_of(number);
    const std::size_t place = begins_[rank] + place_in(elsewhere_[rank], number);
    return static_cast<std::uint32_t>(rank < self_ ? place : place + own_);
  }
  std::uint32_t local_of_own(std::size_t own_vertex) const {
    return static_cast<std::uint32_t>(before_ + own_vertex);
  }

  void build(const std::vector<std::vector<NumberedTriangle>>& received,
             const std::vector<std::vector<std::uint64_t>>& asked_for, BorderMesh& result) const {
    result.first_vertex = before_;
    result.end_vertex = before_ + own_;
    result.triangles = piece_.mesh.triangle_count();
    result.halo = {all_local_of(elsewhere_), all_local_of(asked_for)};
    resize_untouched(result.mesh.positions, vertices_);
    for_each_index(own_, [&](std::size_t v) {
      result.mesh.positions[before_ + v] = piece_.mesh.positions[v];
    });
    fill_triangles(received, result.mesh.triangles);
  }

  std::vector<std::vector<std::uint32_t>> all_local_of(
      const std::vector<std::vector<std::uint64_t>>& numbers) const {
    std::vector<std::vector<std::uint32_t>> local(numbers.size());
    for (std::size_t rank = 0; rank < numbers.size(); ++rank) {
      for (const std::uint64_t number : numbers[rank]) local[rank].push_back(local_of(number));
    }
    return local;
  }

  void fill_triangles(const std::vector<std::vector<NumberedTriangle>>& received,
                      Buffer<Triangle>& triangles) const {
    std::vector<std::uint32_t> local_of_elsewhere;
    for (const std::uint64_t number : piece_.elsewhere) {
      local_of_elsewhere.push_back(local_of(number));
    }
    const std::size_t own = piece_.mesh.triangle_count();
    std::size_t count = own;
    for (const auto& from : received) count += from.size();
    resize_untouched(triangles, count);
    for_each_index(own, [&](std::size_t t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t corner = piece_.mesh.triangles[t][k];
        triangles[t][k] = is_own(corner) ? local_of_own(corner) : local_of_elsewhere[corner - own_];
      }
    });
    std::size_t next = own;
    for (const auto& from : received) {
      for (const auto& [a, b, c] : from)
        triangles[next++] = {local_of(a), local_of(b), local_of(c)};
    }
  }

  const Ranks& ranks_;
  const SurfacePiece& piece_;
  const std::size_t self_, own_;                       // this rank, and how many vertices it owns
  std::vector<std::vector<std::uint64_t>> elsewhere_;  // [owner]: numbers of vertices of the part
  std::vector<std::size_t> begins_;  // [owner]: how many vertices the owners before it have there
  std::size_t before_ = 0;           // vertices that come before the own ones
  std::size_t vertices_ = 0;         // of the part
};

}  // namespace

BorderMesh make_border_mesh(const Ranks& ranks, const SurfacePiece& piece) {
  return Builder(ranks, piece).run();
}

}  // namespace vdwmesh
