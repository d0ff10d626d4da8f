#include <mutex>

#include "cuda/device_memory.cuh"

namespace vdwmesh {
namespace {

// Never destroyed: at the end of the process the driver may be gone before it.
struct FreePlaces {
  std::mutex mutex;
  std::vector<std::unique_ptr<PageLocked>> places;
};
FreePlaces& free_places() {
  static auto* const all = new FreePlaces;
  return *all;
}

}  // namespace

FetchPlace::Place FetchPlace::take() {
  FreePlaces& all = free_places();
  const std::lock_guard lock(all.mutex);
  if (all.places.empty()) return std::make_unique<PageLocked>(kFetchBytes);
  Place place = std::move(all.places.back());
  all.places.pop_back();
  return place;
}

void FetchPlace::give_back(Place place) {
  FreePlaces& all = free_places();
  const std::lock_guard lock(all.mutex);
  all.places.push_back(std::move(place));
}

}  // namespace vdwmesh
