// What excluded_measures() makes on its way to the exterior surface, for callers that go on with
// it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "excluded/excluded_measures.hpp"
#include "excluded/patches/patch_records.hpp"
#include "excluded/probes/grown_atoms.hpp"

namespace vdwmesh::excluded {

struct KeptSurface {
  std::unique_ptr<const GrownAtoms> grown;
  std::vector<std::uint8_t> outer;  // by component of the accessible surface: is it of the exterior
  std::unique_ptr<const PatchRecords> records;  // of the exterior surface
};

// As excluded_measures(), with the exterior surface, whose parts it leaves in `kept`.
ExcludedMeasures measure_and_keep(const SphereSet& atoms, const ExcludedOptions& options,
                                  KeptSurface& kept);

}  // namespace vdwmesh::excluded
