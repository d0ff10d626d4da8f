// The elements of the excluded surfaces of a batch as flat arrays, on the host or on a CUDA device.
// For the library's own use.
//
// Terms. A grown ball is an atom with the probe's radius added. An arc is a part of the circle of
// two grown balls that no third one covers: a probe rolls along it, and a saddle lies below. A
// corner is a point of three grown balls that no fourth one covers: a probe stands there, and a
// concave patch lies below. A row is what one ball has of all its elements.
//
// Claim. An element has the same name from whichever ball it is found: a ball is named by its place
// in the list, an arc by its two balls and its place on their circle, a corner by its three balls,
// ascending, and the side of their plane. So elements are matched by names, and no position is
// compared with another one.
//
// The steps, in the order of element_pipeline.hpp, are in arc_steps.hpp, corner_steps.hpp and
// row_steps.hpp.
#pragma once

#include <cmath>
#include <cstdint>

#include "excluded/elements/circle_arcs.hpp"
#include "measures/exact_union.hpp"

namespace vdwmesh::excluded::elements {

// The balls of one set or several, in the order in which they are named.
struct Balls {
  const Sphere* grown;             // by the probe
  const double* radius;            // without the probe
  const SphereMeasures* measures;  // of the grown balls
  const std::uint32_t* id;         // index of the ball's row; null: its place
  const std::uint32_t* set;        // null: one set
  std::uint32_t size;
  double probe;
};

// For each ball the other balls of its set that overlap it.
struct Overlaps {
  const std::uint64_t* first;  // size + 1
  const std::uint32_t* other;
};

// Sets that failed: an element could not be decided. They are measured elsewhere
// (excluded_measures()), and their elements here have no meaning.
struct FailedSets {
  const std::uint32_t* set;  // by ball; null: one set
  std::uint8_t* failed;
  VDWMESH_HD bool has(std::uint32_t ball) const { return failed[set ? set[ball] : 0] != 0; }
  VDWMESH_HD void put(std::uint32_t ball) const { failed[set ? set[ball] : 0] = 1; }
};

// The first place in an ascending list whose key is not below `key`. key_at(place) reads the list.
template <class KeyAt>
VDWMESH_HD std::uint64_t lower_bound(std::uint64_t size, std::uint32_t key, const KeyAt& key_at) {
  std::uint64_t low = 0, high = size;
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (key_at(middle) < key) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

// An exposed arc, counter-clockwise about the axis from the lower ball to the higher one.
struct Arc {
  std::uint32_t ball[2];    // ascending
  std::uint32_t third[2];   // balls that cover the circle before start and after end; kNone: ring
  std::uint32_t corner[2];  // at start and end
  std::uint32_t circle_first, circle_end;  // the arcs of the same circle, in their order around it
  double turns;                            // roughly its length: 4 is a whole turn

  VDWMESH_HD bool is_ring() const { return third[0] == kNone; }
  VDWMESH_HD std::uint32_t next(std::uint32_t self) const {
    return self + 1 == circle_end ? circle_first : self + 1;
  }
  VDWMESH_HD std::uint32_t previous(std::uint32_t self) const {
    return self == circle_first ? circle_end - 1 : self - 1;
  }
};

struct CornerName {
  std::uint32_t ball[3];  // ascending
  std::uint32_t above;    // 1 on the side of their plane from which they are counter-clockwise

  VDWMESH_HD bool operator==(const CornerName& o) const {
    return ball[0] == o.ball[0] && ball[1] == o.ball[1] && ball[2] == o.ball[2] && above == o.above;
  }
};

// How the common points of three spheres are placed: in double (plain), in more digits by the host
// (wide; simplex_shape.cpp has the same rule), or not at all, because two of the balls all but
// coincide.
enum class Placing : std::uint8_t { plain, wide, none };

// A probe that touches three balls.
struct ProbeCorner {
  CornerName name;
  std::uint32_t arc[3];  // the arcs of the balls 0 and 1, 1 and 2, 0 and 2
  std::uint8_t end[3];   // which end of that arc the corner is: 0 start, 1 end
  std::uint8_t low;
  Placing placing;
  Vec3d at;  // the probe's centre, relative to that of ball 0
  double half_chord;
};

// The name of a corner of three balls in any order; `above` belongs to that order.
VDWMESH_HD inline CornerName corner_name(std::uint32_t a, std::uint32_t b, std::uint32_t c,
                                         bool above) {
  const auto order = [&above](std::uint32_t& x, std::uint32_t& y) {
    if (x <= y) return;
    const std::uint32_t z = x;
    x = y;
    y = z;
    above = !above;
  };
  order(a, b);
  order(b, c);
  order(a, b);
  return {{a, b, c}, above ? 1u : 0u};
}

// The corner at an end of an arc. Where an arc starts, the third ball is behind the corner seen
// along the circle, so that axis, third ball and corner are right-handed.
VDWMESH_HD inline CornerName corner_of(const Arc& arc, int end) {
  return corner_name(arc.ball[0], arc.ball[1], arc.third[end], end == 0);
}

// The index in ProbeCorner::arc of the arc of two of a corner's balls, a < b.
VDWMESH_HD inline int slot_of(const CornerName& name, std::uint32_t a, std::uint32_t b) {
  if (a != name.ball[0]) return 1;
  return b == name.ball[1] ? 0 : 2;
}

// Whether a ball is one of the corner's.
VDWMESH_HD inline bool touches(const CornerName& name, std::uint32_t ball) {
  return name.ball[0] == ball || name.ball[1] == ball || name.ball[2] == ball;
}

// The common points of three spheres, from the centre of the first: `foot` in their plane, and the
// unit normal from which they are counter-clockwise.
struct CommonPointsInDouble {
  Vec3d foot, normal;
  double half_chord;
  Placing placing;
};
VDWMESH_HD inline CommonPointsInDouble points_of(const Sphere& a, const Sphere& b,
                                                 const Sphere& c) {
  const Vec3d ab = b.center - a.center, ac = c.center - a.center, normal = cross(ab, ac);
  const double square = squared_norm(normal);
  const double pb = (squared_norm(ab) + (a.radius - b.radius) * (a.radius + b.radius)) / 2,
               pc = (squared_norm(ac) + (a.radius - c.radius) * (a.radius + c.radius)) / 2;
  const Vec3d foot = (1 / square) * cross(pb * ac - pc * ab, normal);
  const double rest = (a.radius - norm(foot)) * (a.radius + norm(foot));
  const double chord = rest > 0 ? std::sqrt(rest) : 0;
  // The squared sine of the smallest angle, but for a factor of 2 at most.
  constexpr double kThin = 1e-6, kTooThin = 1e-10, kShort = 1e-3;
  const double bb = squared_norm(ab), cc = squared_norm(ac), longest = bb > cc ? bb : cc;
  const double sine = square / (longest * longest);
  const bool is_good = sine > kThin && chord > kShort * a.radius && chord > kShort * b.radius &&
                       chord > kShort * c.radius;
  const Placing placing =
      is_good ? Placing::plain : (sine > kTooThin && rest > 0 ? Placing::wide : Placing::none);
  return {foot, (1 / std::sqrt(square)) * normal, chord, placing};
}

// What one ball gets of one arc or corner. Sums of these over a ball's arcs and corners, with its
// contact patch, are its row.
struct ElementShare {
  double saddle, concave;  // areas
  double layer;            // volume between the accessible and the excluded surface
  double bend;             // 2 π χ of the contact pieces less their solid angle
  Vec3d contact;           // ∫ n dω over the contact pieces
  Vec3d normal;            // ∫ n dA over the rest
  double flux;             // ∫ q · n dA / 3 over the rest, from the set's home
  std::uint64_t creases;   // signed names of creases, which two patches cancel
  std::int32_t sixths;     // six times its Euler characteristic
  std::uint16_t crease_arcs;
  std::uint8_t arcs, rings, spindles, cusps, probes, low_probes;
};

// The counts of a ball's row: of the arcs and corners whose lowest ball it is.
struct RowCounts {
  std::uint32_t arcs, rings, spindles, cusps, probes, low_probes, crease_arcs;

  // Adds counts of the same names: those of another row, or of an arc or a corner.
  template <class Counts>
  VDWMESH_HD RowCounts& operator+=(const Counts& other) {
    arcs += other.arcs;
    rings += other.rings;
    spindles += other.spindles;
    cusps += other.cusps;
    probes += other.probes;
    low_probes += other.low_probes;
    crease_arcs += other.crease_arcs;
    return *this;
  }
};

// Of one ball.
struct BallRow {
  double contact, saddle, concave, volume;

  VDWMESH_HD BallRow& operator+=(const BallRow& other) {
    contact += other.contact;
    saddle += other.saddle;
    concave += other.concave;
    volume += other.volume;
    return *this;
  }
};
struct CheckRow {
  Vec3d normal;  // ∫ n dA
  double flux;   // ∫ q · n dA / 3
  double contact_layer, saddle_layer;
  std::uint64_t creases;
  std::int64_t sixths;
  RowCounts counts;

  VDWMESH_HD CheckRow& operator+=(const CheckRow& other) {
    normal = normal + other.normal;
    flux += other.flux;
    contact_layer += other.contact_layer;
    saddle_layer += other.saddle_layer;
    creases += other.creases;
    sixths += other.sixths;
    counts += other.counts;
    return *this;
  }
};

VDWMESH_HD inline void add(ElementShare& sum, const ElementShare& t) {
  sum.saddle += t.saddle;
  sum.concave += t.concave;
  sum.layer += t.layer;
  sum.bend += t.bend;
  sum.contact = sum.contact + t.contact;
  sum.normal = sum.normal + t.normal;
  sum.flux += t.flux;
  sum.creases += t.creases;
  sum.sixths += t.sixths;
}

VDWMESH_HD inline std::uint64_t mixed(std::uint64_t x) {  // SplitMix64
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

// Numbers that stand for names; two names have the same by a chance of 2^-64.
VDWMESH_HD inline std::uint64_t number_of(const CornerName& n) {
  return mixed(mixed(n.ball[0] | std::uint64_t{n.ball[1]} << 32) +
               (n.ball[2] | std::uint64_t{n.above} << 32));
}
// The cusp of a circle near one of its two balls.
VDWMESH_HD inline std::uint64_t number_of_cusp(std::uint32_t a, std::uint32_t b,
                                               std::uint32_t near) {
  const std::uint32_t low = a < b ? a : b, high = a < b ? b : a;
  return mixed(mixed(low | std::uint64_t{high} << 32) + 3 * (1 + std::uint64_t{near}));
}
// The point common to three probes, of which `positive` tells the side: exchanging two probes
// exchanges the sides.
VDWMESH_HD inline std::uint64_t number_of_point(std::uint64_t a, std::uint64_t b, std::uint64_t c,
                                                bool positive) {
  const auto order = [&positive](std::uint64_t& x, std::uint64_t& y) {
    if (x <= y) return;
    const std::uint64_t z = x;
    x = y;
    y = z;
    positive = !positive;
  };
  order(a, b);
  order(b, c);
  order(a, b);
  return mixed(mixed(mixed(a) + b) + c + (positive ? 1 : 0));
}
// A crease seen from `probe`; seen from the other one, it runs the other way and has the negative.
VDWMESH_HD inline std::uint64_t number_of_crease(std::uint64_t probe, std::uint64_t other,
                                                 std::uint64_t from, std::uint64_t to) {
  if (probe < other) return mixed(mixed(mixed(mixed(probe) + other) + from) + to);
  return -mixed(mixed(mixed(mixed(other) + probe) + to) + from);
}

}  // namespace vdwmesh::excluded::elements
