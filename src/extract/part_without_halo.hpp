// A part of a surface on the CPU that counts its own bricks alone. Those behind its range, to which
// its triangles refer, belong to other parts, which have counted them already.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "extract/bricks/brick_numbering.hpp"
#include "extract/extractor.hpp"

namespace vdwmesh {

class PartWithoutHalo : public SurfacePart {
 public:
  // The bricks with surface in the range and in `wanted`, for a part of which they are the halo.
  // They are valid until set_halo() is called.
  virtual std::span<const ActiveBrick> counted(const KeyRange& wanted) const = 0;

  // Takes the bricks behind the range that are in its halo (with_halo()), by rising key, in parts
  // that stand one behind the other. Must be called before halo() and emit().
  virtual void set_halo(std::span<const std::vector<ActiveBrick>> parts) = 0;
};

// Extractor::count() on the CPU without the halo: `spheres` may lack those that are near the halo
// only. `ids` are what labels call the spheres, their ids in a whole set; they must rise. There are
// no half-edges, whatever the options say. Throws as that function does.
std::unique_ptr<PartWithoutHalo> count_without_halo(const SphereSet& spheres,
                                                    std::span<const SphereId> ids,
                                                    const KeyRange& range,
                                                    const ExtractOptions& options);

}  // namespace vdwmesh
