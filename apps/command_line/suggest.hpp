// Which of the names that there are somebody may have meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace vdwmesh::apps {

// "; did you mean NAME?" with the known name that is closest to `given`; empty where none is close.
// Close is one slip of the fingers, two in names of more than five letters: a letter that is wrong,
// missing, too many, or swapped with its neighbour.
std::string suggestion(std::string_view given, std::span<const std::string_view> known);

}  // namespace vdwmesh::apps
