// The cell list in which the extractors and the projection onto the field search for spheres: it
// finds every sphere whose contribution to the field reaches a box (field_reach()).
#pragma once

#include "core/buffer.hpp"
#include "extract/field.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

class Workspace;

// The reach of each sphere, Å: field_reach().
Buffer<double> field_reaches(const SphereSet& spheres, const FieldModel& model);

// A new list, owned by the caller. If `frame` is null, the list makes its own cells; else the
// function throws InvalidInput if a sphere does not fit the frame.
CellList make_field_list(const SphereSet& spheres, const FieldModel& model,
                         const CellListFrame* frame = nullptr);

// The list that the workspace keeps; it is built if the workspace has none for these spheres, this
// field and this frame. The view is valid until the workspace has been asked for two other lists.
// `frame`: as for make_field_list().
CellListView field_list(const SphereSet& spheres, const FieldModel& model,
                        const CellListFrame* frame, Workspace& workspace);

}  // namespace vdwmesh
