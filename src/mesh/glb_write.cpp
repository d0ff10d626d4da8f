// glTF 2.0 in one binary file: float32 positions about the middle of the box, which the node's
// translation, printed as double, puts back.
#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <ostream>
#include <streambuf>

#include "core/errors.hpp"
#include "mesh/chunk_writer.hpp"
#include "mesh/float_loss.hpp"
#include "mesh/formats.hpp"

namespace vdwmesh::formats {
namespace {

// Lets tinygltf's stream write into a sink.
class SinkBuffer : public std::streambuf {
 public:
  explicit SinkBuffer(ByteSink& sink) : sink_(sink) {}

 private:
  std::streamsize xsputn(const char* data, std::streamsize size) override {
    sink_.write(data, static_cast<std::size_t>(size));
    return size;
  }
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    const char character = traits_type::to_char_type(c);
    sink_.write(&character, 1);
    return c;
  }
  ByteSink& sink_;
};

struct Box3 {
  Vec3d lower, upper;
};

Box3 box_of(const SurfaceMesh& mesh) {
  if (mesh.n_vertices() == 0) return {{0, 0, 0}, {0, 0, 0}};
  constexpr double kHuge = std::numeric_limits<double>::max();
  Box3 box{{kHuge, kHuge, kHuge}, {-kHuge, -kHuge, -kHuge}};
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
    for (int axis = 0; axis < 3; ++axis) {
      const double x = mesh.point(vertex_handle(v))[static_cast<unsigned>(axis)];
      box.lower[axis] = std::min(box.lower[axis], x);
      box.upper[axis] = std::max(box.upper[axis], x);
    }
  return box;
}

class GlbBuilder {
 public:
  explicit GlbBuilder(const SurfaceMesh& mesh) : mesh_(mesh) {}

  tinygltf::Model build(Warnings& warnings) {
    check_size();
    const Box3 box = box_of(mesh_);
    const Vec3d origin = box.lower + 0.5 * (box.upper - box.lower);
    model_.buffers.resize(1);
    model_.asset.version = "2.0";
    model_.asset.generator = "vdwmesh; lengths in angstrom";
    model_.defaultScene = 0;
    model_.scenes.resize(1);
    model_.scenes[0].nodes = {0};
    model_.nodes.resize(1);
    model_.nodes[0].translation = {origin.x, origin.y, origin.z};
    if (mesh_.n_faces() > 0) {
      add_mesh(origin, warnings);
      model_.nodes[0].mesh = 0;
    } else {
      model_.buffers.clear();  // glTF has no empty buffers
    }
    return std::move(model_);
  }

 private:
  void check_size() const {
    const std::uint64_t bytes = 28 * std::uint64_t{mesh_.n_vertices()} +
                                12 * std::uint64_t{mesh_.n_faces()} + 4096;  // and the JSON
    if (bytes > std::numeric_limits<std::uint32_t>::max())
      throw LimitExceeded(fmt::format(
          "a GLB file of {} bytes is more than its 32 bits can count; PLY holds any mesh", bytes));
  }

  void add_mesh(const Vec3d& origin, Warnings& warnings) {
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.attributes["POSITION"] = add_positions(origin, warnings);
    primitive.attributes["NORMAL"] =
        add_vectors(mesh_.n_vertices(), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3,
                    [&](std::size_t v) { return mesh_.normal(vertex_handle(v)); });
    primitive.attributes["COLOR_0"] =
        add_vectors(mesh_.n_vertices(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_TYPE_VEC4,
                    [&](std::size_t v) {
                      const auto& c = mesh_.color(vertex_handle(v));
                      return std::array<unsigned char, 4>{c[0], c[1], c[2], 255};
                    });
    model_.accessors.back().normalized = true;
    primitive.indices = add_indices();
    model_.meshes.resize(1);
    model_.meshes[0].primitives.push_back(std::move(primitive));
  }

  int add_positions(const Vec3d& origin, Warnings& warnings) {
    FloatLoss loss;
    constexpr float kHuge = std::numeric_limits<float>::max();
    Vec3f lower{kHuge, kHuge, kHuge}, upper{-kHuge, -kHuge, -kHuge};
    const int accessor = add_vectors(mesh_.n_vertices(), TINYGLTF_COMPONENT_TYPE_FLOAT,
                                     TINYGLTF_TYPE_VEC3, [&](std::size_t v) {
                                       const auto& p = mesh_.point(vertex_handle(v));
                                       const Vec3f q = loss.round(Vec3d{p[0], p[1], p[2]} - origin);
                                       for (int axis = 0; axis < 3; ++axis) {
                                         lower[axis] = std::min(lower[axis], q[axis]);
                                         upper[axis] = std::max(upper[axis], q[axis]);
                                       }
                                       return q;
                                     });
    loss.finish("GLB", warnings);
    model_.accessors.back().minValues = {lower.x, lower.y, lower.z};
    model_.accessors.back().maxValues = {upper.x, upper.y, upper.z};
    return accessor;
  }

  int add_indices() {
    const int accessor =
        add_vectors(mesh_.n_faces(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                    [&](std::size_t f) { return face_vertices(mesh_, f); });
    model_.accessors.back().count *= 3;
    model_.bufferViews.back().target = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
    return accessor;
  }

  // One array with its view and accessor; value(i) is stored as it lies in memory.
  template <class Value>
  int add_vectors(std::size_t count, int component, int type, Value&& value) {
    auto& data = model_.buffers[0].data;
    constexpr std::size_t kSize = sizeof(value(0));
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = count * kSize;
    view.target = TINYGLTF_TARGET_ARRAY_BUFFER;
    data.resize(data.size() + view.byteLength);
    for (std::size_t i = 0; i < count; ++i) {
      const auto item = value(i);
      std::memcpy(data.data() + view.byteOffset + i * kSize, &item, kSize);
    }
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model_.bufferViews.size());
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = count;
    model_.bufferViews.push_back(std::move(view));
    model_.accessors.push_back(std::move(accessor));
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  const SurfaceMesh& mesh_;
  tinygltf::Model model_;
};

}  // namespace

void write_glb(const SurfaceMesh& mesh, ByteSink& sink, Warnings& warnings) {
  const tinygltf::Model model = GlbBuilder(mesh).build(warnings);
  SinkBuffer buffer(sink);
  std::ostream stream(&buffer);
  stream.exceptions(std::ios::badbit);  // so that the sink's own exception comes through
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, true))
    throw FileFormatError("the GLB writer gave up");
}

}  // namespace vdwmesh::formats
