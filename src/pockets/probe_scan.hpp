// Places for probes of all radii, and the widest ways from them to the outside.
//
// A probe of radius q fits where the clearance, the distance to the nearest sphere, is q or more.
// As q falls, places appear at summits of the clearance, and join at passes: circles that touch
// three balls. Both are in closed form, for any radii, and do not hang on a grid or on a step. The
// outside is where a probe of some large radius can come from infinity.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/errors.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class Monitor;

// Three balls that a probe touches in the plane of their centres when it just passes.
struct ProbeGate {
  Vec3d center;   // Å
  double radius;  // Å: of the probe
  std::array<SphereId, 3> spheres;
};

// A place that is closed on all sides to probes between two radii: a branch of the merge tree.
struct ScanPlace {
  Vec3d center;   // Å: where the largest probe fits
  double radius;  // Å: of that probe; above it the place is gone
  // Where it joins a place for larger probes, or the outside, when probes become smaller. Nothing
  // if it is still closed at the lowest radius.
  std::optional<ProbeGate> gate;
  std::optional<std::size_t> joins;  // index of that place; nothing for the outside
  std::optional<double> opens_at;    // Å: below this radius it is joined to the outside
};

struct ProbeScan {
  std::vector<ScanPlace> places;  // by falling radius; a place joins one before it
  // Numbers of voids per radius (Å), at the radii that were triangulated, by exact predicates.
  std::map<double, std::uint64_t> voids;
  // The places explain all these numbers. If not, triangles of equal size or coplanar centres hide
  // some.
  bool is_complete;
};

// The places for probes from `lowest` to `highest` (Å). Throws InvalidInput for an empty set, for
// radii that are not in order or a lowest probe for which a ball would vanish, LimitExceeded and
// Cancelled. The limit (bytes) is that of one triangulation.
ProbeScan probe_scan(const SphereSet& atoms, double lowest, double highest,
                     Monitor* monitor = nullptr, std::uint64_t memory_limit = kNoMemoryLimit);

// A place on a way.
struct WayPoint {
  Vec3d center;      // Å
  double along;      // Å: length of the way so far
  double radius;     // Å: of the largest probe there
  SphereId nearest;  // the sphere that it touches
  bool is_gate;      // the way is nowhere narrower between the summits beside it
};

struct WayOut {
  std::vector<WayPoint> points;
  std::vector<ProbeGate> gates;   // in the order of the way
  double length;                  // Å
  double bottleneck;              // Å: radius of the narrowest gate; that of the start without one
  std::vector<SphereId> spheres;  // all that are nearest to a point or at a gate, ascending
};

inline constexpr double kOutsideProbe = 5;  // Å

// The widest way from a place to the outside, which a probe of radius `outside_probe` (Å) can
// reach. It climbs from the place, which is no centre, to a summit; from there every pass on it is
// as wide as can be. If a larger probe fits at the start, that is the outside. Throws InvalidInput
// also if a ball would have to vanish before there is a way.
WayOut way_out(const SphereSet& atoms, const Vec3d& from, double outside_probe = kOutsideProbe,
               Monitor* monitor = nullptr, std::uint64_t memory_limit = kNoMemoryLimit);

// The place where a way from a sphere begins: of the orthogonal centres of the tetrahedra at it,
// the one with most room, if a probe of radius kOutsideProbe does not fit there. Throws
// InvalidInput if the sphere is hidden by others.
Vec3d place_beside(const SphereSet& atoms, SphereId sphere);

}  // namespace vdwmesh
