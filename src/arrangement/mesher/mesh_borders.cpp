// MeshBorders: lists of what two processes share, in one order on both sides, and messages that
// name places in these lists.
#include "arrangement/mesher/mesh_borders.hpp"

#include <algorithm>
#include <array>

namespace vdwmesh {
namespace {

using Words = std::vector<std::vector<std::uint64_t>>;  // by process

}  // namespace

MeshBorders::MeshBorders(const BoundaryArcs& boundary, const OwnedPart& part, const MeshTeam& team)
    : boundary_(boundary), part_(part), team_(team), arcs_(team.count()), corners_(team.count()) {
  const auto own = static_cast<std::uint32_t>(team.number());
  // An element is shared by its owner, the lowest process, with every other one that has a ball of
  // it. Balls are ascending, and so are their processes.
  const auto share_out = [&](const auto& balls, std::uint32_t element, Lists& lists) {
    const std::uint32_t owner = part.owner[balls[0]];
    if (owner != own) {
      lists[owner].push_back(element);
      return;
    }
    std::uint32_t last = own;
    for (const std::uint32_t ball : balls) {
      if (part.owner[ball] == last) continue;
      last = part.owner[ball];
      lists[last].push_back(element);
    }
  };
  for (std::uint32_t a = 0; a < boundary.arcs.size(); ++a) {
    share_out(boundary.arcs[a].balls, a, arcs_);
  }
  for (std::uint32_t c = 0; c < boundary.corners.size(); ++c) {
    share_out(boundary.corners[c].balls, c, corners_);
  }
}

void MeshBorders::merge(std::vector<PieceSplit>& splits) const {
  Words told(team_.count());
  team_.together([&] {
    for (const PieceSplit& s : splits) {
      const auto& [low, high] = boundary_.arcs[s.piece.arc].balls;
      const std::uint32_t other = part_.owner[is_own_ball(low) ? high : low];
      if (is_own_ball(low) && is_own_ball(high)) continue;
      const std::vector<std::uint32_t>& shared = arcs_[other];
      const auto place = std::ranges::lower_bound(shared, s.piece.arc) - shared.begin();
      told[other].insert(told[other].end(), {static_cast<std::uint64_t>(place), s.piece.piece,
                                             std::uint64_t{s.cut} << 32 | s.halvings});
    }
  });
  const Words heard = team_.exchange(told);
  team_.together([&] {
    for (std::size_t process = 0; process < heard.size(); ++process) {
      const std::vector<std::uint64_t>& words = heard[process];
      for (std::size_t i = 0; i < words.size(); i += 3) {
        splits.push_back({{arcs_[process][words[i]], static_cast<std::uint32_t>(words[i + 1])},
                          static_cast<std::uint32_t>(words[i + 2]),
                          static_cast<std::uint32_t>(words[i + 2] >> 32)});
      }
    }
    merge_splits(splits);
  });
}

std::uint64_t MeshBorders::count_own(std::span<const PieceSplit> splits) const {
  return static_cast<std::uint64_t>(std::ranges::count_if(
      splits, [&](const PieceSplit& s) { return s.piece.arc >= part_.share.arcs.first; }));
}

template <class Number, class Set>
void MeshBorders::tell_numbers(const Lists& shared, const MeshShare::Run& own, const Number& number,
                               const Set& set) const {
  Words told(team_.count());
  team_.together([&] {
    for (std::size_t process = 0; process < shared.size(); ++process) {
      for (const std::uint32_t element : shared[process]) {
        if (element >= own.first) told[process].push_back(number(element));
      }
    }
  });
  const Words heard = team_.exchange(told);
  team_.together([&] {
    for (std::size_t process = 0; process < team_.number(); ++process) {
      for (std::size_t i = 0; i < heard[process].size(); ++i) {
        set(shared[process][i], heard[process][i]);
      }
    }
  });
}

void MeshBorders::number_in_whole(const ArcSampling& sampling,
                                  std::vector<std::uint64_t>& numbers) const {
  const MeshShare::Run corners = part_.share.corners, arcs = part_.share.arcs;
  const std::uint64_t own_corners = corners.second - corners.first;
  const std::uint32_t first_point = sampling.first_vertex(arcs.first);
  const std::uint64_t own_points = sampling.first_vertex(arcs.second) - first_point;
  const std::uint64_t corners_before = team_.sum_before(own_corners),
                      all_corners = team_.sum(own_corners),
                      points_before = team_.sum_before(own_points);
  std::vector<std::uint64_t> of_corner(corners.first), of_arc(arcs.first);  // of other processes
  tell_numbers(
      corners_, corners, [&](std::uint32_t c) { return corners_before + (c - corners.first); },
      [&](std::uint32_t c, std::uint64_t number) { of_corner[c] = number; });
  tell_numbers(
      arcs_, arcs,
      [&](std::uint32_t a) {
        return all_corners + points_before + (sampling.first_vertex(a) - first_point);
      },
      [&](std::uint32_t a, std::uint64_t number) { of_arc[a] = number; });
  team_.together([&] {
    std::uint32_t arc = 0;
    for (std::uint64_t& number : numbers) {
      if (number < boundary_.corners.size()) {
        number = of_corner[number];
      } else {
        while (sampling.first_vertex(arc + 1) <= number) ++arc;
        number = of_arc[arc] + (number - sampling.first_vertex(arc));
      }
    }
  });
}

}  // namespace vdwmesh
