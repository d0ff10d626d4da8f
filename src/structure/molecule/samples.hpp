// The sample structures that are built into the library. The build generates the source from data/
// (EmbedSamples.cmake). Internal header of this folder.
#pragma once

#include <string_view>

namespace vdwmesh {

// PDB text of "ubiquitin" or "bpti"; empty for any other name.
std::string_view sample_text(std::string_view name);

}  // namespace vdwmesh
