// The mesh of `vdwmesh report`, and of each structure of `vdwmesh batch --verb report`.
#pragma once

#include <functional>
#include <optional>

#include "command_line/command_line.hpp"
#include "memory_plan.hpp"
#include "spheres/sphere_set.hpp"
#include "steps/beside.hpp"
#include "steps/session.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::apps {

// What such a mesh, its measures and its comparison take. Normals are made only where a picture
// needs them.
MemoryDemand memory_of_report(const Options& options);

// Work that may be done at the same time as a mesh is made and measured. It is where a device makes
// the mesh and memory suffices: while the device makes the mesh, the CPU is free for
// `while_made`; while the CPU measures the mesh, the device is free for `while_measured`.
// Otherwise neither is called.
struct Companions {
  std::optional<StageWork> while_made;
  std::function<StageWork(const IndexedMesh&)> while_measured;  // may be empty
};

// Makes the mesh that the options ask for, and measures it: size, topology and quality, level by
// level, self-intersections, CGAL's measures. All this goes into the session's report. Memory is
// checked before the mesh is made, from an estimate, and again when its size is known. Throws as
// make_mesh() does, and LimitExceeded.
IndexedMesh make_measured_mesh(const SphereSet& spheres, const Options& options, Session& session,
                               const Companions& companions = {});

}  // namespace vdwmesh::apps
