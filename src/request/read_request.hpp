// What is asked of the reading of a structure, checked before the file is opened.
#pragma once

#include <string>
#include <vector>

#include "request/refuse.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {

// Throws InvalidInput for a model that is no number, first or all. Sets of radii get the case in
// which RadiusTable knows them. Returns the parts of `radii` that are files.
std::vector<std::string> settle(ReadOptions& options, Door door);

}  // namespace vdwmesh
