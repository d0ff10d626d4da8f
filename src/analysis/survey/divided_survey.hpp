// The survey of the edges of a divided mesh, by that of the mesh that was divided.
#pragma once

#include <optional>

#include "analysis/distances/distribution.hpp"
#include "analysis/survey/edge_survey.hpp"

namespace vdwmesh {

// Returns what survey_edges() finds, if the mesh is a closed, oriented manifold of which each
// triangle was divided into four, as refine/subdivision_formulas.hpp does. Nothing if it is not, or
// if that could not be shown. `edge_lengths` only gets lengths if there is a result.
std::optional<EdgeSurvey> survey_divided(const IndexedMesh& mesh, BracketedValues* edge_lengths);

}  // namespace vdwmesh
