// The steps that make arcs, corners and rows, one call for each element: the bodies of kernels. For
// the library's own use, on the host and on a CUDA device.
#pragma once

#include "excluded/elements/cut_patch.hpp"
#include "excluded/elements/element_shapes.hpp"
#include "excluded/elements/elements.hpp"
#include "excluded/elements/local_surface.hpp"

namespace vdwmesh::excluded::elements {

// Which pairs of exposed balls meet in a circle that no single ball covers. By entry of the lists
// of overlapping balls.
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

// A circle of two balls, as an entry of the lists. Of equal balls one is exposed, and the others
// cover nothing that it does not.
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

// Where the host needs balls: around circles, and around corners.
struct AroundCircles {
  Balls balls;
  const std::uint32_t* ball;  // two of each
  Around* around;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    around[i] = around_circle(balls.grown[ball[2 * i]], balls.grown[ball[2 * i + 1]]);
  }
};
struct AroundCorners {
  Balls balls;
  const Corner* corners;
  Around* around;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    const Sphere& first = balls.grown[corners[i].name.ball[0]];
    around[i] = around_corner(first, corners[i], balls.probe);
  }
};
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

// What the host found out about a circle.
struct ReplaceCounts {
  const std::uint32_t* circle;
  const std::uint64_t* by;
  std::uint64_t* count;
  VDWMESH_HD void operator()(std::uint64_t i) const { count[circle[i]] = by[i]; }
};

struct EmitArcs {
  Circles circles;
  const std::uint64_t* first;  // of each circle, and the end
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
      arcs[next++] = {{a, b},
                      {start, end},
                      {kNone, kNone},
                      static_cast<std::uint32_t>(first[i]),
                      static_cast<std::uint32_t>(first[i + 1]),
                      turns};
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
    arcs[first[m.circle] + m.place] = {{m.ball[0], m.ball[1]},
                                       {m.third[0], m.third[1]},
                                       {kNone, kNone},
                                       static_cast<std::uint32_t>(first[m.circle]),
                                       static_cast<std::uint32_t>(first[m.circle + 1]),
                                       m.turns};
  }
};

// A corner is made by the arc of its two lowest balls.
VDWMESH_HD inline bool makes_corner(const Arc& arc, int end) {
  return !arc.is_ring() && arc.third[end] > arc.ball[1];
}

struct CountCorners {
  const Arc* arcs;
  std::uint64_t* count;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    count[i] = (makes_corner(arcs[i], 0) ? 1u : 0u) + (makes_corner(arcs[i], 1) ? 1u : 0u);
  }
};

struct EmitCorners {
  Balls balls;
  const Arc* arcs;
  const std::uint64_t* first;  // by arc
  Corner* corners;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    std::uint64_t next = first[i];
    for (int end = 0; end < 2; ++end) {
      if (!makes_corner(arcs[i], end)) continue;
      Corner c{};
      c.name = corner_of(arcs[i], end);
      for (std::uint32_t& arc : c.arc) arc = kNone;
      const CommonPointsInDouble points = points_of(
          balls.grown[c.name.ball[0]], balls.grown[c.name.ball[1]], balls.grown[c.name.ball[2]]);
      c.placing = points.placing;
      c.half_chord = points.half_chord;
      c.at = points.foot + (c.name.above ? c.half_chord : -c.half_chord) * points.normal;
      c.low = c.half_chord < balls.probe;
      corners[next++] = c;
    }
  }
};

// Sets of which an element is wrong are measured elsewhere; their other elements may be anything.
struct FailedSets {
  const std::uint32_t* set;  // by ball; null: one set
  std::uint8_t* failed;
  VDWMESH_HD bool has(std::uint32_t ball) const { return failed[set ? set[ball] : 0] != 0; }
  VDWMESH_HD void put(std::uint32_t ball) const { failed[set ? set[ball] : 0] = 1; }
};

struct MarkCorners {
  const Corner* corners;
  FailedSets sets;
  std::uint8_t* wide;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    wide[i] = corners[i].placing == Placing::wide;
    if (corners[i].placing == Placing::none) sets.put(corners[i].name.ball[0]);
  }
};
struct TakeCorners {
  const std::uint32_t* listed;
  const Corner* corners;
  Corner* out;
  VDWMESH_HD void operator()(std::uint64_t i) const { out[i] = corners[listed[i]]; }
};
struct PutCorners {
  const std::uint32_t* listed;
  const Corner* made;
  Corner* corners;
  VDWMESH_HD void operator()(std::uint64_t i) const { corners[listed[i]] = made[i]; }
};

// Finds the corners at the ends of each arc. Arcs stand in the order of their lower balls, and
// corners in the order of the arcs that made them.
struct LinkCorners {
  Arc* arcs;
  std::uint64_t arc_count;
  const std::uint64_t* first_corner;  // by arc, and the end
  Corner* corners;
  std::uint8_t* failed;  // by arc

  VDWMESH_HD void operator()(std::uint64_t i) const {
    failed[i] = 0;
    if (arcs[i].is_ring()) return;
    for (int end = 0; end < 2; ++end) {
      const CornerName name = corner_of(arcs[i], end);
      const std::uint64_t stop = first_corner[first_arc(name.ball[0] + 1)];
      std::uint64_t c = first_corner[first_arc(name.ball[0])];
      while (c < stop && !(corners[c].name == name)) ++c;
      if (c == stop) {
        failed[i] = 1;
        continue;
      }
      arcs[i].corner[end] = static_cast<std::uint32_t>(c);
      const int slot = slot_of(name, arcs[i].ball[0], arcs[i].ball[1]);
      corners[c].arc[slot] = static_cast<std::uint32_t>(i);
      corners[c].end[slot] = static_cast<std::uint8_t>(end);
    }
  }
  VDWMESH_HD std::uint64_t first_arc(std::uint32_t ball) const {
    std::uint64_t low = 0, high = arc_count;
    while (low < high) {
      const std::uint64_t middle = low + (high - low) / 2;
      if (arcs[middle].ball[0] < ball) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  }
};

struct CheckLinks {
  const Arc* arcs;
  const std::uint8_t* arc_failed;
  FailedSets sets;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    if (arc_failed[i]) sets.put(arcs[i].ball[0]);
  }
};
struct CheckCorners {
  const Corner* corners;
  FailedSets sets;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    for (const std::uint32_t arc : corners[i].arc) {
      if (arc == kNone) sets.put(corners[i].name.ball[0]);
    }
  }
};

// An arc whose length may be nothing joins corners that are one probe; the host gathers them.
inline constexpr double kLeastArc = 1e-10;  // of the largest of the two balls

struct ShapeArcs {
  Balls balls;
  const Arc* arcs;
  const Corner* corners;
  ArcShape* shapes;
  FailedSets sets;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    const Arc& arc = arcs[i];
    if (sets.has(arc.ball[0])) return;
    shapes[i] = arc_shape(balls, corners, arc);
    const double a = balls.grown[arc.ball[0]].radius, b = balls.grown[arc.ball[1]].radius;
    if (!(shapes[i].angle * shapes[i].radius > kLeastArc * (a > b ? a : b))) {
      sets.put(arc.ball[0]);
    }
  }
};

struct MarkLow {
  const Corner* corners;
  FailedSets sets;
  std::uint8_t* low;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    low[i] = corners[i].low && !sets.has(corners[i].name.ball[0]);
  }
};

// Low probes as balls.
struct PlaceLow {
  Balls balls;
  const Corner* corners;
  const std::uint32_t* low;  // corners
  Sphere* probes;
  std::uint32_t* set;     // of each
  std::uint32_t* low_of;  // by corner

  VDWMESH_HD void operator()(std::uint64_t i) const {
    const Corner& c = corners[low[i]];
    probes[i] = {balls.grown[c.name.ball[0]].center + c.at, balls.probe};
    set[i] = balls.set ? balls.set[c.name.ball[0]] : 0;
    low_of[low[i]] = static_cast<std::uint32_t>(i);
  }
};

struct MeasureLow {
  Balls balls;
  const Arc* arcs;
  const ArcShape* shapes;
  const Corner* corners;
  LowList low;
  PatchMeasures* patches;
  std::uint8_t* doubtful;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    const std::uint32_t self = low.corner[i];
    CutPatch patch(balls, corners, arcs, shapes, self,
                   corner_polygon(balls, corners[self], arcs, shapes));
    PatchMeasures made{};
    doubtful[i] = patch.measure(low, static_cast<std::uint32_t>(i), made) ? 0 : 1;
    patches[i] = made;
  }
};

// The corners of patches that the host is to decide.
struct TakePatches {
  const std::uint32_t *listed, *low;
  const Corner* corners;
  Corner* out;
  VDWMESH_HD void operator()(std::uint64_t i) const { out[i] = corners[low[listed[i]]]; }
};

struct PutPatches {
  const std::uint32_t* low;
  const PatchMeasures* made;
  PatchMeasures* patches;
  VDWMESH_HD void operator()(std::uint64_t i) const { patches[low[i]] = made[i]; }
};

// Entries of rows: two for each arc, then three for each corner.
struct ArcTerms {
  Balls balls;
  const Arc* arcs;
  const ArcShape* shapes;
  FailedSets sets;
  const Vec3d* home;  // by set
  Terms* terms;
  std::uint32_t* key;  // the ball
  std::uint32_t* entry;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    const Arc& arc = arcs[i];
    const bool failed = sets.has(arc.ball[0]);
    const Vec3d& at = home[balls.set ? balls.set[arc.ball[0]] : 0];
    for (int side = 0; side < 2; ++side) {
      const std::uint64_t e = 2 * i + static_cast<std::uint64_t>(side);
      key[e] = arc.ball[side];
      entry[e] = static_cast<std::uint32_t>(e);
      terms[e] =
          failed ? Terms{} : saddle_terms(balls, arc, shapes[i], arc.circle_first == i, side, at);
    }
  }
};

struct CornerTerms {
  Balls balls;
  const Arc* arcs;
  const ArcShape* shapes;
  const Corner* corners;
  const PatchMeasures* patches;
  const std::uint32_t* low_of;
  FailedSets sets;
  const Vec3d* home;
  std::uint64_t first;  // entry
  Terms* terms;
  std::uint32_t* key;
  std::uint32_t* entry;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    const Corner& corner = corners[i];
    const bool failed = sets.has(corner.name.ball[0]);
    for (int slot = 0; slot < 3; ++slot) {
      const std::uint64_t e = first + 3 * i + static_cast<std::uint64_t>(slot);
      key[e] = corner.name.ball[slot];
      entry[e] = static_cast<std::uint32_t>(e);
      terms[e] = Terms{};
    }
    if (failed) return;
    const Polygon polygon = corner_polygon(balls, corner, arcs, shapes);
    const PatchMeasures patch =
        corner.low ? patches[low_of[i]] : whole_patch(balls, corner, polygon);
    const Vec3d& at = home[balls.set ? balls.set[corner.name.ball[0]] : 0];
    for (int slot = 0; slot < 3; ++slot) {
      terms[first + 3 * i + static_cast<std::uint64_t>(slot)] =
          corner_terms(balls, corner, patch, polygon.turning[slot], slot, at);
    }
  }
};

// Sums the entries of each ball, in their order, and adds its contact patch.
struct SumRows {
  Balls balls;
  const std::uint32_t* key;    // ascending
  const std::uint32_t* entry;  // of each key
  std::uint64_t entries, arc_entries;
  const Terms* terms;
  const Vec3d* home;
  FailedSets sets;
  BallRow* rows;
  CheckRow* checks;

  VDWMESH_HD void operator()(std::uint64_t v) const {
    const auto ball = static_cast<std::uint32_t>(v);
    Terms sum{};
    CheckRow check{};
    for (std::uint64_t e = first_of(ball); e < entries && key[e] == ball; ++e) {
      const Terms& t = terms[entry[e]];
      add(sum, t);
      if (entry[e] < arc_entries) check.saddle_layer += t.layer;
      check.counts.arcs += t.arcs;
      check.counts.rings += t.rings;
      check.counts.spindles += t.spindles;
      check.counts.cusps += t.cusps;
      check.counts.probes += t.probes;
      check.counts.low_probes += t.low_probes;
      check.counts.crease_arcs += t.crease_arcs;
    }
    const double grown = balls.grown[v].radius, r = balls.radius[v];
    const double omega = balls.measures[v].area / (grown * grown);
    const double whole = (omega + sum.bend) / (2 * kPi), pieces = std::rint(whole);
    constexpr double kWhole = 1e-6;
    if (!(std::abs(whole - pieces) < kWhole)) sets.put(ball);
    const std::uint64_t row = balls.id ? balls.id[v] : v;
    check.contact_layer = omega * (grown * grown * grown - r * r * r) / 3;
    rows[row] = {r * r * omega, sum.saddle, sum.concave,
                 balls.measures[v].volume - sum.layer - check.contact_layer};
    const Vec3d at = balls.grown[v].center - home[balls.set ? balls.set[v] : 0];
    check.normal = sum.normal + (r * r) * sum.contact;
    check.flux = sum.flux + r * r * (dot(at, sum.contact) + r * omega) / 3;
    check.creases = sum.creases;
    check.sixths = sum.sixths + 6 * static_cast<std::int32_t>(pieces);
    checks[row] = check;
  }
  VDWMESH_HD std::uint64_t first_of(std::uint32_t ball) const {
    std::uint64_t low = 0, high = entries;
    while (low < high) {
      const std::uint64_t middle = low + (high - low) / 2;
      if (key[middle] < ball) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  }
};

// Rows of one set that are summed one after another.
struct Chunk {
  std::uint64_t begin, end;
};
struct ChunkSum {
  BallRow row;
  Vec3d normal;
  double flux, contact_layer, saddle_layer;
  std::uint64_t creases;
  std::int64_t sixths;
  RowCounts counts;
};
struct SumChunks {
  const Chunk* chunks;
  const BallRow* rows;
  const CheckRow* checks;
  ChunkSum* sums;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    ChunkSum sum{};
    for (std::uint64_t v = chunks[i].begin; v < chunks[i].end; ++v) {
      const BallRow& row = rows[v];
      const CheckRow& check = checks[v];
      sum.row.contact += row.contact;
      sum.row.saddle += row.saddle;
      sum.row.concave += row.concave;
      sum.row.volume += row.volume;
      sum.normal = sum.normal + check.normal;
      sum.flux += check.flux;
      sum.contact_layer += check.contact_layer;
      sum.saddle_layer += check.saddle_layer;
      sum.creases += check.creases;
      sum.sixths += check.sixths;
      sum.counts.arcs += check.counts.arcs;
      sum.counts.rings += check.counts.rings;
      sum.counts.spindles += check.counts.spindles;
      sum.counts.cusps += check.counts.cusps;
      sum.counts.probes += check.counts.probes;
      sum.counts.low_probes += check.counts.low_probes;
      sum.counts.crease_arcs += check.counts.crease_arcs;
    }
    sums[i] = sum;
  }
};

}  // namespace vdwmesh::excluded::elements
