// Puts the page of a study together.
#include <fmt/format.h>

#include <array>

#include "assets.hpp"
#include "page/page_parts.hpp"
#include "study/scene.hpp"
#include "study/study.hpp"

namespace vdwmesh::apps {
namespace {

// In the order in which they need one another.
constexpr std::array kVegaPackages = {
    "vega-util",       "vega-time",       "vega-format",         "vega-loader",
    "vega-dataflow",   "vega-statistics", "vega-scale",          "vega-canvas",
    "vega-scenegraph", "vega-expression", "vega-event-selector", "vega-selection",
    "vega-functions",  "vega-runtime",    "vega-transforms",     "vega-view-transforms",
    "vega-encode",     "vega-label",      "vega-parser",         "vega-view"};

// Vega comes as packages that require one another, which the loader of modules.js resolves.
std::string libraries() {
  std::string script(asset("modules.js"));
  for (const char* name : kVegaPackages) {
    script +=
        fmt::format("vdwmeshModule(\"{}\", function (exports, require, module) {{\n{}\n}});\n",
                    name, without_source_map(asset(name)));
  }
  return script + three_script();
}

std::string data_blocks(const Study& study, std::vector<std::string>& warnings) {
  std::string blocks = data_block("study", study_json(study, JsonText::Layout::compact));
  std::string descriptions;
  std::size_t number = 0;
  for (const StudyScene& scene : make_scenes(study, warnings)) {
    blocks += data_block(fmt::format("scene-{}", number++), scene.bytes);
    descriptions += (descriptions.empty() ? "" : ",") + scene.description;
  }
  return blocks + data_block("scenes", '[' + descriptions + ']');
}

std::string title(const Study& study) {
  std::string names;
  for (const StudyFindings& f : study.findings) {
    names += (names.empty() ? "" : ", ") + f.input.name;
  }
  return escape_html("vdwmesh study: " + names);
}

}  // namespace

std::string study_html(const Study& study, std::vector<std::string>& warnings) {
  return fill_template(
      "page.html",
      {{"{{title}}", title(study)},
       {"{{style}}", std::string(asset("style.css"))},
       {"{{data}}", data_blocks(study, warnings)},
       {"{{libraries}}", libraries()},
       {"{{scripts}}", scripts_of({"data.js", "text.js", "scene.js", "charts.js", "tables.js",
                                   "viewer.js", "mesh_view.js", "main.js"})}});
}

}  // namespace vdwmesh::apps
