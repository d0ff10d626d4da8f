// Puts the page of a structure together.
#include "assets.hpp"
#include "page/packed_mesh.hpp"
#include "page/page_parts.hpp"
#include "view/view.hpp"

namespace vdwmesh::apps {

std::string view_html(const StructureView& view) {
  const DisplayMesh& shown = view.display;
  std::string bytes;
  const Box box = append_mesh(shown.mesh, bytes);
  append_planes(shown.atoms, bytes);
  for (const PatchKind kind : shown.kinds) bytes += static_cast<char>(kind);  // by view_surface.js
  const std::string& name = view.report.input.path;
  return fill_template(
      "view.html",
      {{"{{title}}", escape_html(name + ": surface, pockets and interfaces")},
       {"{{style}}", std::string(asset("view.css"))},
       {"{{data}}",
        data_block("structure", view_json(view, name, box)) + data_block("mesh", bytes)},
       {"{{libraries}}", three_script()},
       {"{{scripts}}", scripts_of({"data.js", "text.js", "viewer.js", "view_surface.js",
                                   "view_lists.js", "view_plot.js", "view_main.js"})}});
}

}  // namespace vdwmesh::apps
