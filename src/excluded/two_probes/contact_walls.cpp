// ContactWalls: the loops of an atom's contact patches, and which of them bound the same region.
//
// Let C₁ and C₂ ⊂ C₁ be the exposed parts of an atom for the small and the large probe, on its unit
// sphere, with n₁ and n₂ loops and m₁ and m₂ pieces. The loops are disjoint and cut the sphere into
// n₁ + n₂ + 1 parts: m₂ in C₂, n₁ + 1 - m₁ outside of C₁, and so n₂ + m₁ - m₂ regions between.
//
// Claim: if a way leads from each loop to one root loop, and of each part of a way inside a region
// the loops at both ends are joined, then all loops of each region are joined. Proof: the sphere
// less a region with k loops is k disks, one behind each loop. The way from a loop of the region
// begins in its disk and ends in the root's. Where it goes from disk to disk, it crosses the region
// in one part, and their loops are joined; so all are joined with the loop of the root's disk.
//
// Steps for each atom: (1) if C₁ has one piece and each piece of C₂ one loop, all loops bound one
// region; (2) if there is no C₂, the regions are the pieces of C₁; (3) otherwise arcs of great
// circles are the ways. Where an arc meets a loop in a corner or along it, or where sides at the
// two ends of a part contradict each other, another arc is taken; the number of regions is checked.
// Gauss–Bonnet gives the solid angle of a region: 4 π + Σ ω, where ω is bend - 2 π for loops of C₁
// and -bend - 2 π for loops of C₂.
#include "excluded/two_probes/contact_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh::excluded {
namespace {

constexpr double kTwicePi = 2 * std::numbers::pi;

// Radians: nearer to a corner, a tangent or an end nothing is decided.
constexpr double kUnclear = 1e-9;
// How often another arc is taken.
constexpr int kMostWays = 24;

// An arc of a loop on the unit sphere of its atom. The atom is exposed where axis · w < cosine.
struct CapArc {
  std::uint32_t loop;  // of the atom's
  bool of_large;
  Vec3d axis, first, second;  // second is first turned counter-clockwise about the arc's own axis
  double cosine, sine, angle;

  Vec3d at(double turn) const {
    return cosine * axis + sine * (std::cos(turn) * first + std::sin(turn) * second);
  }
};

CapArc cap_arc(const KeptSurface& kept, std::uint32_t element, std::uint32_t loop, bool of_large) {
  const RolledArc& arc = kept.grown->surface.arcs[element / 2];
  const std::size_t side = element % 2;
  const double radius = kept.grown->triangulation.balls[arc.ball[side]].radius;
  const Vec3d first = arc.is_ring() ? any_orthogonal(arc.axis) : arc.radial[0];
  return {.loop = loop,
          .of_large = of_large,
          .axis = side == 0 ? arc.axis : -1.0 * arc.axis,
          .first = first,
          .second = cross(arc.axis, first),
          .cosine = arc.height[side] / radius,
          .sine = arc.circle_radius / radius,
          .angle = arc.angle};
}

// Where a way meets a loop.
struct LoopCrossing {
  double along;  // rad from its beginning
  std::uint32_t loop;
  bool of_large, into_cap;

  // Whether the way is in a region behind the crossing, or before it.
  bool wall_behind() const { return of_large == into_cap; }
  bool wall_before() const { return of_large != into_cap; }
};

// The arcs around one atom, and ways between them.
class SphereRims {
 public:
  SphereRims(std::vector<CapArc> arcs, std::uint32_t loops)
      : arcs_(std::move(arcs)), joined_(loops) {
    for (std::uint32_t i = 0; i < arcs_.size(); ++i) {
      if (i == 0 || arcs_[i].loop != arcs_[i - 1].loop) begin_.push_back(i);
    }
    begin_.push_back(static_cast<std::uint32_t>(arcs_.size()));
  }

  // Joins the loops of each region; false if they are not as many as `regions`.
  bool join(std::size_t regions) {
    for (int start = 0; start < kMostWays; start += kMostWays / 3) {
      std::iota(joined_.begin(), joined_.end(), 0u);
      bool all = true;
      for (std::uint32_t i = 1; i < joined_.size() && all; ++i) {
        all = false;
        for (int way = start; way < start + kMostWays && !all; ++way) all = follow(i, way);
      }
      if (all && count() == regions) return true;
    }
    return false;
  }
  std::uint32_t root_of(std::uint32_t loop) const {
    while (joined_[loop] != loop) loop = joined_[loop];
    return loop;
  }

 private:
  std::size_t count() const {
    std::size_t roots = 0;
    for (std::uint32_t i = 0; i < joined_.size(); ++i) roots += joined_[i] == i;
    return roots;
  }

  // The arc from which way number `way` leaves a loop, or at which it ends, and the turn on it.
  std::pair<std::uint32_t, double> leave(std::uint32_t loop, int way) const {
    constexpr double kGolden = 0.6180339887498949;
    const std::uint32_t size = begin_[loop + 1] - begin_[loop];
    const double place = kGolden * (way + 1), fraction = place - std::floor(place);
    const std::uint32_t arc = begin_[loop] + static_cast<std::uint32_t>(way) % size;
    return {arc, (0.1 + 0.8 * fraction) * arcs_[arc].angle};
  }

  // Follows a way from a loop to loop 0; false, and nothing joined, if something is unclear.
  bool follow(std::uint32_t loop, int way) {
    const auto [from, from_turn] = leave(loop, way);
    const auto [to, to_turn] = leave(0, way / 2);
    const Vec3d start = arcs_[from].at(from_turn), end = arcs_[to].at(to_turn);
    const Vec3d across = end - dot(end, start) * start;
    if (!(norm(across) > 1e-6)) return false;
    const Vec3d toward = unit(across);
    const double length = std::atan2(dot(end, toward), dot(end, start));
    std::vector<LoopCrossing> met;
    for (std::uint32_t i = 0; i < arcs_.size(); ++i) {
      const double own = i == from ? 0 : -1, last = i == to ? length : -1;
      if (!add_crossings(arcs_[i], start, toward, length, own, last, met)) return false;
    }
    std::sort(met.begin(), met.end(),
              [](const LoopCrossing& a, const LoopCrossing& b) { return a.along < b.along; });
    for (std::size_t k = 0; k + 1 < met.size(); ++k) {
      if (met[k + 1].along - met[k].along < kUnclear || !fit(met[k], met[k + 1])) return false;
    }
    for (std::size_t k = 0; k + 1 < met.size(); ++k) {
      if (!met[k].wall_behind()) continue;
      const std::uint32_t a = root_of(met[k].loop), b = root_of(met[k + 1].loop);
      joined_[std::max(a, b)] = std::min(a, b);
    }
    return true;
  }

  // Whether what is between two crossings is the same seen from both.
  static bool fit(const LoopCrossing& a, const LoopCrossing& b) {
    if (a.wall_behind() != b.wall_before()) return false;
    return a.wall_behind() || a.of_large == b.of_large;
  }

  // Adds where cos(τ) start + sin(τ) toward, 0 <= τ <= length, meets an arc, of which it is known
  // that it does at `own` and `last`, unless these are negative. False if something is unclear.
  static bool add_crossings(const CapArc& arc, const Vec3d& start, const Vec3d& toward,
                            double length, double own, double last,
                            std::vector<LoopCrossing>& met) {
    const auto add = [&](double along) {
      const double slope =
          std::cos(along) * dot(arc.axis, toward) - std::sin(along) * dot(arc.axis, start);
      met.push_back({along, arc.loop, arc.of_large, slope > 0});
      return std::abs(slope) > kUnclear * arc.sine;
    };
    if (own >= 0 && !add(own)) return false;
    if (last >= 0 && !add(last)) return false;
    const double x = dot(arc.axis, start), y = dot(arc.axis, toward), size = std::hypot(x, y);
    const double ratio = arc.cosine / size;
    if (!(std::abs(ratio) < 1 + kUnclear)) return true;
    const bool tangent = !(std::abs(ratio) < 1 - kUnclear);
    const double half = tangent ? 0 : std::acos(ratio);
    for (const double sign : {-1.0, 1.0}) {
      const double along = std::remainder(std::atan2(y, x) + sign * half, kTwicePi);
      const auto is_at = [&](double known) {
        return known >= 0 && std::abs(along - known) < 1e3 * kUnclear;
      };
      if (is_at(own) || is_at(last)) continue;
      if (along < -kUnclear || along > length + kUnclear) continue;
      const Vec3d w = std::cos(along) * start + std::sin(along) * toward;
      double turn = std::atan2(dot(w, arc.second), dot(w, arc.first));
      if (turn < -kUnclear) turn += kTwicePi;
      const bool whole = arc.angle >= kTwicePi;
      if (!whole && turn > arc.angle + kUnclear && turn < kTwicePi - kUnclear) continue;
      const bool at_end = !whole && (std::abs(turn) < kUnclear || turn > arc.angle - kUnclear);
      if (tangent || at_end || along < kUnclear || along > length - kUnclear) return false;
      if (!add(along)) return false;
    }
    return true;
  }

  std::vector<CapArc> arcs_;           // by loop
  std::vector<std::uint32_t> begin_;   // of each loop's arcs
  std::vector<std::uint32_t> joined_;  // union-find by parents
};

// Things by the atoms that they belong to.
struct ByAtom {
  std::vector<std::uint32_t> first, item;

  template <class AtomOf>
  ByAtom(std::size_t atoms, std::size_t count, const AtomOf& atom_of) : first(atoms + 2, 0) {
    for (std::uint32_t i = 0; i < count; ++i) {
      if (const SphereId a = atom_of(i); a != kNoIndex) ++first[a + 2];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    item.resize(first.back());
    for (std::uint32_t i = 0; i < count; ++i) {
      if (const SphereId a = atom_of(i); a != kNoIndex) item[first[a + 1]++] = i;
    }
    first.pop_back();
  }
  std::span<const std::uint32_t> of(std::size_t atom) const {
    return std::span(item).subspan(first[atom], first[atom + 1] - first[atom]);
  }
};

}  // namespace

SphereLoops::SphereLoops(const KeptSurface& kept) {
  const AccessibleSurface& surface = kept.grown->surface;
  loops.resize(surface.number_loops(of_element));
  std::vector<WideSum> bend(loops.size());
  first.assign(loops.size() + 2, 0);
  for (std::uint32_t x = 0; x < of_element.size(); ++x) {
    const RolledArc& arc = surface.arcs[x / 2];
    SphereLoop& loop = loops[of_element[x]];
    loop.ball = arc.ball[x % 2], loop.piece = arc.contact[x % 2];
    const double radius = kept.grown->triangulation.balls[loop.ball].radius;
    bend[of_element[x]].add(arc.angle * (arc.height[x % 2] / radius));
    loop.vector = loop.vector + contact_vector(arc, x % 2, radius);
    if (!surface.counts(arc, kept.outer)) continue;
    loop.counts = true;
    ++first[of_element[x] + 2];
  }
  make_and_add(
      surface.corners.size(),
      [&](std::size_t i) {
        std::array<double, 3> turning;
        for (std::size_t k = 0; k < 3; ++k) {
          turning[k] = surface.shapes().turning_angle(surface.corners[i] / 2, k);
        }
        return turning;
      },
      [&](std::size_t i, const std::array<double, 3>& turning) {
        for (std::size_t k = 0; k < 3; ++k) {
          bend[of_element[surface.element_at(surface.corners[i], k)]].add(-turning[k]);
        }
      });
  for (std::size_t l = 0; l < loops.size(); ++l) loops[l].bend = bend[l].value();
  std::partial_sum(first.begin(), first.end(), first.begin());
  elements.resize(first.back());
  for (std::uint32_t x = 0; x < of_element.size(); ++x) {
    if (surface.counts(surface.arcs[x / 2], kept.outer)) elements[first[of_element[x] + 1]++] = x;
  }
  first.pop_back();
}

ContactWalls::ContactWalls(const KeptSurface& small, const KeptSurface& large, std::size_t atoms)
    : loops{SphereLoops(small), SphereLoops(large)},
      small_(small),
      large_(large),
      atoms_(atoms),
      whole_(loops[0].loops.size() + loops[1].loops.size()),
      pieces_(small.grown->surface.contacts.size()) {}

// For each loop of an atom the first one of its region, or nothing if that could not be told. Loops
// of the small probe come first; `pieces` are the numbers of pieces.
std::optional<std::vector<std::uint32_t>> ContactWalls::regions_of(
    const LoopsOfAtom& rims, const std::array<std::size_t, 2>& pieces) const {
  const std::size_t small = rims[0].size(), shown = small + rims[1].size();
  std::vector<std::uint32_t> region(shown, 0u);
  const std::size_t regions = rims[1].size() + pieces[0] - pieces[1];
  if (pieces[0] == 1 && regions == 1) return region;
  if (pieces[1] == 0 && rims[1].empty()) {
    for (std::size_t i = 0; i < shown; ++i) {
      const auto same = [&](std::uint32_t l) {
        return loops[0].loops[l].piece == loops[0].loops[rims[0][i]].piece;
      };
      region[i] = static_cast<std::uint32_t>(std::ranges::find_if(rims[0], same) - rims[0].begin());
    }
    return region;
  }
  std::vector<CapArc> arcs;
  for (std::uint32_t i = 0; i < shown; ++i) {
    const bool large = i >= small;
    const SphereLoops& of = loops[large];
    const std::uint32_t l = large ? rims[1][i - small] : rims[0][i];
    for (std::uint32_t e = of.first[l]; e < of.first[l + 1]; ++e) {
      arcs.push_back(cap_arc(large ? large_ : small_, of.elements[e], i, large));
    }
  }
  SphereRims around(std::move(arcs), static_cast<std::uint32_t>(shown));
  if (!around.join(regions)) return std::nullopt;
  for (std::uint32_t i = 0; i < shown; ++i) region[i] = around.root_of(i);
  return region;
}

std::vector<WallPart> ContactWalls::join(DisjointSets& nodes, std::uint64_t& unsettled) const {
  const std::array<const KeptSurface*, 2> kept{&small_, &large_};
  const auto loops_of = [&](std::size_t s) {
    return ByAtom(atoms_, loops[s].loops.size(), [&, s](std::uint32_t l) {
      const SphereLoop& loop = loops[s].loops[l];
      return loop.counts ? kept[s]->grown->triangulation.ids[loop.ball] : kNoIndex;
    });
  };
  const auto pieces_of = [&](std::size_t s) {
    return ByAtom(atoms_, kept[s]->grown->surface.contacts.size(), [&, s](std::uint32_t i) {
      const ContactPiece& c = kept[s]->grown->surface.contacts[i];
      const bool counts = !c.point && kept[s]->outer[c.component] != 0;
      return counts ? kept[s]->grown->triangulation.ids[c.ball] : kNoIndex;
    });
  };
  const std::array rims{loops_of(0), loops_of(1)}, pieces{pieces_of(0), pieces_of(1)};
  std::vector<WallPart> parts;
  make_and_add(
      atoms_,
      [&](std::size_t atom) {
        return regions_of({rims[0].of(atom), rims[1].of(atom)},
                          {pieces[0].of(atom).size(), pieces[1].of(atom).size()});
      },
      [&](std::size_t i, const std::optional<std::vector<std::uint32_t>>& region) {
        const auto atom = static_cast<SphereId>(i);
        unsettled += !region;
        if (region) add_parts(atom, {rims[0].of(atom), rims[1].of(atom)}, *region, nodes, parts);
        if (!rims[0].of(atom).empty() || !rims[1].of(atom).empty() || !pieces[1].of(atom).empty())
          return;
        for (const std::uint32_t whole : pieces[0].of(atom)) {
          parts.push_back({static_cast<std::uint32_t>(whole_ + whole), atom, 2 * kTwicePi, {}});
        }
      });
  return parts;
}

void ContactWalls::add_parts(SphereId atom, const LoopsOfAtom& rims,
                             const std::vector<std::uint32_t>& region, DisjointSets& nodes,
                             std::vector<WallPart>& parts) const {
  std::vector<std::uint32_t> node(rims[0].begin(), rims[0].end());
  const auto second = static_cast<std::uint32_t>(loops[0].loops.size());
  for (const std::uint32_t l : rims[1]) node.push_back(second + l);
  for (std::size_t i = 0; i < node.size(); ++i) {
    const bool large = i >= rims[0].size();
    const SphereLoop& loop = loops[large].loops[large ? node[i] - second : node[i]];
    const double sign = large ? -1 : 1, whole = region[i] == i ? 2 * kTwicePi : 0;
    nodes.join(node[i], node[region[i]]);
    parts.push_back({node[i], atom, sign * loop.bend - kTwicePi + whole, sign * loop.vector});
  }
}

}  // namespace vdwmesh::excluded
