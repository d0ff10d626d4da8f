// The frames of measure_frames() as the sets of one batch. For the library's own use.
#pragma once

#include <cstddef>
#include <vector>

#include "arrangement/frame_measures.hpp"
#include "arrangement/union_measurer.hpp"

namespace vdwmesh {

// Throws InvalidInput if a batch does not give what is asked for: it gives areas and volumes by
// arcs.
void require_arcs(const UnionOptions& measures);

// What is wrong with a ball of a frame that no SphereSet accepts. Precondition: none does.
InvalidFrame invalid_ball(const Sphere& ball, std::size_t frame, std::size_t atom);

// SphereBatch::offsets of so many frames, which stand one after another.
std::vector<std::size_t> frame_offsets(std::size_t frames, std::size_t atoms);

// Replaces `result` by the measures of each frame of the batch. Of each, the atoms that
// options.measures.measured names are measured. result[0] has the fallback_spheres of all.
void split_batch(std::vector<ExactUnion>& result, const BatchMeasures& batch, std::size_t atoms,
                 const FrameOptions& options);

}  // namespace vdwmesh
