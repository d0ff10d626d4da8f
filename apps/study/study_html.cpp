// Puts the page of a study together: a template with marks, in whose places come the title, the
// style, the libraries and scripts that the program carries, and the data, packed. The page needs
// nothing else, and no network.
#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <cstdint>
#include <stdexcept>

#include "assets.hpp"
#include "core/errors.hpp"
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

// The best compression: a page is made once and opened often.
std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  const int code = compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                             reinterpret_cast<const Bytef*>(bytes.data()),
                             static_cast<uLong>(bytes.size()), Z_BEST_COMPRESSION);
  if (code != Z_OK) throw std::runtime_error("zlib: cannot compress");
  out.resize(size);
  return out;
}

// RFC 4648. No character of it is special in HTML.
std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto byte = i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u;
      group = group << 8 | byte;
    }
    // n bytes of a group fill n + 1 digits; '=' takes the place of the others.
    for (std::size_t k = 0; k < 4; ++k) {
      const bool padding = i + k > bytes.size();
      text += padding ? '=' : kDigits[group >> (18 - 6 * k) & 63];
    }
  }
  return text;
}

// Compressed and then in base64: browsers have decoders of both, so the page needs none of its own.
std::string pack(std::string_view bytes) { return base64(deflated(bytes)); }

std::string escape_html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const std::size_t special = std::string_view("<>&\"").find(c);
    constexpr const char* kEscapes[] = {"&lt;", "&gt;", "&amp;", "&quot;"};
    out += special == std::string_view::npos ? std::string(1, c) : kEscapes[special];
  }
  return out;
}

// A script without the comment that would make browsers look for its source map.
std::string_view without_source_map(std::string_view script) {
  return script.substr(0, script.find("//# sourceMappingURL"));
}

// Throws if a script holds what an HTML parser takes for the end of a script or the beginning of a
// comment in it, because the page would break. No library holds it now, but a new version may.
void check_script(std::string_view script) {
  for (const char* mark : {"</script", "<!--"}) {
    if (script.find(mark) != std::string_view::npos) {
      throw Error(fmt::format("a script of the page holds {}", mark));
    }
  }
}

// Vega comes as packages that require one another, which the loader of modules.js resolves.
std::string libraries() {
  std::string script(asset("modules.js"));
  for (const char* name : kVegaPackages) {
    script +=
        fmt::format("vdwmeshModule(\"{}\", function (exports, require, module) {{\n{}\n}});\n",
                    name, without_source_map(asset(name)));
  }
  script += without_source_map(asset("three"));
  script += '\n';
  script += asset("three-orbit");
  check_script(script);
  return script;
}

std::string own_scripts() {
  std::string script;
  for (const char* name : {"data.js", "charts.js", "tables.js", "viewer.js", "main.js"}) {
    script += asset(name);
  }
  check_script(script);
  return script;
}

// Base64 has no character that HTML takes for anything else.
std::string data_block(const std::string& id, std::string_view bytes) {
  return fmt::format("<script type=\"application/octet-stream\" id=\"{}\">{}</script>\n", id,
                     pack(bytes));
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

// Marks are replaced in the order of the template, each once; that one is missing is a mistake of
// ours.
std::string study_html(const Study& study, std::vector<std::string>& warnings) {
  const std::pair<std::string_view, std::string> parts[] = {
      {"{{title}}", title(study)},
      {"{{style}}", std::string(asset("style.css"))},
      {"{{data}}", data_blocks(study, warnings)},
      {"{{libraries}}", libraries()},
      {"{{scripts}}", own_scripts()}};
  std::string page;
  std::string_view rest = asset("page.html");
  for (const auto& [mark, content] : parts) {
    const std::size_t at = rest.find(mark);
    if (at == std::string_view::npos) throw Error(fmt::format("page.html lacks {}", mark));
    page += rest.substr(0, at);
    page += content;
    rest.remove_prefix(at + mark.size());
  }
  page += rest;
  return page;
}

}  // namespace vdwmesh::apps
