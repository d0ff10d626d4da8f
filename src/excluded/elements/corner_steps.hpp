// The steps that make corners, join arcs to them, and measure the patches of low probes, one call
// for each element: the bodies of kernels. For the library's own use, on the host and on a CUDA
// device.
#pragma once

#include "excluded/elements/element_shapes.hpp"
#include "excluded/elements/elements.hpp"
#include "excluded/elements/local_surface.hpp"
#include "excluded/elements/low_patch.hpp"

namespace vdwmesh::excluded::elements {

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
  ProbeCorner* corners;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    std::uint64_t next = first[i];
    for (int end = 0; end < 2; ++end) {
      if (!makes_corner(arcs[i], end)) continue;
      ProbeCorner c{};
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

struct AroundCorners {
  Balls balls;
  const ProbeCorner* corners;
  Around* around;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    const Sphere& first = balls.grown[corners[i].name.ball[0]];
    around[i] = around_corner(first, corners[i], balls.probe);
  }
};

struct MarkCorners {
  const ProbeCorner* corners;
  FailedSets sets;
  std::uint8_t* wide;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    wide[i] = corners[i].placing == Placing::wide;
    if (corners[i].placing == Placing::none) sets.put(corners[i].name.ball[0]);
  }
};
struct TakeCorners {
  const std::uint32_t* listed;
  const ProbeCorner* corners;
  ProbeCorner* out;
  VDWMESH_HD void operator()(std::uint64_t i) const { out[i] = corners[listed[i]]; }
};
struct PutCorners {
  const std::uint32_t* listed;
  const ProbeCorner* made;
  ProbeCorner* corners;
  VDWMESH_HD void operator()(std::uint64_t i) const { corners[listed[i]] = made[i]; }
};

// Finds the corners at the ends of each arc. Arcs stand in the order of their lower balls, and
// corners in the order of the arcs that made them.
struct LinkCorners {
  Arc* arcs;
  std::uint64_t arc_count;
  const std::uint64_t* first_corner;  // by arc: the first corner that it made; and the end
  ProbeCorner* corners;
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
    return lower_bound(arc_count, ball, [this](std::uint64_t arc) { return arcs[arc].ball[0]; });
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
  const ProbeCorner* corners;
  FailedSets sets;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    for (const std::uint32_t arc : corners[i].arc) {
      if (arc == kNone) sets.put(corners[i].name.ball[0]);
    }
  }
};

struct MarkLow {
  const ProbeCorner* corners;
  FailedSets sets;
  std::uint8_t* low;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    low[i] = corners[i].low && !sets.has(corners[i].name.ball[0]);
  }
};

// Low probes as balls.
struct PlaceLow {
  Balls balls;
  const ProbeCorner* corners;
  const std::uint32_t* low;  // corners
  Sphere* probes;
  std::uint32_t* set;     // the set of each low probe
  std::uint32_t* low_of;  // by corner: its low probe

  VDWMESH_HD void operator()(std::uint64_t i) const {
    const ProbeCorner& c = corners[low[i]];
    probes[i] = {balls.grown[c.name.ball[0]].center + c.at, balls.probe};
    set[i] = balls.set ? balls.set[c.name.ball[0]] : 0;
    low_of[low[i]] = static_cast<std::uint32_t>(i);
  }
};

struct MeasureLow {
  Balls balls;
  const Arc* arcs;
  const ArcShape* shapes;
  const ProbeCorner* corners;
  LowList low;
  PatchMeasures* patches;
  std::uint8_t* doubtful;

  VDWMESH_HD void operator()(std::uint64_t i) const {
    PatchMeasures made{};
    const auto index = static_cast<std::uint32_t>(i);
    doubtful[i] = measure_patch(balls, corners, arcs, shapes, low, index, made) ? 0 : 1;
    patches[i] = made;
  }
};

// The corners of patches that the host is to decide.
struct TakePatches {
  const std::uint32_t *listed, *low;
  const ProbeCorner* corners;
  ProbeCorner* out;
  VDWMESH_HD void operator()(std::uint64_t i) const { out[i] = corners[low[listed[i]]]; }
};

struct PutPatches {
  const std::uint32_t* low;
  const PatchMeasures* made;
  PatchMeasures* patches;
  VDWMESH_HD void operator()(std::uint64_t i) const { patches[low[i]] = made[i]; }
};

}  // namespace vdwmesh::excluded::elements
