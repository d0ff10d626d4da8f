// Extraction to the host, in as many slabs and on as many devices as it takes.
#pragma once

#include "cuda/memory/device_structures.cuh"

namespace vdwmesh {

// The mesh and the stats of an extraction, whatever options.device_memory and options.devices.
// Every device searches and counts all bricks, so that it knows every number; it emits the bricks
// of its share, slab by slab, straight to their places in the host's arrays. Throws
// DeviceMemoryExceeded, saying what is needed and what there is, where not even a slab of one brick
// fits.
ExtractResult extract_to_host(const SphereSet& spheres, const ExtractOptions& options);

}  // namespace vdwmesh
