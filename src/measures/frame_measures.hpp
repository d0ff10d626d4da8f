// Exact measures of the same balls at many places, as in the frames of a trajectory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "measures/exact_union.hpp"
#include "measures/union_measurer.hpp"

namespace vdwmesh {

enum class CoordinateType : std::uint8_t { float32, float64 };

// Coordinates of the same atoms in several frames, in memory of the caller, in the form in which a
// reader of trajectories left them. They need not be aligned, and may overlap.
struct FrameCoordinates {
  const std::byte* first = nullptr;  // x of the first atom in the first frame
  CoordinateType type = CoordinateType::float64;
  std::size_t frames = 0, atoms = 0;
  // Bytes from a coordinate to that of the next frame, of the next atom, and of the next axis.
  std::ptrdiff_t frame_stride = 0, atom_stride = 0, axis_stride = 0;
  double unit = 1;  // Å: what a coordinate of 1 stands for; 10 for coordinates in nm
};

enum class PerSphere : std::uint8_t { drop, keep };

struct FrameOptions {
  // Of each frame. Its workspace must be null.
  UnionOptions measures{.topology = TopologyRequest::none};
  PerSphere per_sphere = PerSphere::drop;  // whether the results have ExactUnion::per_sphere
  // If set, it measures frames in batches of so many balls, or of one frame, and the results differ
  // from those of the CPU as it says. It serves method automatic or arcs without topology and
  // certificate.
  const UnionMeasurer* measurer = nullptr;
  std::size_t balls_at_once = std::size_t{1} << 22;
};

// A frame that cannot be measured. The message is the reason alone, because the caller knows the
// frame by another number or name.
class InvalidFrame : public InvalidInput {
 public:
  InvalidFrame(std::size_t frame, std::optional<std::size_t> atom, std::string reason)
      : InvalidInput(std::move(reason)), frame_(frame), atom_(atom) {}
  std::size_t frame() const { return frame_; }               // from 0
  std::optional<std::size_t> atom() const { return atom_; }  // from 0, if one atom is the reason

 private:
  std::size_t frame_;
  std::optional<std::size_t> atom_;
};

// Measures the union of the balls with these radii (Å) in every frame: result[t] is, to the last
// digit, what exact_union() gives for frame t alone, whatever the number of threads and of frames.
// There is one difference: counts that the arcs leave open come from a triangulation. A measurer
// does not say which frames have fallback_spheres; result[0] has those of all.
//
// Frames are measured side by side, each by one thread as long as there are enough of them.
// Overwrites `result` and reuses its memory. Throws InvalidFrame for the first frame that has a
// coordinate that is no number or beyond kFarthestSphere, or measures that are not finite; `result`
// then holds the frames before it. Throws InvalidInput if there are no atoms, not one radius for
// each, if a SphereSet does not accept a radius, or if the measurer cannot do what is asked for;
// and Cancelled.
void measure_frames(std::vector<ExactUnion>& result, std::span<const double> radii,
                    const FrameCoordinates& frames, const FrameOptions& options = {});

}  // namespace vdwmesh
