// interfaces(): every ball by itself, in parallel. BallCaps finds its neighbours once; then CutBall
// measures the ball with the caps of one cover after another: its own group, each pair with another
// group that overlaps the ball, and all balls. What the arcs leave in doubt, and balls that another
// one buries, are measured by a triangulation of the balls of the cover. Threads collect what they
// find; it is sorted afterwards.
#include "interface/interfaces.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/lanes/multiversion.hpp"
#include "measures/arcs/ball_caps.hpp"
#include "measures/arcs/cut_ball.hpp"
#include "measures/arcs/face_areas.hpp"
#include "measures/exact_sum.hpp"
#include "measures/reference_measures.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {
namespace {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kBallsPerBlock = 256;  // consecutive in list order

// The groups whose balls cover a ball: a and b, which may be equal, or all balls (kAllBalls).
constexpr std::int32_t kAllBalls = -1;
struct CoverGroups {
  std::int32_t a, b;

  bool has(std::int32_t group) const { return a == kAllBalls || group == a || group == b; }
  auto operator<=>(const CoverGroups&) const = default;
};

// A ball at the interface of a pair, and the ball of the other group that it overlaps deepest.
struct FoundAtom {
  CoverGroups pair;
  SphereId sphere;
  double in_pair;
  SphereId deepest;
  double depth;

  auto key() const { return std::tie(pair, sphere); }
};

// A face of a pair's power diagram, as the ball of group a sees it (side 0) or that of b (side 1).
struct FoundFace {
  CoverGroups pair;
  AtomContact contact;
  int side;

  auto key() const { return std::tie(pair, contact.a, contact.b, side); }
};

// An area that a triangulation has to measure. The last cover of a ball is as good as all balls.
struct DoubtfulArea {
  CoverGroups cover;
  SphereId sphere;
  bool is_last;

  auto key() const { return std::tie(cover, sphere); }
};

// Memory of one thread.
struct CoverThread {
  arcs::BallCaps caps;
  arcs::CutBall ball;
  std::vector<std::int32_t> others;  // groups that the ball overlaps, but for its own
  std::vector<CoverGroups> covers;
  std::vector<arcs::Cap> chosen;       // caps of one cover
  std::vector<ListPlace> chosen_from;  // the balls that cover them
  std::vector<double> areas;           // by plane
  std::vector<FoundAtom> atoms;
  std::vector<FoundFace> faces;
  std::vector<DoubtfulArea> doubtful;
};

struct CoverRun {
  const CellListView& list;
  std::span<const std::int32_t> group;  // by sphere id
  Interfaces& result;

  std::int32_t group_at(ListPlace place) const { return group[list.id[place]]; }
};

// Notes the groups of a ball that overlaps the one of group `own`. Returns whether it is in none,
// so that it counts among all balls only.
bool note_other(std::int32_t other, std::int32_t own, std::vector<std::int32_t>& others) {
  if (other >= 0 && other != own && std::ranges::count(others, other) == 0) others.push_back(other);
  return other < 0;
}

double overlap_of(const Sphere& a, const Sphere& b) {
  const Vec3d to = b.center - a.center;
  return a.radius + b.radius - std::sqrt(dot(to, to));
}

// Calls visit(other) for the balls that overlap the one at `place`: those that cut it, which the
// caps know, and all if one buries it.
template <class Visit>
void visit_overlapping(const CellListView& list, ListPlace place, const arcs::BallCaps& caps,
                       bool is_buried, const Visit& visit) {
  if (!is_buried) {
    for (const ListPlace other : caps.neighbors()) visit(other);
    return;
  }
  const Sphere& ball = list.spheres[place];
  const Vec3d reach{ball.radius, ball.radius, ball.radius};
  visit_near_box(list, ball.center - reach, ball.center + reach, [&](ListPlace other) {
    if (other != place && overlap_of(ball, list.spheres[other]) > 0) visit(other);
    return false;  // go on with the search
  });
}

// Lists the covers with which the ball is to be measured: its group, the pairs, and all balls if
// that is another cover than the one before.
void find_covers(const CoverRun& run, ListPlace place, bool is_buried, CoverThread& work) {
  const std::int32_t own = run.group_at(place);
  work.others.clear();
  bool has_strangers = false;
  visit_overlapping(run.list, place, work.caps, is_buried, [&](ListPlace other) {
    has_strangers |= note_other(run.group_at(other), own, work.others);
  });
  work.covers.assign(1, {own, own});
  for (const std::int32_t other : work.others)
    work.covers.push_back({std::min(own, other), std::max(own, other)});
  if (has_strangers || work.others.size() > 1) work.covers.push_back({kAllBalls, kAllBalls});
}

// Appends the ball to those of the pair, with its deepest overlap; the lowest id wins ties.
void add_atom(const CoverRun& run, ListPlace place, const CoverGroups& pair, double area,
              bool is_buried, CoverThread& work) {
  const std::int32_t own = run.group_at(place), other = pair.a == own ? pair.b : pair.a;
  FoundAtom atom{.pair = pair,
                 .sphere = run.list.id[place],
                 .in_pair = area,
                 .deepest = 0,
                 .depth = -1};  // Å: below that of every overlap
  visit_overlapping(run.list, place, work.caps, is_buried, [&](ListPlace near) {
    if (run.group_at(near) != other) return;
    const double depth = overlap_of(run.list.spheres[place], run.list.spheres[near]);
    const SphereId id = run.list.id[near];
    if (depth < atom.depth || (depth == atom.depth && id > atom.deepest)) return;
    atom.deepest = id;
    atom.depth = depth;
  });
  work.atoms.push_back(atom);
}

// Chooses the caps of a cover.
void choose_caps(const CoverRun& run, const CoverGroups& cover, CoverThread& work) {
  work.chosen.clear();
  work.chosen_from.clear();
  for (std::size_t i = 0; i < work.caps.caps().size(); ++i) {
    const ListPlace from = work.caps.neighbors()[i];
    if (!cover.has(run.group_at(from))) continue;
    work.chosen.push_back(work.caps.caps()[i]);
    work.chosen_from.push_back(from);
  }
}

// Appends the faces towards the other group of the ball that was just measured in a pair.
void add_faces(const CoverRun& run, ListPlace place, const CoverGroups& pair, CoverThread& work) {
  const std::int32_t own = run.group_at(place);
  const double radius = run.list.spheres[place].radius;
  const SphereId id = run.list.id[place];
  const arcs::CellView& cell = work.ball.cell();
  if (cell.empty()) return;
  arcs::face_areas(cell, work.ball.measurer(), work.areas);
  for (std::uint32_t plane = arcs::kWalls; plane < cell.plane_count; ++plane) {
    const ListPlace from = work.chosen_from[work.ball.cap_of(plane)];
    const double area = work.areas[plane] * radius * radius;
    if (run.group_at(from) == own || !(area > 0)) continue;
    const int side = own == pair.a ? 0 : 1;
    const SphereId other = run.list.id[from];
    work.faces.push_back({pair, {side == 0 ? id : other, side == 0 ? other : id, area}, side});
  }
}

// Measures a ball with each of its covers.
void measure_ball(const CoverRun& run, ListPlace place, CoverThread& work) {
  constexpr std::uint32_t kNoFaces = arcs::kDamaged | arcs::kNotFinite;
  const SphereId id = run.list.id[place];
  const double radius = run.list.spheres[place].radius;
  const bool is_buried = !work.caps.find(run.list, place);
  find_covers(run, place, is_buried, work);
  for (const CoverGroups& cover : work.covers) {
    const bool is_pair = cover.a != cover.b, is_last = &cover == &work.covers.back();
    double area = kNotMeasured;
    if (!is_buried) {
      choose_caps(run, cover, work);
      const arcs::BallMeasures m = work.ball.measure(work.chosen);
      if ((m.doubts & ~arcs::kOnlyCountsInDoubt) == 0) area = m.area * (radius * radius);
      if (is_pair && !(m.doubts & kNoFaces)) add_faces(run, place, cover, work);
    }
    if (std::isnan(area)) work.doubtful.push_back({cover, id, is_last});
    if (is_pair) add_atom(run, place, cover, area, is_buried, work);
    if (&cover == &work.covers.front()) run.result.alone[id] = area;
    if (is_last) run.result.in_whole[id] = area;
  }
}

VDWMESH_MULTIVERSION void measure_balls(const CoverRun& run, std::size_t first, std::size_t end,
                                        CoverThread& work) {
  for (std::size_t i = first; i < end; ++i) {
    const auto place = static_cast<ListPlace>(i);
    if (run.group_at(place) >= 0) measure_ball(run, place, work);
  }
}

// What all threads found, in order.
template <class Item>
std::vector<Item> sorted_of(tbb::enumerable_thread_specific<CoverThread>& threads,
                            std::vector<Item> CoverThread::*items) {
  std::vector<Item> all;
  for (CoverThread& work : threads)
    all.insert(all.end(), (work.*items).begin(), (work.*items).end());
  std::ranges::sort(all, {}, &Item::key);
  return all;
}

// Measures the doubtful areas, for each cover by one triangulation of its balls alone.
void settle_doubtful(const CoverRun& run, const SphereSet& spheres,
                     const std::vector<DoubtfulArea>& doubtful, std::vector<FoundAtom>& atoms,
                     Monitor* monitor) {
  for (auto first = doubtful.begin(); first != doubtful.end();) {
    advance(monitor, 0);
    const CoverGroups cover = first->cover;
    const auto end = std::find_if(first, doubtful.end(),
                                  [&](const DoubtfulArea& d) { return d.cover != cover; });
    std::vector<SphereId> wanted;
    for (auto d = first; d != end; ++d) wanted.push_back(d->sphere);
    std::vector<NumberedBall> near = balls_near(run.list, spheres, wanted);
    std::erase_if(near, [&](const NumberedBall& n) { return !cover.has(run.group[n.id]); });
    const std::vector<SphereMeasures> measures = reference_measures(wanted, std::move(near));
    for (auto d = first; d != end; ++d) {
      const double area = measures[static_cast<std::size_t>(d - first)].area;
      if (d->is_last) run.result.in_whole[d->sphere] = area;
      if (cover.a == cover.b && cover.a != kAllBalls) run.result.alone[d->sphere] = area;
      if (cover.a == cover.b) continue;
      std::ranges::lower_bound(atoms, d->key(), {}, &FoundAtom::key)->in_pair = area;
    }
    first = end;
  }
}

// Adds up the areas of each group, rounded once. Throws if one is not finite.
void sum_groups(std::span<const std::int32_t> group, Interfaces& result) {
  std::vector<ExactSum> alone(result.groups.size()), in_whole(result.groups.size());
  for (std::size_t i = 0; i < group.size(); ++i) {
    if (group[i] < 0) continue;
    const auto g = static_cast<std::size_t>(group[i]);
    ++result.groups[g].spheres;
    alone[g].add(result.alone[i]);
    in_whole[g].add(result.in_whole[i]);
  }
  for (std::size_t g = 0; g < alone.size(); ++g) {
    result.groups[g].alone = alone[g].nearest();
    result.groups[g].in_whole = in_whole[g].nearest();
    if (!std::isfinite(result.groups[g].alone) || !std::isfinite(result.groups[g].in_whole))
      throw InvalidInput("an area is not finite in double: the spheres are too large or too small");
  }
}

// Makes the pairs of the atoms in order, without their contacts.
void make_pairs(const CoverRun& run, const std::vector<FoundAtom>& atoms) {
  Interfaces& result = run.result;
  for (auto first = atoms.begin(); first != atoms.end();) {
    const CoverGroups pair = first->pair;
    Interface& made = result.pairs.emplace_back(
        Interface{.a = pair.a,
                  .b = pair.b,
                  .area_a = result.groups[static_cast<std::size_t>(pair.a)].alone,
                  .area_b = result.groups[static_cast<std::size_t>(pair.b)].alone,
                  .buried_a = 0,
                  .buried_b = 0,
                  .contact_area = 0,
                  .atoms = {},
                  .contacts = {},
                  .deepest_a = 0,
                  .deepest_b = 0,
                  .overlap = -1});  // Å: below that of every atom
    ExactSum buried_a, buried_b;
    for (; first != atoms.end() && first->pair == pair; ++first) {
      const bool is_of_a = run.group[first->sphere] == pair.a;
      const double alone = result.alone[first->sphere];
      made.atoms.push_back({first->sphere, alone, first->in_pair});
      (is_of_a ? buried_a : buried_b).add(alone);
      (is_of_a ? buried_a : buried_b).add(-first->in_pair);
      if (first->depth <= made.overlap) continue;
      made.deepest_a = is_of_a ? first->sphere : first->deepest;
      made.deepest_b = is_of_a ? first->deepest : first->sphere;
      made.overlap = first->depth;
    }
    made.buried_a = buried_a.nearest();
    made.buried_b = buried_b.nearest();
  }
}

// Hands the faces, which are in order, to their pairs: each as its first side sees it.
void add_contacts(const std::vector<FoundFace>& faces, std::vector<Interface>& pairs) {
  auto pair = pairs.begin();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const FoundFace& face = faces[i];
    while (CoverGroups{pair->a, pair->b} != face.pair) ++pair;
    const bool is_repeated = i > 0 && faces[i - 1].pair == face.pair &&
                             faces[i - 1].contact.a == face.contact.a &&
                             faces[i - 1].contact.b == face.contact.b;
    if (!is_repeated) pair->contacts.push_back(face.contact);
  }
  for (Interface& made : pairs) {
    ExactSum sum;
    for (const AtomContact& contact : made.contacts) sum.add(contact.area);
    made.contact_area = sum.nearest();
  }
}

// One entry more than the largest number of a group.
std::size_t count_groups(const SphereSet& spheres, std::span<const std::int32_t> group) {
  if (spheres.empty()) throw InvalidInput("no spheres: they have no interfaces");
  if (group.size() != spheres.size())
    throw InvalidInput(fmt::format("{} spheres need a group each, but {} groups are given",
                                   spheres.size(), group.size()));
  const std::int32_t last = std::ranges::max(group);
  if (last >= 0 && static_cast<std::size_t>(last) >= spheres.size())
    throw InvalidInput(
        fmt::format("group {}: numbers of groups begin at 0 and are below that of "
                    "the spheres, {}",
                    last, spheres.size()));
  return static_cast<std::size_t>(last + 1);
}

}  // namespace

Interfaces interfaces(const SphereSet& spheres, std::span<const std::int32_t> group,
                      Monitor* monitor) {
  const std::size_t groups = count_groups(spheres, group);
  const CellList balls = make_ball_list(spheres);
  const CellListView& list = balls.view();
  Interfaces result;
  result.alone.assign(spheres.size(), kNotMeasured);
  result.in_whole.assign(spheres.size(), kNotMeasured);
  const CoverRun run{list, group, result};
  tbb::enumerable_thread_specific<CoverThread> threads;
  begin_stage(monitor, "interfaces", block_count(spheres.size(), kBallsPerBlock));
  for_each_block(
      spheres.size(), kBallsPerBlock,
      [&](std::size_t, std::size_t first, std::size_t end) {
        measure_balls(run, first, end, threads.local());
      },
      monitor);
  std::vector<FoundAtom> atoms = sorted_of(threads, &CoverThread::atoms);
  settle_doubtful(run, spheres, sorted_of(threads, &CoverThread::doubtful), atoms, monitor);
  result.groups.resize(groups);
  sum_groups(group, result);
  make_pairs(run, atoms);
  add_contacts(sorted_of(threads, &CoverThread::faces), result.pairs);
  return result;
}

}  // namespace vdwmesh
