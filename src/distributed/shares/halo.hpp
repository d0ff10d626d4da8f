// The vertices of a rank's part of a mesh that other ranks own, and how they are kept up to date.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/ranks.hpp"

namespace vdwmesh {

struct Halo {
  // [rank]: the vertices of this part that the rank owns, ascending, as indices in the arrays of
  // the part.
  std::vector<std::vector<std::uint32_t>> elsewhere;
  // [rank]: the own vertices that the rank has in its part, in the order of its `elsewhere`.
  std::vector<std::vector<std::uint32_t>> asked_for;

  // Replaces the elements of an array over the vertices of the part that stand for vertices of
  // other ranks by what these ranks have. Collective.
  template <class Array>
  void refresh(const Ranks& ranks, Array& array) const {
    using T = typename Array::value_type;
    std::vector<std::vector<T>> sent(asked_for.size());
    ranks.together([&] {
      for (std::size_t rank = 0; rank < asked_for.size(); ++rank) {
        for (const std::uint32_t v : asked_for[rank]) sent[rank].push_back(array[v]);
      }
    });
    const std::vector<std::vector<T>> received = ranks.exchange(sent);
    for (std::size_t rank = 0; rank < elsewhere.size(); ++rank) {
      for (std::size_t i = 0; i < elsewhere[rank].size(); ++i) {
        array[elsewhere[rank][i]] = received[rank][i];
      }
    }
  }
};

}  // namespace vdwmesh
