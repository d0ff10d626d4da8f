// What self-contained pages are put together from: a template with marks, the scripts and libraries
// that the program carries, and packed data. Such a page needs nothing else, and no network.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vdwmesh::apps {

// Text as HTML shows it.
std::string escape_html(std::string_view text);

// A script without the comment that would make browsers look for its source map.
std::string_view without_source_map(std::string_view script);

// The named assets, one after the other.
std::string scripts_of(const std::vector<std::string_view>& names);
// The library three.js with the part that turns its camera.
std::string three_script();

// An element that holds the bytes packed, as the function unpack() of data.js reads them.
std::string data_block(const std::string& id, std::string_view bytes);

// The text that stands in the place of a mark such as "{{title}}".
using MarkedPart = std::pair<std::string_view, std::string>;

// The template with its marks replaced, in their order there, each once. Throws Error if a mark is
// missing, or if a part that is a script ("{{libraries}}", "{{scripts}}") holds what an HTML parser
// takes for its end or for the beginning of a comment.
std::string fill_template(std::string_view name, const std::vector<MarkedPart>& parts);

}  // namespace vdwmesh::apps
