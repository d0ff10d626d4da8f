// Cell lists for a field: the reach of each sphere is its field_reach(), and CellList, make_frame()
// and the workspace's KeptCellLists do the rest.
#include "extract/field_list.hpp"

#include "core/fixed_blocks.hpp"
#include "core/workspace.hpp"
#include "extract/blended/field_formulas.hpp"
#include "spheres/kept_cell_lists.hpp"

namespace vdwmesh {

Buffer<double> field_reaches(const SphereSet& spheres, const FieldModel& model) {
  Buffer<double> reach(spheres.size());
  for_each_index(reach.size(),
                 [&](std::size_t i) { reach[i] = field_reach(model, spheres[i].radius); });
  return reach;
}

CellList make_field_list(const SphereSet& spheres, const FieldModel& model,
                         const CellListFrame* frame) {
  const Buffer<double> reaches = field_reaches(spheres, model);
  return frame != nullptr ? CellList(spheres, reaches, *frame) : CellList(spheres, reaches);
}

CellListFrame make_field_frame(const SphereSet& spheres, const FieldModel& model) {
  return make_frame(spheres, field_reaches(spheres, model));
}

CellListView field_list(const SphereSet& spheres, const FieldModel& model,
                        const CellListFrame* frame, Workspace& workspace) {
  return workspace.get<KeptCellLists>().get(spheres, field_reaches(spheres, model), frame);
}

}  // namespace vdwmesh
