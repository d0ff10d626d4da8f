// The part of a rank is its piece of the surface (SurfacePiece) with the triangles of other ranks
// at its border. A rank sends each of its triangles that has vertices of other ranks to the owners
// of these vertices. With the triangles that arrive it knows all vertices of its part. It names
// those of other ranks to their owners (Halo), which send their positions. Of two vertices the one
// whose owner is the lower rank is the smaller one, and of one owner's the one with the lower
// number: so all ranks agree (MeshPart), whatever indices the vertices have in a part.
#include "distributed/together/border_mesh.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/large_pages.hpp"
#include "distributed/together/sorted_numbers.hpp"

namespace vdwmesh {
namespace {

// The numbers of the corners in the whole mesh.
using NumberedTriangle = std::array<std::uint64_t, 3>;

// An array of `count` elements that begins with a copy of `own`. The other elements have no values.
template <class T>
Buffer<T> copied(const Buffer<T>& own, std::size_t count) {
  Buffer<T> all;
  resize_untouched(all, count);
  for_each_index(own.size(), [&](std::size_t i) { all[i] = own[i]; });
  return all;
}
// The same without a copy: takes the array `own` itself, which is left empty.
template <class T>
Buffer<T> taken(Buffer<T>& own, std::size_t count) {
  Buffer<T> all = std::move(own);
  all.reserve(count);  // resize() alone would double the memory of an array that lacks the room
  all.resize(count);
  return all;
}

class BorderBuilder {
 public:
  BorderBuilder(const Ranks& ranks, const SurfacePiece& piece)
      : ranks_(ranks),
        piece_(piece),
        self_(static_cast<std::size_t>(ranks.number())),
        own_(piece.numbers.own()) {}

  // Calls start(mesh, V) once it is known that the part has V vertices and triangles() triangles:
  // the function makes arrays of these sizes, which begin with the positions and triangles of the
  // piece. The rest of the elements are filled here. Collective.
  template <class Start>
  BorderMesh run(const Start& start) {
    exchange_triangles();
    ranks_.together([&] { find_elsewhere(); });
    const std::vector<std::vector<std::uint64_t>> asked_for = ranks_.exchange(named_);
    ranks_.together([&] {
      find_asked_for(asked_for);
      start(part_.mesh, own_ + elsewhere_.size());
      append_triangles();
    });
    part_.halo.refresh(ranks_, part_.mesh.positions);
    return std::move(part_);
  }

  // How many triangles the part has.
  std::size_t triangles() const {
    std::size_t count = part_.triangles;
    for (const auto& from : received_) count += from.size();
    return count;
  }

 private:
  bool is_own(std::uint32_t corner) const { return corner < own_; }

  // Collective.
  void exchange_triangles() {
    std::vector<std::vector<NumberedTriangle>> sent;
    ranks_.together([&] {
      find_border_triangles();
      sent = triangles_for_owners();
    });
    received_ = ranks_.exchange(sent);
  }

  void find_border_triangles() {
    const Buffer<Triangle>& triangles = piece_.mesh.triangles;
    part_.vertices = own_;
    part_.triangles = triangles.size();
    part_.border_triangles =
        collect<std::size_t>(triangles.size(), [&](std::size_t t, std::vector<std::size_t>& found) {
          const auto& [a, b, c] = triangles[t];
          if (!(is_own(a) && is_own(b) && is_own(c))) found.push_back(t);
        });
  }

  // A triangle goes once to each other owner of one of its corners.
  std::vector<std::vector<NumberedTriangle>> triangles_for_owners() const {
    std::vector<std::vector<NumberedTriangle>> sent(static_cast<std::size_t>(ranks_.count()));
    for (const std::size_t t : part_.border_triangles) {
      const Triangle& corners = piece_.mesh.triangles[t];
      NumberedTriangle numbers;
      std::array<std::size_t, 3> owners;
      for (std::size_t k = 0; k < 3; ++k) {
        numbers[k] = piece_.number_of(corners[k]);
        owners[k] = is_own(corners[k]) ? self_ : piece_.numbers.owner_of(numbers[k]);
      }
      std::ranges::sort(owners);
      for (std::size_t k = 0; k < owners.size(); ++k) {
        const bool is_repeated = k > 0 && owners[k] == owners[k - 1];
        if (!is_repeated && owners[k] != self_) sent[owners[k]].push_back(numbers);
      }
    }
    return sent;
  }

  // The vertices of other ranks: those that the piece names keep their places behind the own ones.
  void find_elsewhere() {
    std::vector<std::uint64_t> added;
    for (const std::vector<NumberedTriangle>& from : received_) {
      for (const NumberedTriangle& corners : from) {
        for (const std::uint64_t number : corners) {
          if (!piece_.numbers.own_vertex(number) &&
              !std::ranges::binary_search(piece_.elsewhere, number)) {
            added.push_back(number);
          }
        }
      }
    }
    sort_without_repeats(added);
    elsewhere_ = piece_.elsewhere;
    elsewhere_.insert(elsewhere_.end(), added.begin(), added.end());
    if (own_ + elsewhere_.size() > kMaxVertices) {
      throw LimitExceeded(
          "a rank has more than 2^32 vertices to measure or refine: more ranks would do");
    }
    named_.resize(static_cast<std::size_t>(ranks_.count()));
    part_.halo.elsewhere.resize(named_.size());
    for (std::size_t i = 0; i < elsewhere_.size(); ++i) {
      const std::size_t owner = piece_.numbers.owner_of(elsewhere_[i]);
      named_[owner].push_back(elsewhere_[i]);
      part_.halo.elsewhere[owner].push_back(static_cast<std::uint32_t>(own_ + i));
      part_.is_larger.push_back(owner > self_ ? 1 : 0);
    }
  }

  void find_asked_for(const std::vector<std::vector<std::uint64_t>>& numbers) {
    for (const std::vector<std::uint64_t>& from : numbers) {
      std::vector<std::uint32_t>& local = part_.halo.asked_for.emplace_back();
      for (const std::uint64_t number : from) local.push_back(local_of(number));
    }
  }

  // The index of a vertex in the part.
  std::uint32_t local_of(std::uint64_t number) const {
    if (const auto own = piece_.numbers.own_vertex(number)) return static_cast<std::uint32_t>(*own);
    const auto added = elsewhere_.begin() + static_cast<std::ptrdiff_t>(piece_.elsewhere.size());
    auto found = std::lower_bound(elsewhere_.begin(), added, number);
    if (found == added || *found != number) {
      found = std::lower_bound(added, elsewhere_.end(), number);
    }
    return static_cast<std::uint32_t>(own_) +
           static_cast<std::uint32_t>(found - elsewhere_.begin());
  }

  void append_triangles() {
    std::size_t next = part_.triangles;
    for (const auto& from : received_) {
      for (const auto& [a, b, c] : from) {
        part_.mesh.triangles[next++] = {local_of(a), local_of(b), local_of(c)};
      }
    }
  }

  const Ranks& ranks_;
  const SurfacePiece& piece_;
  const std::size_t self_, own_;  // this rank, and how many vertices it owns
  BorderMesh part_;
  std::vector<std::vector<NumberedTriangle>> received_;  // [sender]
  // The numbers of the vertices of the part that other ranks own. There are two runs, each of which
  // ascends: SurfacePiece::elsewhere, and behind it the vertices that only the others' triangles
  // have.
  std::vector<std::uint64_t> elsewhere_;
  std::vector<std::vector<std::uint64_t>> named_;  // the same by owner, in the same order
};

}  // namespace

BorderMesh copy_border_mesh(const Ranks& ranks, const SurfacePiece& piece) {
  BorderBuilder builder(ranks, piece);
  return builder.run([&](IndexedMesh& mesh, std::size_t vertices) {
    mesh.positions = copied(piece.mesh.positions, vertices);
    mesh.triangles = copied(piece.mesh.triangles, builder.triangles());
  });
}

BorderMesh take_border_mesh(const Ranks& ranks, SurfacePiece& piece) {
  BorderBuilder builder(ranks, piece);
  return builder.run([&](IndexedMesh& mesh, std::size_t vertices) {
    mesh.positions = taken(piece.mesh.positions, vertices);
    mesh.triangles = taken(piece.mesh.triangles, builder.triangles());
  });
}

void give_back(BorderMesh& part, SurfacePiece& piece) {
  part.mesh.positions.resize(part.vertices);
  part.mesh.triangles.resize(part.triangles);
  piece.mesh.positions = std::move(part.mesh.positions);
  piece.mesh.triangles = std::move(part.mesh.triangles);
}

}  // namespace vdwmesh
