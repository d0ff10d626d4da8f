// The vertices around which all patches of a level are a star (surface/patch_star.hpp): no two
// triangles of these patches cross.
#pragma once

#include "refine/level_view.hpp"
#include "surface/star_fans.hpp"

namespace vdwmesh {

StarFans patch_fans(const Midpoints& level);
StarFans patch_fans(const DividedMidpoints& level);

}  // namespace vdwmesh
