// Checks of the offsets of a batch.
#include "spheres/sphere_batch.hpp"

#include <fmt/format.h>

#include "core/errors.hpp"

namespace vdwmesh {

SphereBatch batch_of(const SphereSet& spheres) {
  return {.spheres = spheres.spheres().data(), .size = spheres.size()};
}

void check_sets(const SphereBatch& batch) {
  if (batch.size >= kNoSphere) {
    throw InvalidInput(fmt::format("{} spheres; at most {} fit", batch.size, kNoSphere - 1));
  }
  if (batch.set_count() == 0 || batch.set_begin(0) != 0 ||
      batch.set_end(batch.set_count() - 1) != batch.size) {
    throw InvalidInput(fmt::format(
        "the offsets of a batch must begin with 0 and end with its {} spheres", batch.size));
  }
  for (std::size_t set = 0; set < batch.set_count(); ++set) {
    if (batch.set_begin(set) > batch.set_end(set)) {
      throw InvalidInput(fmt::format("offset {} of a batch is below the one before", set + 1));
    }
    if (batch.set_begin(set) == batch.set_end(set)) {
      throw InvalidInput(
          fmt::format("set {} of the batch has no spheres: its union is not defined", set));
    }
  }
}

}  // namespace vdwmesh
