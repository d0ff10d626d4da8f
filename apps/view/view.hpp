// The page of a structure: its surface in 3D, with pockets, interfaces, areas by residue and the
// exact figures beside it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "steps/interface_steps.hpp"
#include "steps/steps.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh::apps {

// A mesh to be looked at, not to be measured: each triangle has the colour of one atom.
struct DisplayMesh {
  IndexedMesh mesh;
  std::vector<SphereId> atoms;     // by triangle
  std::vector<PatchKind> kinds{};  // by triangle, of the excluded surface; else empty
};

// What the page shows. Pockets, interfaces and the figures of the surface are in the report, as the
// verbs that are about them fill it.
struct StructureView {
  const Molecule& molecule;
  const Report& report;
  double probe = 0;           // Å, of pockets and interfaces
  std::vector<double> areas;  // Å², exposed, by atom
  Sides chains;
  // By interface: the atoms that it buries, of both sides.
  std::vector<std::vector<SphereId>> buried_a, buried_b;
  DisplayMesh display;
};

// The surface of these options made coarse enough for a page that shows at most so many triangles,
// if the surface can be meshed by as few. The excluded surface must be in the session's report.
// Throws LimitExceeded and what the meshers throw.
DisplayMesh make_display_mesh(const Structure& structure, double probe, SurfaceOptions surface,
                              std::uint64_t most_triangles, Session& session);

// The data of the page but for the bytes of the mesh; `box` is theirs.
std::string view_json(const StructureView& view, const std::string& name, const Box& box);
std::string view_html(const StructureView& view);

}  // namespace vdwmesh::apps
