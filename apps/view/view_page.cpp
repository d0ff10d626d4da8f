// Puts the page of a structure together.
#include <filesystem>

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
  for (const PatchKind kind : shown.kinds) bytes += static_cast<char>(kind);
  const std::string name = std::filesystem::path(view.report.input.path).filename().string();
  return fill_template(
      "view.html",
      {{"{{title}}", escape_html("vdwmesh view: " + name)},
       {"{{style}}", std::string(asset("view.css"))},
       {"{{data}}",
        data_block("structure", view_json(view, name, box)) + data_block("mesh", bytes)},
       {"{{libraries}}", three_script()},
       {"{{scripts}}", scripts_of({"data.js", "text.js", "viewer.js", "view_surface.js",
                                   "view_lists.js", "view_plot.js", "view_main.js"})}});
}

}  // namespace vdwmesh::apps
