// Random inputs for extractors, most of them unlike proteins.
#pragma once

#include <cstdint>
#include <string>

#include "extract/extractor.hpp"

namespace vdwmesh::testing {

struct ExtractSet {
  std::string name;  // what it is, for messages
  SphereSet spheres;
  ExtractOptions options;
  // Of balls so far apart that each makes a shell of its own, else 0.
  std::uint64_t separated = 0;
};

// Set `index` of a survey: the same on every machine, whichever other sets are made. 1 to 400 balls
// of 0.1 to 10 Å at spacings of 0.1 to 2 Å: gases, crowds, chains, lattices on the nodes, one huge
// ball among tiny ones, pairs far apart, balls apart from each other; fields, presets, isovalues,
// blobbiness, padding and border vary. Limited to sets of a few milliseconds on average.
ExtractSet extract_set(std::uint32_t seed, std::uint32_t index);

}  // namespace vdwmesh::testing
