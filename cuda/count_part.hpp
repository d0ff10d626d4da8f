// The part of a surface that one process makes from some spheres of a set.
#pragma once

#include <memory>
#include <span>

#include "cuda/backend.hpp"

namespace vdwmesh {

// Extractor::count() of make_extractor(backend), for spheres that have the ids `ids` in a whole
// set: these are what the labels of vertices say. There is one for each sphere, and they must rise
// with the spheres, which is not checked. If there are none, labels are indices, as of count().
std::unique_ptr<SurfacePart> count_part(Backend backend, const SphereSet& spheres,
                                        std::span<const SphereId> ids, const KeyRange& range,
                                        const ExtractOptions& options);

// The same on a device, as the CUDA sources offer it to backend.cpp.
std::unique_ptr<SurfacePart> count_part_on_cuda(const SphereSet& spheres,
                                                std::span<const SphereId> ids,
                                                const KeyRange& range,
                                                const ExtractOptions& options);

}  // namespace vdwmesh
