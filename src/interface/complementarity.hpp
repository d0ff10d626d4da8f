// Shape complementarity of two sides of an interface (Lawrence and Colman 1993, J. Mol. Biol. 234,
// 946): how well their excluded surfaces fit.
//
// Each side's solvent-excluded surface is that of the side alone. Its buried part is where the
// probe would overlap an atom of the other side; the part of it that is farther than the rim from
// what is not buried is the fitted patch. For a point x of a fitted patch with the normal n, and
// the nearest point x' of the other patch with n', S = -(n · n') exp(-w |x - x'|²). Sc is the mean
// of the medians of S over both patches: 1 for surfaces that are each other's image.
//
// Samples stand for the exact contact, saddle and concave patches, each for its part of their area;
// their normals and the nearest places are exact. They lie in axes that turn with the atoms, so
// that moved, turned and mirrored complexes have the same Sc but for rounding, unless all atoms lie
// on a line or in a plane. Their density is doubled until Sc settles.
#pragma once

#include <cstdint>

#include "core/monitor.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

struct ComplementarityOptions {
  double probe = 1.4;        // Å
  double weight = 0.5;       // w, Å⁻², at least 0.01
  double rim = 1.5;          // Å
  double tolerance = 0.002;  // the error of Sc with which rounds end
  double density = 16;       // samples per Å² to begin with, in four placements
  double most_density = 256;
  std::uint64_t seed = 1;
  Monitor* monitor = nullptr;
};

struct Complementarity {
  double sc = 0;  // NaN if one of the fitted patches is empty
  // Estimate: the standard error by the spread of the placements, not below what as many samples
  // leave at least; or the last change, since what is left of the bias falls as 1/density. NaN
  // where sc is.
  double error = 0;
  double median_a, median_b;  // of S over the patch of each side
  double fitted_a, fitted_b;  // Å² of the fitted patches
  double buried_a, buried_b;  // Å² of the excluded surfaces that the other side buries
  // Contact molecular surface: the integral of exp(-w d²) over the buried part, with d the distance
  // to the buried part of the other side. Å²
  double contact_a, contact_b;
  double density;  // samples per Å², of the last round
};

// `a` and `b` are the atoms of the sides, without the probe. The result does not depend on the
// number of threads. Throws InvalidInput for an empty side or a probe that is not above 0 and
// finite, and Cancelled.
Complementarity complementarity(const SphereSet& a, const SphereSet& b,
                                const ComplementarityOptions& options = {});

}  // namespace vdwmesh
