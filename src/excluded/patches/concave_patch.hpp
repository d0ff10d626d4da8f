// The concave patches of probes: the unit sphere of each less caps, as cut_patch.hpp describes it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "excluded/patches/cut_patch.hpp"
#include "excluded/probes/accessible_surface.hpp"
#include "excluded/probes/low_probes.hpp"

namespace vdwmesh::excluded {

// The different radii of the probes, which follow from their numbers, made a decision with a margin
// below this. A surface with other numbers, as of some of the atoms, may decide otherwise.
inline constexpr double kBrokenTie = 1e-45;

// A connected piece of the patch.
struct PatchPiece {
  double solid_angle;
  Vec3d vector;  // ∫ w dω
  std::uint32_t loops;
};

struct ConcavePatch : CutPatch<HeapLists> {
  std::uint32_t probe;
  std::vector<PatchPiece> pieces;
  bool extended = false;  // decided by wide numbers
  bool tie = false;       // a decision was a tie even so
  double margin = 1;      // of the closest decision
  bool certified = true;  // the boundary closes
};

// The directed sides of a probe's polygon, in no particular order, without `gap`.
std::vector<PatchSide> patch_sides(const AccessibleSurface& surface, const Probe& probe);

// ∫ w dω over the uncut patch.
Vec3d polygon_vector(const std::vector<PatchSide>& sides);

// The patch of a probe that no other one cuts.
ConcavePatch whole_patch(const AccessibleSurface& surface, std::uint32_t probe);

// The patch of a low probe. `included` says of which components of the accessible surface the
// probes are.
ConcavePatch concave_patch(const AccessibleSurface& surface, const LowProbes& low,
                           std::span<const std::uint8_t> included, std::uint32_t probe);

// The patches of all low probes of these components, by probe, ascending; made on all cores.
std::vector<ConcavePatch> cut_patches(const AccessibleSurface& surface,
                                      std::span<const std::uint8_t> included, Monitor* monitor);

}  // namespace vdwmesh::excluded
