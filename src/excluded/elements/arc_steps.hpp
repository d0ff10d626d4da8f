// The steps that find circles of two balls and their exposed arcs, one call for each element: the
// bodies of kernels. For the library's own use, on the host and on a CUDA device.
#pragma once

#include "excluded/elements/element_shapes.hpp"
#include "excluded/elements/elements.hpp"
#include "excluded/elements/local_surface.hpp"

namespace vdwmesh::excluded::elements {

// For each entry (a, b) of the lists of overlapping balls whether a < b, and the two balls meet in
// a circle that no single other ball covers.
struct FindCircles {
  Balls balls;
  Overlaps near;
  const std::uint32_t* owner;  // of each entry
  std::uint8_t* found;

  VDWMESH_HD void operator()(std::uint64_t entry) const {
    found[entry] = has_free_circle(owner[entry], near.other[entry]) ? 1 : 0;
  }
  VDWMESH_HD bool has_free_circle(std::uint32_t a, std::uint32_t b) const {
    if (a >= b || balls.measures[b].area == 0) return false;
    const Sphere& first = balls.grown[a];
    const PairCircle circle = pair_circle(first, balls.grown[b]);
    if (!(circle.radius > 0)) return false;
    for (std::uint64_t i = near.first[a]; i < near.first[a + 1]; ++i) {
      const std::uint32_t k = near.other[i];
      if (k != b && covers_circle(circle, first, balls.grown[k])) return false;
    }
    return true;
  }
};

VDWMESH_HD inline bool is_equal(const Sphere& a, const Sphere& b) {
  return a.radius == b.radius && a.center == b.center;
}

// The circles that were found, each as an entry of the lists. A ball equal to one of the circle's
// two covers nothing more than that one, so it is passed over.
struct Circles {
  Balls balls;
  Overlaps near;
  const std::uint32_t* owner;
  const std::uint32_t* entry;  // by circle

  template <class Visit>
  VDWMESH_HD bool visit(std::uint64_t index, const Visit& arc) const {
    const std::uint32_t a = owner[entry[index]], b = near.other[entry[index]];
    const PairCircle circle = pair_circle(balls.grown[a], balls.grown[b]);
    CircleCover cover;
    for (std::uint64_t i = near.first[a]; i < near.first[a + 1] && !cover.is_covered; ++i) {
      const std::uint32_t k = near.other[i];
      if (k == b || is_equal(balls.grown[k], balls.grown[a]) ||
          is_equal(balls.grown[k], balls.grown[b])) {
        continue;
      }
      cover.add(circle, balls.grown[a], balls.grown[k], k);
    }
    cover.visit_arcs(arc);
    return cover.is_doubtful && !cover.is_covered;
  }
};

// The first arcs of a circle; few have more.
inline constexpr std::uint64_t kKeptArcs = 2;
struct KeptArcs {
  std::uint32_t third[kKeptArcs][2];
  double turns[kKeptArcs];
};

struct CountArcs {
  Circles circles;
  std::uint64_t* count;
  std::uint8_t* doubtful;
  KeptArcs* kept;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    std::uint64_t found = 0;
    KeptArcs first{};
    doubtful[i] = circles.visit(i,
                                [&](std::uint32_t start, std::uint32_t end, double turns) {
                                  for (std::uint64_t k = 0; k < kKeptArcs; ++k) {
                                    if (k != found) continue;
                                    first.third[k][0] = start;
                                    first.third[k][1] = end;
                                    first.turns[k] = turns;
                                  }
                                  ++found;
                                })
                      ? 1
                      : 0;
    count[i] = found;
    if (found > 0) kept[i] = first;
  }
};

// The balls of circles that the host is to decide.
struct NameCircles {
  Circles circles;
  const std::uint32_t* listed;
  std::uint32_t* ball;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    const std::uint32_t e = circles.entry[listed[i]];
    ball[2 * i] = circles.owner[e];
    ball[2 * i + 1] = circles.near.other[e];
  }
};

struct AroundCircles {
  Balls balls;
  const std::uint32_t* ball;  // two of each
  Around* around;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    around[i] = around_circle(balls.grown[ball[2 * i]], balls.grown[ball[2 * i + 1]]);
  }
};

// Marks the balls around the circles and corners that the host is to decide.
struct MarkAround {
  Balls balls;
  const Around* around;
  std::uint64_t count;
  std::uint8_t* marked;
  VDWMESH_HD void operator()(std::uint64_t v) const {
    bool near = false;
    for (std::uint64_t i = 0; i < count && !near; ++i) near = is_around(around[i], balls.grown[v]);
    marked[v] = near;
  }
};
struct TakeBalls {
  Balls balls;
  const std::uint32_t* place;
  HostBall* out;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    const std::uint32_t v = place[i];
    out[i] = {balls.grown[v], balls.radius[v], balls.set ? balls.set[v] : 0, v};
  }
};

// Replaces the counts of circles that the host has decided.
struct ReplaceCounts {
  const std::uint32_t* circle;
  const std::uint64_t* by;
  std::uint64_t* count;
  VDWMESH_HD void operator()(std::uint64_t i) const { count[circle[i]] = by[i]; }
};

struct EmitArcs {
  Circles circles;
  const std::uint64_t* first;  // by circle: its first arc; and the end
  const std::uint8_t* doubtful;
  const KeptArcs* kept;
  Arc* arcs;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    const std::uint64_t count = first[i + 1] - first[i];
    if (doubtful[i] || count == 0) return;
    const std::uint32_t a = circles.owner[circles.entry[i]],
                        b = circles.near.other[circles.entry[i]];
    std::uint64_t next = first[i];
    const auto emit = [&](std::uint32_t start, std::uint32_t end, double turns) {
      arcs[next++] = {.ball = {a, b},
                      .third = {start, end},
                      .corner = {kNone, kNone},
                      .circle_first = static_cast<std::uint32_t>(first[i]),
                      .circle_end = static_cast<std::uint32_t>(first[i + 1]),
                      .turns = turns};
    };
    if (count > kKeptArcs) {
      circles.visit(i, emit);
      return;
    }
    for (std::uint64_t k = 0; k < count; ++k) {
      emit(kept[i].third[k][0], kept[i].third[k][1], kept[i].turns[k]);
    }
  }
};

struct HostArc {
  std::uint32_t circle, place;  // the place among the circle's arcs
  std::uint32_t ball[2], third[2];
  double turns;
};
struct PutHostArcs {
  const HostArc* made;
  const std::uint64_t* first;
  Arc* arcs;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    const HostArc& m = made[i];
    arcs[first[m.circle] + m.place] = {
        .ball = {m.ball[0], m.ball[1]},
        .third = {m.third[0], m.third[1]},
        .corner = {kNone, kNone},
        .circle_first = static_cast<std::uint32_t>(first[m.circle]),
        .circle_end = static_cast<std::uint32_t>(first[m.circle + 1]),
        .turns = m.turns};
  }
};

// An arc that is not longer than this may have no length, so that its corners are one probe. Only
// the host gathers corners, so the set fails.
inline constexpr double kLeastArc = 1e-10;  // of the largest of the two balls

struct ShapeArcs {
  Balls balls;
  const Arc* arcs;
  const ProbeCorner* corners;
  ArcShape* shapes;
  FailedSets sets;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    const Arc& arc = arcs[i];
    if (sets.has(arc.ball[0])) return;
    shapes[i] = arc_shape(balls, corners, arc);
    const double a = balls.grown[arc.ball[0]].radius, b = balls.grown[arc.ball[1]].radius;
    if (!(shapes[i].angle * shapes[i].circle_radius > kLeastArc * (a > b ? a : b))) {
      sets.put(arc.ball[0]);
    }
  }
};

}  // namespace vdwmesh::excluded::elements
