// The results of a batch from the rows of its balls. For backends of ExcludedMeasurer.
#pragma once

#include <vector>

#include "excluded/elements/element_pipeline.hpp"
#include "excluded/excluded_measurer.hpp"

namespace vdwmesh::excluded::elements {

// Throws InvalidInput unless the probe is above 0 and finite.
void check_probe(double probe);

// Where the rows of the batch go: the same memory as the shares of its atoms.
BallRow* rows_of(ExcludedBatch& result, const SphereBatch& atoms);
std::vector<std::size_t> offsets_of(const SphereBatch& atoms);

// Sums the chunks of the sets. A set that has failed, or whose sums do not prove themselves, is
// measured by excluded_measures(). `atoms` are in memory of the host; `grown` has the totals of the
// grown balls. Precondition: the rows are in their place.
void sum_sets(ExcludedBatch& result, const SphereBatch& atoms, double probe,
              const ElementSums& sums, const std::vector<SphereMeasures>& grown, Monitor* monitor);

// Measures one set by excluded_measures() into its places of `result`.
void measure_set(ExcludedBatch& result, const SphereBatch& atoms, std::size_t set, double probe,
                 Monitor* monitor);

}  // namespace vdwmesh::excluded::elements
