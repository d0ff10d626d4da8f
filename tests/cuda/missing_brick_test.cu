// A list of bricks on the device that lacks one with surface: an error, as on the CPU.
#include <gtest/gtest.h>

#include <vector>

#include "core/errors.hpp"
#include "cuda/backend.hpp"
#include "cuda/extract/bricks/brick_mesher.cuh"
#include "extract/field_list.hpp"
#include "support/plain_extractor.hpp"
#include "support/requirements.hpp"

namespace vdwmesh {
namespace {

// Meshes the bricks with these keys, with or without half-edges.
std::uint64_t triangles_of(const SphereSet& spheres, const std::vector<std::uint64_t>& keys,
                           const ExtractOptions& options) {
  const GridSpec grid = make_grid(spheres, options.grid);
  const FieldModel model = make_field_model(options.field, grid);
  const CellList list = make_field_list(spheres, model);
  const Stream stream;
  const DeviceCellList device_list(list.view(), stream.get());
  const SphereSource source(device_list.view(), model, stream);
  KeyList candidates;
  candidates.keys = upload(keys.data(), keys.size(), stream.get());
  candidates.count = keys.size();
  DeviceBrickMesher mesher(source, options);
  mesher.count(std::move(candidates));
  return mesher.emit_on_device().triangle_count();
}

TEST(CudaMissingBrick, IsAnErrorWhereTheSurfaceReachesIt) {
  const DeviceList devices = cuda_devices();
  if (devices.devices.empty()) VDWMESH_MISSING("VDWMESH_REQUIRE_CUDA", devices.reason);
  const SphereSet ball({{{0, 0, 0}, 4}});
  for (const Connectivity connectivity : {Connectivity::triangles, Connectivity::half_edges}) {
    ExtractOptions options;
    options.connectivity = connectivity;
    const std::vector<std::uint64_t> all = testing::all_bricks(make_grid(ball, options.grid));
    const std::uint64_t whole = triangles_of(ball, all, options);
    EXPECT_EQ(whole, make_extractor(Backend::cpu)->extract(ball, options).mesh.triangle_count());
    std::size_t refused = 0;
    for (std::size_t left_out = 0; left_out < all.size(); ++left_out) {
      std::vector<std::uint64_t> some = all;
      some.erase(some.begin() + static_cast<std::ptrdiff_t>(left_out));
      try {
        // A brick without surface is not missed.
        EXPECT_EQ(triangles_of(ball, some, options), whole) << "brick " << left_out;
      } catch (const InternalError&) {
        ++refused;
      }
    }
    EXPECT_GE(refused, 8u);  // at least one for each octant of the sphere
    EXPECT_LT(refused, all.size());
  }
}

}  // namespace
}  // namespace vdwmesh
