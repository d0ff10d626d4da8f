// The structures built into the library. Inside the room only.
#pragma once

#include <string_view>

namespace vdwmesh {

// PDB text of "ubiquitin" or "bpti"; empty for any other name.
std::string_view sample_text(std::string_view name);

}  // namespace vdwmesh
