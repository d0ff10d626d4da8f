// The steps that sum what each ball has of its arcs and corners, one call for each element: the
// bodies of kernels. For the library's own use, on the host and on a CUDA device.
#pragma once

#include "excluded/elements/element_shapes.hpp"
#include "excluded/elements/elements.hpp"

namespace vdwmesh::excluded::elements {

// Entries of rows: two for each arc, then three for each corner.
struct ArcTerms {
  Balls balls;
  const Arc* arcs;
  const ArcShape* shapes;
  FailedSets sets;
  const Vec3d* home;  // by set
  ElementShare* terms;
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
      terms[e] = failed ? ElementShare{}
                        : saddle_terms(balls, arc, shapes[i], arc.circle_first == i, side, at);
    }
  }
};

struct CornerTerms {
  Balls balls;
  const Arc* arcs;
  const ArcShape* shapes;
  const ProbeCorner* corners;
  const PatchMeasures* patches;
  const std::uint32_t* low_of;
  FailedSets sets;
  const Vec3d* home;
  std::uint64_t first;  // entry
  ElementShare* terms;
  std::uint32_t* key;
  std::uint32_t* entry;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    const ProbeCorner& corner = corners[i];
    const bool failed = sets.has(corner.name.ball[0]);
    for (int slot = 0; slot < 3; ++slot) {
      const std::uint64_t e = first + 3 * i + static_cast<std::uint64_t>(slot);
      key[e] = corner.name.ball[slot];
      entry[e] = static_cast<std::uint32_t>(e);
      terms[e] = ElementShare{};
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
  const ElementShare* terms;
  const Vec3d* home;
  FailedSets sets;
  BallRow* rows;
  CheckRow* checks;

  VDWMESH_HD void operator()(std::uint64_t v) const {
    const auto ball = static_cast<std::uint32_t>(v);
    ElementShare sum{};
    CheckRow check{};
    const auto key_at = [this](std::uint64_t place) { return key[place]; };
    for (std::uint64_t e = lower_bound(entries, ball, key_at); e < entries && key[e] == ball; ++e) {
      const ElementShare& t = terms[entry[e]];
      add(sum, t);
      if (entry[e] < arc_entries) check.saddle_layer += t.layer;
      check.counts += t;
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
};

// Rows of one set that are summed one after another.
struct Chunk {
  std::uint64_t begin, end;
};
struct ChunkSum {
  BallRow row;
  CheckRow check;
};
struct SumChunks {
  const Chunk* chunks;
  const BallRow* rows;
  const CheckRow* checks;
  ChunkSum* sums;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    ChunkSum sum{};
    for (std::uint64_t v = chunks[i].begin; v < chunks[i].end; ++v) {
      sum.row += rows[v];
      sum.check += checks[v];
    }
    sums[i] = sum;
  }
};

}  // namespace vdwmesh::excluded::elements
