// MeshBorders: lists of what two processes share, in one order on both sides, and messages that
// name places in these lists.
//
// Shares and memory go by the number of equilateral triangles of its edge length that the area of a
// patch holds.
#include "creases/share/mesh_borders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "complex/placed_balls.hpp"
#include "core/errors.hpp"

namespace vdwmesh {
namespace {

using Words = std::vector<std::vector<std::uint64_t>>;  // by process

double ideal_triangles(const PatchExtents& patches, std::size_t ball) {
  const double length = patches.edge_lengths[ball];
  return patches.areas[ball] / (std::sqrt(3.0) / 4) / (length * length);
}

// The run of this process of `count` elements that are shared out evenly.
MeshShare::Run even_run(const MeshTeam& team, std::uint64_t count) {
  const auto begin = [&](std::uint64_t number) {
    return static_cast<std::uint32_t>(count * number / team.count());
  };
  return {begin(team.number()), begin(team.number() + 1)};
}

}  // namespace

std::vector<double> scaled_edge_lengths(const PlacedBalls& t, const ExactMeshOptions& options) {
  std::vector<double> lengths;
  lengths.reserve(t.balls.size());
  for (const SphereId id : t.ids) {
    const double length =
        options.edge_lengths.empty() ? options.edge_length : options.edge_lengths[id];
    lengths.push_back(std::ldexp(length, -t.scale_exponent));
  }
  return lengths;
}

// Corners and arcs are shared out evenly. The balls of a process are those whose middle triangle,
// of all in the order of the balls, is in its part. kPatch is what a patch costs besides its
// triangles, in triangles.
MeshShare own_share(const MeshTeam& team, const BoundaryArcs& boundary,
                    const PatchExtents& patches) {
  const std::size_t balls = patches.areas.size();
  MeshShare share{{0, static_cast<std::uint32_t>(balls)},
                  even_run(team, boundary.corners.size()),
                  even_run(team, boundary.arcs.size())};
  if (team.count() == 1) return share;
  constexpr double kPatch = 20;
  std::vector<double> middles;
  double before = 0;
  for (std::size_t b = 0; b < balls; ++b) {
    const double triangles = ideal_triangles(patches, b);
    const double cost = triangles > 0 ? triangles + kPatch : 0;
    middles.push_back(before + cost / 2);
    before += cost;
  }
  const auto begin = [&](std::size_t number) {
    if (number == 0) return share.balls.first;
    if (number == team.count()) return share.balls.second;
    const double part = static_cast<double>(number) / static_cast<double>(team.count());
    const auto first = std::ranges::lower_bound(middles, part * before);
    return static_cast<std::uint32_t>(first - middles.begin());
  };
  const MeshShare::Run own{begin(team.number()), begin(team.number() + 1)};
  share.balls = own;
  return share;
}

// The number of triangles is estimated: the ideal number times kFill, plus four per piece for
// narrow parts of patches. A closed mesh has about half as many vertices as triangles. By how much
// edges must be longer follows from the count, which falls with the square of the edge length, and
// 5 % are added for safety.
void check_memory(const MeshShare& share, const PatchExtents& patches, std::uint64_t pieces,
                  const ExactMeshOptions& options) {
  constexpr double kFill = 1.4;  // allowance over the ideal number of triangles
  // Bytes per triangle for the patches before they are joined.
  constexpr std::uint64_t kScratch = 40;
  double ideal = 0;
  for (std::uint32_t b = share.balls.first; b < share.balls.second; ++b) {
    ideal += ideal_triangles(patches, b);
  }
  const double triangles = kFill * ideal + 4 * static_cast<double>(pieces);
  // Just below 2^64. A triangle takes less than 200 bytes, so with at most kMost / 200 triangles
  // the number of bytes fits 64 bits.
  constexpr double kMost = 1.8e19;
  const auto count = static_cast<std::uint64_t>(std::min(triangles, kMost / 200));
  const std::uint64_t vertices = count / 2;
  const std::uint64_t need = indexed_mesh_bytes({vertices, count}, kPatchArrays) + kScratch * count;
  if (need <= options.memory_limit && vertices <= kMaxVertices) return;
  const double longer =
      1.05 *
      std::max(std::sqrt(static_cast<double>(need) / static_cast<double>(options.memory_limit)),
               std::sqrt(static_cast<double>(vertices) / static_cast<double>(kMaxVertices)));
  if (!options.edge_lengths.empty()) {
    throw LimitExceeded(fmt::format(
        "these edge lengths need about {} triangles and {} bytes, {} are allowed: choose lengths "
        "{:.2g} times as long or a higher memory limit",
        count, need, options.memory_limit, longer));
  }
  throw LimitExceeded(fmt::format(
      "an edge length of {} Å needs about {} triangles and {} bytes, {} are allowed: choose an "
      "edge length of at least {:.2g} Å or a higher memory limit",
      options.edge_length, count, need, options.memory_limit, options.edge_length * longer));
}

void check_vertices(std::uint64_t vertices) {
  if (vertices <= kMaxVertices) return;
  throw LimitExceeded(fmt::format(
      "{} vertices; a mesh holds at most {}: choose a larger edge length", vertices, kMaxVertices));
}

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
