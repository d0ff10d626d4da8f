// The part of a surface that the CPU makes from some spheres of a set (cuda/count_part.hpp chooses
// between it and a device). It counts the bricks around its range as well; a part that gets them
// from others is in part_without_halo.hpp.
#pragma once

#include <memory>
#include <span>

#include "extract/extractor.hpp"

namespace vdwmesh {

// Extractor::count() of make_cpu_extractor(), for spheres that have the ids `ids` in a whole set:
// these are what the labels of vertices say. There is one for each sphere, and they must rise with
// the spheres, which is not checked. If there are none, labels are indices, as of count().
std::unique_ptr<SurfacePart> count_part_on_cpu(const SphereSet& spheres,
                                               std::span<const SphereId> ids, const KeyRange& range,
                                               const ExtractOptions& options);

}  // namespace vdwmesh
