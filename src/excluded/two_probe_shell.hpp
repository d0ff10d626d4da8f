// The space between two excluded surfaces of one molecule: what a small probe enters from outside
// and a large one does not, in all and by pockets.
//
// S(p) is the exterior excluded solid of a probe of radius p: everything that the probe does not
// reach from outside, cavities filled. A large probe contains small ones, so S(small) lies in
// S(large); the shell is the difference. Its connected components are pockets. Each is bounded by
// walls, which are patches of the small probe's surface, and by one mouth, a connected part of the
// large one's saddles and concave patches (proof in the source). So there are as many pockets as
// such parts; most molecules have one that goes around them, and some small ones.
//
// The cavities of the small probe's complete surface are no part of the shell: their volume is that
// of its exterior less that of its complete solid. Sheets that touch without overlap stay apart.
#pragma once

#include <string>
#include <vector>

#include "excluded/excluded_measures.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// A connected component of the shell.
struct ShellPocket {
  double volume = 0;             // Å³
  double area = 0;               // Å² of its walls
  double mouth_area = 0;         // Å²
  std::uint64_t mouths = 0;      // found; any other number than 1 is a doubt
  std::uint64_t islands = 0;     // parts of S(small) in the pocket that touch nothing else
  std::vector<SphereId> lining;  // atoms with a part of their sphere in the walls, ascending
};

struct TwoProbeShell {
  ExcludedMeasures small, large;  // with the exterior surfaces
  // By falling volume. Empty if `doubt` is not.
  std::vector<ShellPocket> pockets;
  std::string doubt;  // why the shell could not be divided, in one line; empty if it was
  // The largest |∫ n dA| / area over the closed boundaries of pockets; rounding if all is well.
  double closure = 0;

  double volume() const { return large.exterior->volume - small.exterior->volume; }  // Å³
};

// The probes are radii in Å, the large one above the small one. Volumes of pockets sum to volume().
// Throws as excluded_measures() does, and InvalidInput unless the large probe is the larger.
// Results do not depend on the number of threads.
TwoProbeShell two_probe_shell(const SphereSet& atoms, double small_probe, double large_probe,
                              Monitor* monitor = nullptr);

}  // namespace vdwmesh
