// The meshes that the page of a study shows.
#pragma once

#include <string>
#include <vector>

#include "study/study.hpp"

namespace vdwmesh::apps {

// One mesh, quantised: positions to 16 bits of its box, distances and angles to 8 bits.
struct StudyScene {
  std::size_t input;
  StudySetting setting;
  std::string description;  // JSON: counts, box, ranges, colours, to read the bytes with
  std::string bytes;
};

// One mesh per molecule and way of making it, each the finest run of at most 200,000 triangles (or
// the coarsest of all), first ways first, as long as the study's page_triangles hold them.
//
// A mesh that is now beyond a limit, though it was not when its run was made, is left out, and
// `warnings` say so.
std::vector<StudyScene> make_scenes(const Study& study, std::vector<std::string>& warnings);

}  // namespace vdwmesh::apps
