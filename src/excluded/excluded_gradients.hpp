// First derivatives of the exact area and volume of the solvent-excluded surface, by the centres
// and radii of the atoms and by the probe's radius. excluded_measures() makes them, if they are
// wanted, from the patches that it measures.
//
// The derivatives are exact, in closed form. The volume changes by the integral of the speed of the
// surface along its normal, the area by that of the speed times the sum of the principal
// curvatures, and along creases. A contact patch moves with its atom; a saddle with the circle of
// its two atoms; a concave patch with its probe, which follows three atoms. Smooth seams between
// patches add nothing, nor do the cusps of spindles. excluded_gradients.cpp has the formulas.
//
// Where no derivative exists, the result is finite all the same, and the case is counted:
// - a probe at more than three atoms would leave some of them if they moved. Its motion is then the
//   one of least squares, so that atoms which symmetry exchanges have equal derivatives;
// - a probe in the plane of its atoms moves infinitely fast across it. The motion along it counts;
// - two probes whose concave patches touch in one point, from outside: that of the patches cut;
// - of equal atoms the lowest index has the derivatives of one such atom alone, the others 0. So
//   have atoms inside of others.
// The measures themselves jump where the last probe of a cavity disappears, which no derivative
// shows.
#pragma once

#include <cstdint>
#include <vector>

#include "measures/union_gradients.hpp"

namespace vdwmesh {

struct ExcludedGradients {
  // In the order of the set: of the area (Å) and the volume (Å²), each with weight 1, by the centre
  // and the radius of an atom while the probe keeps its radius.
  std::vector<BallGradient> per_atom;
  double area_probe, volume_probe;  // Å, Å²: by the radius of the probe
  // Probes of the first three cases, or all but there: within 1e-9 of the largest grown ball.
  std::uint64_t kink_probes;
  std::uint64_t kink_atoms;  // equal to one of a lower index
};

}  // namespace vdwmesh
