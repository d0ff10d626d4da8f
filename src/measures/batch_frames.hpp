// The frames of measure_frames() as the sets of one batch. For the library's own use.
#pragma once

#include <cstddef>
#include <vector>

#include "measures/frame_measures.hpp"
#include "measures/union_measurer.hpp"

namespace vdwmesh {

// Throws InvalidInput if `measures` asks for more than areas and volumes by arcs, which is all that
// a batch gives.
void require_arcs(const UnionOptions& measures);

// The error that says what is wrong with a ball of a frame. Precondition: is_sphere() is false for
// the ball.
InvalidFrame invalid_ball(const Sphere& ball, std::size_t frame, std::size_t atom);

// SphereBatch::offsets of so many frames, which stand one after another.
std::vector<std::size_t> frame_offsets(std::size_t frames, std::size_t atoms);

// Replaces `result` by the measures of each frame, which are in the batch. They are kept for the
// atoms that options.measures.measured names. result[0] has the fallback_spheres of all frames.
void split_batch(std::vector<ExactUnion>& result, const BatchMeasures& batch, std::size_t atoms,
                 const FrameOptions& options);

}  // namespace vdwmesh
