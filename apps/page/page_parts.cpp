#include "page/page_parts.hpp"

#include <fmt/format.h>

#include "assets.hpp"
#include "core/errors.hpp"
#include "page/pack.hpp"

namespace vdwmesh::apps {
namespace {

// The page would break. No library holds such a mark now, but a new version may.
void check_script(std::string_view script) {
  for (const char* mark : {"</script", "<!--"}) {
    if (script.find(mark) != std::string_view::npos) {
      throw Error(fmt::format("a script of the page holds {}", mark));
    }
  }
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const std::size_t special = std::string_view("<>&\"").find(c);
    constexpr const char* kEscapes[] = {"&lt;", "&gt;", "&amp;", "&quot;"};
    out += special == std::string_view::npos ? std::string(1, c) : kEscapes[special];
  }
  return out;
}

std::string_view without_source_map(std::string_view script) {
  return script.substr(0, script.find("//# sourceMappingURL"));
}

std::string scripts_of(const std::vector<std::string_view>& names) {
  std::string script;
  for (const std::string_view name : names) script += asset(name);
  return script;
}

std::string three_script() {
  return fmt::format("{}\n{}", without_source_map(asset("three")), asset("three-orbit"));
}

// Base64 has no character that HTML takes for anything else.
std::string data_block(const std::string& id, std::string_view bytes) {
  return fmt::format("<script type=\"application/octet-stream\" id=\"{}\">{}</script>\n", id,
                     pack(bytes));
}

// A mark that is missing is a mistake of ours.
std::string fill_template(std::string_view name, const std::vector<MarkedPart>& parts) {
  std::string page;
  std::string_view rest = asset(name);
  for (const auto& [mark, content] : parts) {
    const std::size_t at = rest.find(mark);
    if (at == std::string_view::npos) throw Error(fmt::format("{} lacks {}", name, mark));
    if (mark == "{{libraries}}" || mark == "{{scripts}}") check_script(content);
    page += rest.substr(0, at);
    page += content;
    rest.remove_prefix(at + mark.size());
  }
  page += rest;
  return page;
}

}  // namespace vdwmesh::apps
