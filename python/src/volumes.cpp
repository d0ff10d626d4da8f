// Marching cubes over a volume of Python, with scikit-image's call.
//
// The last axis of the volume is the one whose values lie side by side, as x is in a SampledField.
// So axes 2, 1, 0 of the volume are x, y, z of the library, and its values need no transposition:
// float32 is read where it lies.
// The mesh is made in cells of side 1; its vertices then go back to the caller's axes, with the
// caller's spacing and origin. Exchanging two axes is a reflection, so triangles are turned.
#include <pybind11/stl.h>

#include <array>
#include <cmath>
#include <cstring>

#include "arrays.hpp"
#include "call.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/large_pages.hpp"
#include "cuda/backend.hpp"
#include "mesh_handle.hpp"
#include "request/memory_limit.hpp"
#include "requests.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

using Triple = std::array<double, 3>;

// The place of the volume's nodes: node (i, j, k) lies at origin + spacing * (i, j, k).
struct GridFrame {
  Triple spacing, origin;
};

// Calls body(i) for every i in [0, count) on all cores, until the monitor asks to stop.
template <class Body>
void for_each_element(std::size_t count, Monitor& monitor, const Body& body) {
  constexpr std::size_t kPerBlock = std::size_t{1} << 18;
  const auto visit = [&](std::size_t, std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) body(i);
  };
  for_each_block(count, kPerBlock, visit, &monitor);
}

// Doubles, which need not be aligned.
void convert(const std::byte* from, Buffer<float>& values, Monitor& monitor) {
  for_each_element(values.size(), monitor, [&](std::size_t i) {
    double value;
    std::memcpy(&value, from + i * sizeof value, sizeof value);
    values[i] = static_cast<float>(value);
  });
}

// The values of the volume in float32: where they lie, or converted into `values`. The Python layer
// hands over volumes without gaps, with at least two nodes along each axis.
const float* values_of(const Numbers& volume, Buffer<float>& values, Monitor& monitor) {
  const auto address = reinterpret_cast<std::uintptr_t>(volume.bytes());
  if (volume.is_float32() && address % alignof(float) == 0)
    return reinterpret_cast<const float*>(volume.bytes());
  resize_untouched(values, volume.size(0) * volume.size(1) * volume.size(2));
  if (volume.is_float32()) {
    std::memcpy(values.data(), volume.bytes(), values.size() * sizeof(float));
  } else {
    convert(volume.bytes(), values, monitor);
  }
  return values.data();
}

GridSpec grid_of(const Numbers& volume) {
  const auto cells = [&](std::size_t axis) {
    return static_cast<std::int64_t>(volume.size(axis)) - 1;
  };
  return {{0, 0, 0}, 1, {cells(2), cells(1), cells(0)}};
}

// Throws unless doubles tell the nodes apart and reach them all.
void check(const GridFrame& frame, const Vec3i& cells) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);  // of the caller; `cells` has them reversed
    vdwmesh::check({{frame.origin[k], 0, 0}, frame.spacing[k], {cells[2 - axis], 0, 0}});
  }
}

// Normals are gradients, which scale with the inverse of lengths.
Vec3f turned(const Vec3f& n, const Triple& spacing) {
  const Vec3d g{static_cast<double>(n.z) / spacing[0], static_cast<double>(n.y) / spacing[1],
                static_cast<double>(n.x) / spacing[2]};
  const double length = norm(g);
  return length > 0 ? cast<float>((1 / length) * g) : Vec3f{0, 0, 0};
}

void place(IndexedMesh& mesh, const GridFrame& frame, Monitor& monitor) {
  const auto& [s, o] = frame;
  for_each_element(mesh.vertex_count(), monitor, [&](std::size_t v) {
    const Vec3d p = mesh.positions[v];
    mesh.positions[v] = {o[0] + s[0] * p.z, o[1] + s[1] * p.y, o[2] + s[2] * p.x};
    mesh.normals[v] = turned(mesh.normals[v], s);
  });
  for_each_index(mesh.triangle_count(),
                 [&](std::size_t t) { std::swap(mesh.triangles[t][1], mesh.triangles[t][2]); });
}

MeshHandle marching_cubes(const py::buffer& array, double level, const Triple& spacing,
                          const Triple& origin, std::optional<int> threads,
                          const std::string& device) {
  const Numbers volume(array, "volume", 3);
  const Backend backend = backend_of(device);
  return handle_of(call(threads, [&](Monitor& monitor) {
    ExtractOptions options;
    options.monitor = &monitor;
    options.memory_limit = default_memory_limit();
    check({spacing, origin}, grid_of(volume).cells);
    Buffer<float> converted;
    const SampledFieldView field{grid_of(volume), values_of(volume, converted, monitor),
                                 static_cast<float>(level)};
    IndexedMesh mesh = std::move(make_field_mesher(backend)->mesh(field, options).mesh);
    place(mesh, {spacing, origin}, monitor);
    return mesh;
  }));
}

}  // namespace

void bind_volumes(py::module_& module) { module.def("marching_cubes", &marching_cubes); }

}  // namespace vdwmesh::python
