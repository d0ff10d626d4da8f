// Reader of GLB, the binary form of glTF 2.0. The library tinygltf parses the JSON and finds the
// binary chunk; this file checks its indices and sizes, walks through the tree of nodes and
// collects all triangles in one mesh. Every node has a transform relative to its parent, which is
// applied in double, so a translation such as write_glb() stores keeps the precision of the
// positions.
#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <ranges>

#include "core/errors.hpp"
#include "mesh/formats.hpp"
#include "mesh/mesh_assembly.hpp"

namespace vdwmesh::formats {
namespace {

[[noreturn]] void fail(const std::string& what) { throw FileFormatError("GLB: " + what); }

// An affine map x -> A x + t, in double.
struct Transform {
  std::array<Vec3d, 3> rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // of A
  Vec3d shift{0, 0, 0};                                          // t

  Vec3d apply_linear(const Vec3d& p) const {
    return {dot(rows[0], p), dot(rows[1], p), dot(rows[2], p)};
  }
  Vec3d apply(const Vec3d& p) const { return apply_linear(p) + shift; }
  Vec3d column(int k) const { return {rows[0][k], rows[1][k], rows[2][k]}; }
  double determinant() const { return dot(rows[0], cross(rows[1], rows[2])); }
  // The inverse transpose of A times the absolute value of A's determinant, which maps normals to
  // normals up to their length and keeps them on their side of the surface. The cross products are
  // the cofactors of A, that is, det(A) times the inverse transpose. They need no division, so the
  // result exists for singular A as well.
  Transform for_normals() const {
    const double sign = determinant() < 0 ? -1 : 1;
    return {{sign * cross(rows[1], rows[2]), sign * cross(rows[2], rows[0]),
             sign * cross(rows[0], rows[1])},
            {0, 0, 0}};
  }
  // The map that applies `first`, then this one.
  Transform after(const Transform& first) const {
    Transform result;
    for (unsigned i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) result.rows[i][k] = dot(rows[i], first.column(k));
    result.shift = apply(first.shift);
    return result;
  }
};

// The rotation by a unit quaternion (x, y, z, w).
Transform rotation(const std::vector<double>& q) {
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  Transform result;
  result.rows = {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                  {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                  {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
  return result;
}

// The transform of a node relative to its parent: a matrix of 4 x 4, or translation * rotation *
// scale, each of which may be missing (glTF 2.0, 3.5.3).
Transform transform_of(const tinygltf::Node& node) {
  Transform result;
  if (node.matrix.size() == 16) {  // column by column
    const auto& m = node.matrix;
    for (unsigned i = 0; i < 3; ++i) result.rows[i] = {m[i], m[4 + i], m[8 + i]};
    result.shift = {m[12], m[13], m[14]};
    return result;
  }
  if (node.rotation.size() == 4) result = rotation(node.rotation);
  if (node.scale.size() == 3)
    for (Vec3d& row : result.rows)
      row = {row.x * node.scale[0], row.y * node.scale[1], row.z * node.scale[2]};
  if (node.translation.size() == 3)
    result.shift = {node.translation[0], node.translation[1], node.translation[2]};
  return result;
}

// items[index], or an error that names the index. Indices of glTF are int, and -1 if missing.
template <class T>
const T& item(const std::vector<T>& items, int index, const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) >= items.size())
    fail(fmt::format("{} {} does not exist", what, index));
  return items[static_cast<std::size_t>(index)];
}

// The array that a glTF accessor describes. All its elements lie inside of their buffer.
struct AccessorView {
  const unsigned char* data;
  std::size_t count, stride;  // stride in bytes, at least the size of an element

  // The bytes need not be aligned.
  template <class T>
  T at(std::size_t i) const {
    T value;
    std::memcpy(&value, data + i * stride, sizeof value);
    return value;
  }
};

// Resolves an accessor whose elements have `size` bytes. An accessor is a part of a buffer view,
// which is a part of a buffer; all sizes come from the file. Each comparison subtracts only what an
// earlier one has found to be no larger, and none adds or multiplies, so nothing overflows. The
// last element needs `size` bytes only, not a whole stride.
AccessorView elements(const tinygltf::Model& model, const tinygltf::Accessor& accessor,
                      std::size_t size) {
  if (accessor.sparse.isSparse) fail("sparse accessors are not read here");
  const auto& view = item(model.bufferViews, accessor.bufferView, "buffer view");
  const auto& data = item(model.buffers, view.buffer, "buffer").data;
  const int stride = accessor.ByteStride(view);
  if (stride < 0 || static_cast<std::size_t>(stride) < size) fail("an accessor's stride is wrong");
  const auto step = static_cast<std::size_t>(stride);
  const bool view_fits =
      view.byteOffset <= data.size() && view.byteLength <= data.size() - view.byteOffset;
  const bool fits = view_fits && accessor.byteOffset <= view.byteLength &&
                    (accessor.count == 0 ||
                     (view.byteLength - accessor.byteOffset >= size &&
                      accessor.count - 1 <= (view.byteLength - accessor.byteOffset - size) / step));
  if (!fits) fail(fmt::format("an accessor of {} elements runs out of its buffer", accessor.count));
  return {data.data() + view.byteOffset + accessor.byteOffset, accessor.count, step};
}

// An accessor of positions or normals. Quantised ones (an extension of glTF) are refused.
AccessorView float_vectors(const tinygltf::Model& model, int accessor_index) {
  const auto& accessor = item(model.accessors, accessor_index, "accessor");
  if (accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT ||
      accessor.type != TINYGLTF_TYPE_VEC3)
    fail("positions and normals are read as float vectors only");
  return elements(model, accessor, sizeof(Vec3f));
}

// The indices of a primitive into its own vertices, of which there are `vertices`. Throws if an
// index is larger. A primitive without indices uses its vertices one after the other.
std::vector<std::uint32_t> read_indices(const tinygltf::Model& model,
                                        const tinygltf::Primitive& primitive,
                                        std::size_t vertices) {
  std::vector<std::uint32_t> indices;
  if (primitive.indices < 0) {
    for (std::uint32_t i = 0; i < vertices; ++i) indices.push_back(i);
    return indices;
  }
  const auto& accessor = item(model.accessors, primitive.indices, "accessor");
  const auto read = [&]<class T>(T) {
    const AccessorView source = elements(model, accessor, sizeof(T));
    indices.resize(source.count);
    for (std::size_t i = 0; i < source.count; ++i) indices[i] = source.at<T>(i);
  };
  switch (accessor.componentType) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      read(std::uint8_t{});
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      read(std::uint16_t{});
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      read(std::uint32_t{});
      break;
    default:
      fail("indices are of no type that glTF allows");
  }
  for (const std::uint32_t i : indices)
    if (i >= vertices) fail(fmt::format("index {} of a primitive with {} vertices", i, vertices));
  return indices;
}

// Collects the triangles of the default scene (the first one if none is named), or of all meshes if
// the file has no scenes.
class GlbReader {
 public:
  explicit GlbReader(const tinygltf::Model& model)
      : model_(model), visited_(model.nodes.size(), false) {}

  MeshFile read() {
    const auto& scenes = model_.scenes;
    if (scenes.empty()) {
      for (const tinygltf::Mesh& mesh : model_.meshes) add(mesh, Transform{});
    } else {
      const int scene = std::max(model_.defaultScene, 0);
      for (const int root : item(scenes, scene, "scene").nodes) visit(root);
    }
    // If only some primitives have normals, those are dropped: a mesh has one per vertex or none.
    if (file_.mesh.normals.size() != file_.mesh.vertex_count()) file_.mesh.normals.clear();
    if (skipped_ > 0)
      file_.notes.push_back(
          fmt::format("{} primitives that are no triangles were left out", skipped_));
    if (left_over_ > 0)
      file_.notes.push_back(fmt::format(
          "{} indices at the ends of primitives make no whole triangle and were left out",
          left_over_));
    return std::move(file_);
  }

 private:
  // Adds the meshes of a node and of its descendants, in depth-first order. The stack of open nodes
  // is a vector, because a hostile file could nest nodes deeper than recursion can go. A node that
  // is met twice is an error (glTF demands trees); so the loop ends even if nodes form a cycle.
  // Children are pushed in reverse, so that the first is taken first.
  void visit(int root) {
    std::vector<std::pair<int, Transform>> open{{root, Transform{}}};
    while (!open.empty()) {
      const auto [index, above] = open.back();
      open.pop_back();
      const tinygltf::Node& node = item(model_.nodes, index, "node");
      if (visited_[static_cast<std::size_t>(index)])
        fail(fmt::format("node {} has more than one parent", index));
      visited_[static_cast<std::size_t>(index)] = true;
      const Transform here = above.after(transform_of(node));
      if (node.mesh >= 0) add(item(model_.meshes, node.mesh, "mesh"), here);
      for (const int child : std::views::reverse(node.children)) open.push_back({child, here});
    }
  }

  // Adds the primitives of a mesh. A primitive of no mode (-1) is one of triangles, the default.
  void add(const tinygltf::Mesh& mesh, const Transform& transform) {
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      const bool triangles = primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode == -1;
      const auto position = primitive.attributes.find("POSITION");
      if (triangles && position != primitive.attributes.end()) {
        add(primitive, position->second, transform);
      } else {
        ++skipped_;
      }
    }
  }

  // Adds a primitive of triangles, whose positions are in accessor number `position`.
  void add(const tinygltf::Primitive& primitive, int position, const Transform& transform) {
    IndexedMesh& mesh = file_.mesh;
    const AccessorView points = float_vectors(model_, position);
    const std::size_t first = mesh.vertex_count();
    check_vertex_limit(std::uint64_t{first} + points.count);
    for (std::size_t i = 0; i < points.count; ++i) {
      const Vec3d p = transform.apply(cast<double>(points.at<Vec3f>(i)));
      if (!std::isfinite(p.x + p.y + p.z)) fail(fmt::format("vertex {} is not finite", i));
      mesh.positions.push_back(p);
    }
    const auto normal = primitive.attributes.find("NORMAL");
    if (normal != primitive.attributes.end()) add_normals(normal->second, points.count, transform);
    add_triangles(read_indices(model_, primitive, points.count), first,
                  transform.determinant() < 0);
  }

  void add_normals(int accessor, std::size_t count, const Transform& transform) {
    const AccessorView source = float_vectors(model_, accessor);
    if (source.count != count) fail("normals are not as many as vertices");
    const Transform turn = transform.for_normals();
    // Without rotation or scale, normals keep their bits. Normals of length 0 stay as they are,
    // too.
    const bool plain = turn.rows == Transform{}.rows;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3f given = source.at<Vec3f>(i);
      const Vec3d turned = turn.apply_linear(cast<double>(given));
      const double length = norm(turned);
      file_.mesh.normals.push_back(plain || !(length > 0) ? given
                                                          : cast<float>((1 / length) * turned));
    }
  }

  // Adds the triangles of a primitive whose vertices begin at `first`. A transform with a negative
  // determinant is a mirror and reverses the winding (glTF 2.0, 3.7.4), so two corners are swapped.
  void add_triangles(const std::vector<std::uint32_t>& indices, std::size_t first, bool mirrored) {
    left_over_ += indices.size() % 3;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      const auto corner = [&](std::size_t k) {
        return static_cast<std::uint32_t>(first + indices[i + k]);
      };
      file_.mesh.triangles.push_back(
          {corner(0), corner(mirrored ? 2 : 1), corner(mirrored ? 1 : 2)});
    }
  }

  const tinygltf::Model& model_;
  std::vector<bool> visited_;  // by index of the node
  MeshFile file_;
  std::uint64_t skipped_ = 0;    // primitives that are no triangles or have no positions
  std::uint64_t left_over_ = 0;  // indices at the ends of primitives that make no triangle
};

}  // namespace

MeshFile read_glb(std::string_view bytes) {
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max())
    fail("the file is larger than its 32 bits can count");
  tinygltf::TinyGLTF loader;
  // Images are not decoded: the callback says true, as if it had done so. Without file callbacks,
  // tinygltf opens no other file, whatever the file names. NO_REQUIRE lets tinygltf accept files
  // without the parts that glTF demands; GlbReader checks what it uses.
  loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int,
                           const unsigned char*, int, void*) { return true; },
                        nullptr);
  loader.SetFsCallbacks({});
  tinygltf::Model model;
  std::string error, warning;
  const bool loaded = loader.LoadBinaryFromMemory(
      &model, &error, &warning, reinterpret_cast<const unsigned char*>(bytes.data()),
      static_cast<unsigned int>(bytes.size()), "", tinygltf::NO_REQUIRE);
  std::replace(error.begin(), error.end(), '\n', ' ');
  if (!loaded) fail(error.empty() ? "not understood" : error);
  return GlbReader(model).read();
}

}  // namespace vdwmesh::formats
