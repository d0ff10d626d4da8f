// From spheres in memory to the half-edge mesh in memory, on each backend that is there: wall
// seconds, the median of five runs after one.
//
//   half_edges_bench SPACING XYZR...
//
// "Then built" begins the half-edge mesh when the mesh of triangles is there; "prepared" has room
// for it made while that one is on its way. Beside them the mesh of triangles alone, the build
// alone, and OpenMesh's own resize().
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "cuda/backend.hpp"
#include "mesh/surface_mesh_builder.hpp"
#include "read_xyzr.hpp"

namespace vdwmesh {
namespace {

constexpr int kRuns = 5;

// Of work(), not of giving back the memory of what it returns.
template <class Work>
double seconds_of(const Work& work) {
  std::vector<double> seconds;
  for (int i = 0; i <= kRuns; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const auto result = work();
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    if (i > 0) seconds.push_back(taken.count());
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[seconds.size() / 2];
}

class Comparison {
 public:
  Comparison(const SphereSet& spheres, double spacing, Backend backend)
      : spheres_(spheres), backend_(backend) {
    options_.grid.spacing = spacing;
    options_.connectivity = Connectivity::half_edges;
  }

  void print() {
    const IndexedMesh mesh = triangles();
    const double alone = seconds_of([&] { return triangles(); });
    const double build = seconds_of([&] { return to_surface_mesh(mesh); });
    const double resize = seconds_of([&] {
      auto surface = std::make_unique<SurfaceMesh>();
      surface->resize(mesh.vertex_count(), 3 * mesh.triangle_count() / 2, mesh.triangle_count());
      return surface;
    });
    const double then_built = seconds_of([&] { return build_after(Room::at_the_end); });
    const double prepared = seconds_of([&] { return build_after(Room::ahead); });
    fmt::print(
        "  {:4} {:>11} triangles: mesh {:.4f}, then built {:.4f}, prepared {:.4f}; build alone "
        "{:.4f}, resize {:.4f}\n",
        backend_ == Backend::cuda ? "cuda" : "cpu", mesh.triangle_count(), alone, then_built,
        prepared, build, resize);
  }

 private:
  IndexedMesh triangles() const {
    return make_pipeline(backend_)->run(spheres_, options_, {}).mesh;
  }

  struct Meshes {
    std::unique_ptr<SurfaceMesh> surface;
    IndexedMesh triangles;
  };
  enum class Room { at_the_end, ahead };

  Meshes build_after(Room room) {
    Meshes made{std::make_unique<SurfaceMesh>(), {}};
    SurfaceMeshBuilder builder(*made.surface);
    options_.on_size = [&](const MeshSize& size) {
      if (room == Room::ahead) builder.prepare(size);
    };
    made.triangles = triangles();
    builder.build(made.triangles);
    return made;
  }

  const SphereSet& spheres_;
  Backend backend_;
  ExtractOptions options_;
};

int run(const std::vector<std::string>& arguments) {
  const DeviceList list = cuda_devices();
  if (list.devices.empty()) fmt::print("no CUDA: {}\n", list.reason);
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const SphereSet spheres(read_xyzr(arguments[i]));
    fmt::print("{}: {} spheres, {} Å\n", arguments[i], spheres.size(), arguments[0]);
    for (const Backend backend : {Backend::cpu, Backend::cuda}) {
      if (backend == Backend::cuda && list.devices.empty()) continue;
      Comparison(spheres, std::stod(arguments[0]), backend).print();
    }
  }
  return 0;
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: half_edges_bench SPACING XYZR...\n");
    return 1;
  }
  try {
    return vdwmesh::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "half_edges_bench: {}\n", error.what());
    return 1;
  }
}
