// The cell list that the extractors and the field's projection search: it finds every sphere whose
// part of the field reaches a box.
#pragma once

#include "core/workspace.hpp"
#include "extract/field.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// A list of the caller's own.
CellList make_field_list(const SphereSet& spheres, const FieldModel& model);

// The list that the workspace keeps, built if it has none for these spheres and this field. Valid
// until the workspace was asked for two other lists. `frame` may be null. Throws InvalidInput for
// spheres beyond the frame.
CellListView field_list(const SphereSet& spheres, const FieldModel& model,
                        const CellListFrame* frame, Workspace& workspace);

}  // namespace vdwmesh
