// The shares of atoms in concave patches: a point belongs to the atom whose point of contact with
// the probe is nearest.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "excluded/patches/concave_patch.hpp"
#include "excluded/probes/accessible_surface.hpp"

namespace vdwmesh::excluded {

// What an atom has of one patch of the unit sphere around a probe.
struct AtomShare {
  std::uint32_t ball;  // of the triangulation
  double solid_angle;
  double cones;  // volume between the probe's centre and its part of the patch
};

// One entry for each atom that the probe touches. The solid angles sum to that of the patch.
std::vector<AtomShare> atom_shares(const AccessibleSurface& surface, const ConcavePatch& patch);

}  // namespace vdwmesh::excluded
