// Pockets of a union of balls: places where space is wider than on every way out, by the discrete
// flow on the regular triangulation (Edelsbrunner, Facello and Liang 1998, "On the definition and
// the construction of pockets in macromolecules", Discrete Appl. Math. 88, 83; Liang, Edelsbrunner
// and Woodward 1998, "Anatomy of protein pockets and cavities", Protein Sci. 7, 1884).
//
// A tetrahedron outside the dual complex is empty. It flows to its neighbour across a face if its
// orthogonal centre lies strictly beyond that face; it may flow to several. Every empty tetrahedron
// from which some flow leaves the convex hull is outside. Those that remain, joined across faces
// that are not in the complex, are the pockets. Signs are exact, so which tetrahedra make a pocket
// does not hang on rounding. Sizes are alpha values: the squared radius (Å²) of the sphere that is
// orthogonal to a simplex's balls, above 0 where there is room.
//
// Balls are closed. A centre exactly in the plane of a face does not flow across it; such ties are
// counted. For the probe of radius p, all balls are grown by p.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class Monitor;

enum class PocketKind {
  enclosed,  // a void: no way out
  pocket,    // one mouth
  channel    // two mouths or more
};
// "void", "pocket", "channel".
std::string_view kind_name(PocketKind kind);

// A connected opening of a pocket: triangles of the triangulation between it and the outside. They
// are not in the dual complex, and connected across edges that are not.
struct Mouth {
  double area, rim;  // Å², Å: its triangles less all balls, and the arcs of balls in them
  double area_sum, rim_sum;  // the same by CASTp's sums
  Vec3d center;              // Å: centroid of the triangles
  std::uint64_t faces;       // triangles
  // Their spheres, counter-clockwise seen from outside the pocket; with PocketMeasures::exact.
  std::vector<std::array<SphereId, 3>> triangles;
};

// A sphere with area in a pocket, Å².
struct LiningSphere {
  SphereId id;
  double area;
};

struct Pocket {
  PocketKind kind;
  // Å³, Å²: the pocket's tetrahedra less all balls, and the area of spheres in there; exact.
  double volume, area;
  // CASTp's sums over the simplices. They are `volume` and `area` for voids, but not for pockets:
  // balls from outside a pocket poke through its faces. They may even be negative.
  double volume_sum, area_sum;
  std::vector<Mouth> mouths;         // by falling area
  std::vector<LiningSphere> lining;  // ascending ids; areas of 0 to rounding are left out
  std::uint64_t spheres;             // vertices of its tetrahedra that are in the dual complex
  std::vector<SphereId> corners;     // the same, by ascending ids
  // For each tetrahedron its orthogonal centre, and the distance from there to the nearest of its
  // spheres; as fpocket's alpha spheres, for pictures. With PocketMeasures::exact.
  std::vector<Sphere> alpha_spheres;
  std::vector<std::array<SphereId, 4>> cells;  // tetrahedra by their spheres, positively oriented;
                                               // with PocketMeasures::exact
  std::uint64_t tetrahedra, sinks;             // a sink has no flow out of it
  std::uint64_t poked_faces;                   // faces of mouths through which flow comes in
  // The sink of greatest size, the centre (Å) and the size (Å²) of its orthogonal sphere.
  Vec3d depth_center;
  double depth_alpha;
  // Å²: the size of the smallest face on the best way from there to infinity. Above 0 for pockets,
  // below for voids.
  double bottleneck_alpha;
  // The same in distances, which power is not if radii differ. The place of greatest clearance that
  // is found by climbing from the sinks, and its clearance (Å), the distance to the nearest sphere:
  // a probe may be larger by that much. If climbing leaves the pocket, it is the sink itself.
  Vec3d clear_place;
  std::optional<double> clearance;  // with PocketMeasures::exact
  // Å: the greatest clearance with a way from there to infinity, negative for voids. Equal to
  // `clearance` if nothing traps the probe there; nothing if a ball would have to vanish.
  std::optional<double> bottleneck_clearance;
};

// Å: the least change of the probe's radius with which a void opens, the way out of a pocket
// closes, or its deepest place is lost. Nothing if clearances were not computed.
std::optional<double> probe_margin(const Pocket& pocket);

struct PocketTable {
  std::vector<Pocket> pockets;  // by falling volume
  std::uint64_t empty_tetrahedra;
  // Faces of empty tetrahedra that have the orthogonal centre exactly in their plane, and
  // neighbours with one orthogonal sphere. With either, the pockets depend on how ties are broken.
  std::uint64_t face_ties, cell_ties;
};

// sums: `volume`, `area` and mouths are those of CASTp's sums, and lining and clearances are left
// out, which takes a fraction of the time.
enum class PocketMeasures { exact, sums };

struct PocketOptions {
  PocketMeasures measures = PocketMeasures::exact;
  Monitor* monitor = nullptr;
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes, of the triangulation
};

// The pockets of the union. A set without a tetrahedron has none. Does not depend on the order of
// the spheres, except for their ids, nor on the number of threads.
// Throws InvalidInput for an empty set or if a figure is not finite in double, LimitExceeded, and
// Cancelled.
PocketTable pockets(const SphereSet& spheres, const PocketOptions& options = {});

}  // namespace vdwmesh
