// The solvent-excluded surface of a set of balls: its exact area, volume and topology, without a
// mesh.
//
// A probe is a ball of radius p that overlaps no atom. The excluded solid is the complement of all
// probes taken as open balls: everything that a probe cannot reach. Its boundary is the
// solvent-excluded surface of Connolly 1983, "Analytical molecular surface calculation". It has
// three kinds of patches, one patch for each element of the accessible surface, which is the
// boundary of the union of the balls grown by p and the place of all centres of probes that touch
// an atom:
// - contact: the patch of a grown ball, shrunk back to the atom's sphere; convex;
// - saddle: the inner side of the torus that a probe sweeps along an arc, touching two atoms;
// - concave: the part of a probe at a corner that faces the three or more atoms that it touches.
// Where two probes at corners overlap, their concave patches end in a crease. If the circle on
// which a probe rolls is smaller than p and lies between its atoms, the saddle ends in two cusps.
//
// The elements of the accessible surface come from the dual complex of the grown balls, with exact
// predicates. Areas, fluxes and creases are computed in double. docs/excluded_surface.md has the
// formulas and what is certified, what is checked and what is counted.
//
// Degenerate input. Corners that are one point, as those of a probe that touches four or more atoms
// of a ring, are gathered into one probe. Sheets of the surface that touch without overlap stay
// apart. Of equal balls the lowest index owns everything.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "excluded/excluded_gradients.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class Monitor;

inline constexpr double kWaterProbe = 1.4;  // Å: the usual radius of a water molecule

struct ExcludedOptions {
  double probe = kWaterProbe;  // Å, above 0: radius of the probe
  bool per_atom = false;       // ExcludedSurface::per_atom is wanted
  bool shells = true;          // ExcludedSurface::topology is wanted
  // ExcludedMeasures::exterior is wanted. Without cavities it is a copy of the complete surface and
  // costs nothing.
  bool exterior = false;
  bool gradients = false;  // ExcludedSurface::gradients are wanted, of every surface that is made
  Monitor* monitor = nullptr;
};

// Which surface is meant: the complete one, or that of the solid with its cavities filled up.
enum class ExcludedPart : std::uint8_t { complete, exterior };

// One number for each kind of patch.
struct ByPatchKind {
  double contact, saddle, concave;
  double sum() const { return contact + saddle + concave; }
};

// The share of one atom. Contact patches belong to their atoms. A saddle is divided by the radical
// plane of the two grown balls; if that plane does not cut it, the whole saddle belongs to the atom
// on whose side it lies. A point of a concave patch belongs to the atom whose point of contact with
// the probe is nearest, so that great circles divide the patch.
//
// The volumes divide the solid: an atom has the part of its grown ball in its power cell (the
// measure of ExactUnion for the grown balls), less the layer between the accessible surface and the
// atom's share of the excluded one. So neither depends on the origin of the coordinates, and both
// sum to the totals. The volume of an atom may be negative if the atom has a concave patch but
// hardly a power cell.
struct ExcludedAtom {
  ByPatchKind area;  // Å²
  double volume;     // Å³
};

// A connected piece of the excluded surface. Its volume is what it encloses, with everything in
// there, and negative if the solid lies outside of it: then it is the wall of a cavity.
// A piece is a closed orientable surface of Euler characteristic 2 - 2 genus.
struct ExcludedShell {
  double area, volume;  // Å², Å³
  std::int64_t euler_characteristic, genus;
};

// A connected piece of the accessible surface, and what belongs to it on the excluded one. If its
// volume is negative the probes on it roll inside a cavity. The excluded patches over one component
// are not a closed surface where they meet probes of another component.
struct AccessibleComponent {
  double accessible_area, accessible_volume;  // Å², Å³
  bool is_cavity;                             // accessible_volume < 0
  double excluded_area;                       // Å², of the patches that belong to it
};

struct ExcludedTopology {
  // Outer surfaces, then walls of cavities, each by falling |volume|. The sums of area and volume
  // are those of the surface.
  std::vector<ExcludedShell> shells;
  std::int64_t euler_characteristic;  // the sum over the shells
  std::uint64_t cavities;             // shells of negative volume
  // The integral of the Gaussian curvature, with creases and their corners, over 2 π, less
  // euler_characteristic: the largest |difference| over the shells. Rounding if all is well.
  double gauss_bonnet_residual;
  // Outer surfaces, then cavities, each by falling |accessible_volume|.
  std::vector<AccessibleComponent> components;
};

// Sums over the shells.
struct ShellFigures {
  std::uint64_t outer, walls;    // numbers of outer surfaces, and of walls of cavities
  double outer_area, wall_area;  // Å²
  std::int64_t genus;
};
ShellFigures shell_figures(const ExcludedTopology& topology);

struct ExcludedCounts {
  std::uint64_t arcs;             // exposed arcs of the accessible surface, whole circles included
  std::uint64_t whole_rings;      // arcs that are whole circles, without a corner
  std::uint64_t spindle_saddles;  // arcs whose saddle is cut by its own axis
  std::uint64_t probes;           // corners of the accessible surface, gathered ones once
  std::uint64_t low_probes;       // probes nearer than p to the plane of three atoms they touch
  std::uint64_t crowded_probes;   // probes that touch more than three atoms
  // Corners that were gathered into crowded probes, and arcs without length that were dropped with
  // them. They are in no other count.
  std::uint64_t gathered_corners, dropped_arcs;
  std::uint64_t crease_arcs;  // arcs in which concave patches of two probes meet
  std::uint64_t cusps;        // points in which spindle saddles end
};

// How far the result proves itself. Everything here is 0, or rounding, if all is well.
struct ExcludedChecks {
  // |∫ n dA| / area. A closed surface has 0.
  double closure;
  // A second volume: that of the accessible solid less the layer between both surfaces. It shares
  // the elements with `volume`, but no formula.
  double check_volume;  // Å³
  // Concave patches with a decision that rounding in double left open and wide numbers settled.
  std::uint64_t extended_decisions;
  // Those of them with a tie, which the rule in docs/excluded_surface.md decided.
  std::uint64_t ties;
  // Concave patches whose boundary did not close, or whose creases the neighbour does not share:
  // their measures and the topology are not certified.
  std::uint64_t uncertified_patches;
};

// The solvent-excluded surface: the complete one, or the exterior one.
struct ExcludedSurface {
  double area, volume;       // Å², Å³ of the excluded solid
  ByPatchKind area_by_kind;  // Å²: sums to `area`
  // Å³: the layer between the accessible and the excluded surface, by the patches that it lies
  // over. accessible_volume - layer_by_kind.sum() is `volume`.
  ByPatchKind layer_by_kind;
  double accessible_area, accessible_volume;  // Å², Å³ of the grown balls, cavities counted alike
  std::optional<ExcludedTopology> topology;  // if wanted
  // That of the topology. A CUDA device knows it without the shells.
  std::optional<std::int64_t> euler_characteristic;
  // If wanted, of the complete surface alone: one entry for each sphere, in the order of the set.
  // Areas sum to area_by_kind, volumes to `volume`.
  std::vector<ExcludedAtom> per_atom;
  std::optional<ExcludedGradients> gradients;  // if wanted
  ExcludedCounts counts;
  ExcludedChecks checks;
};

struct ExcludedMeasures {
  double probe;              // Å
  ExcludedSurface complete;  // with cavities
  // If wanted: the surface of the solid with its cavities filled up. It is not a part of the
  // complete surface, because probes in a cavity no longer cut those outside.
  std::optional<ExcludedSurface> exterior;
};

// Measures the solvent-excluded surface of the balls `atoms` (radii without the probe). Results do
// not depend on the number of threads. Throws InvalidInput for an empty set, a probe that is not
// above 0 or not finite, or a grown ball that no SphereSet accepts, and as check_digits() does;
// LimitExceeded as triangulate() does; InternalError if the shares of atoms do not make up a
// surface of which doubts() says nothing else; and Cancelled. With gradients, also InvalidInput for
// one that is not finite.
ExcludedMeasures excluded_measures(const SphereSet& atoms, const ExcludedOptions& options = {});

// What the checks of a surface find wrong with it, a line for each; empty if all is well.
std::vector<std::string> doubts(const ExcludedSurface& surface);

// Throws InvalidInput if area and volume are not finite and above 0, as those of any solid are, or
// if two formulas for the volume of a certified surface differ by a tenth of it.
void check_digits(const ExcludedSurface& surface, double probe);

}  // namespace vdwmesh
