// Reader of GLB, the binary form of glTF 2.0. The library tinygltf parses the JSON and finds the
// binary chunk; this file checks its indices and sizes, walks through the tree of nodes and
// collects all triangles in one mesh. A file may place an array any number of times, so a first
// walk adds up what the mesh takes and a second one makes it. Every node has a transform relative
// to its parent, which is applied in double, so a translation such as write_glb() stores keeps the
// precision of the positions.
#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <ranges>

#include "core/errors.hpp"
#include "mesh/formats/formats.hpp"

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
  // Number k of element i, a vector of floats.
  float number(std::size_t i, std::size_t k) const {
    float value;
    std::memcpy(&value, data + i * stride + k * sizeof value, sizeof value);
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

// An accessor of vectors of `dimension` floats. Quantised ones (an extension of glTF) are refused.
AccessorView float_vectors(const tinygltf::Model& model, int accessor_index, int dimension = 3) {
  const auto& accessor = item(model.accessors, accessor_index, "accessor");
  if (accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT ||
      accessor.type != (dimension == 3 ? TINYGLTF_TYPE_VEC3 : TINYGLTF_TYPE_VEC4))
    fail("positions, normals and places of instances are read as float vectors only");
  return elements(model, accessor, static_cast<std::size_t>(dimension) * sizeof(float));
}

// Calls use(T{}) with the type of the indices in the accessor.
template <class Use>
auto with_index_type(const tinygltf::Accessor& accessor, const Use& use) {
  switch (accessor.componentType) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return use(std::uint8_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return use(std::uint16_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return use(std::uint32_t{});
    default:
      fail("indices are of no type that glTF allows");
  }
}

// How many indices a primitive with so many vertices has. A primitive without indices uses its
// vertices one after the other.
std::size_t index_count(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                        std::size_t vertices) {
  if (primitive.indices < 0) return vertices;
  const auto& accessor = item(model.accessors, primitive.indices, "accessor");
  return with_index_type(accessor,
                         [&]<class T>(T) { return elements(model, accessor, sizeof(T)).count; });
}

// The indices of a primitive into its own vertices, of which there are `vertices`. Throws if an
// index is larger.
std::vector<std::uint32_t> read_indices(const tinygltf::Model& model,
                                        const tinygltf::Primitive& primitive,
                                        std::size_t vertices) {
  std::vector<std::uint32_t> indices(index_count(model, primitive, vertices));
  if (primitive.indices < 0) {
    std::iota(indices.begin(), indices.end(), 0u);
    return indices;
  }
  const auto& accessor = item(model.accessors, primitive.indices, "accessor");
  with_index_type(accessor, [&]<class T>(T) {
    const AccessorView source = elements(model, accessor, sizeof(T));
    for (std::size_t i = 0; i < source.count; ++i) indices[i] = source.at<T>(i);
  });
  for (const std::uint32_t i : indices)
    if (i >= vertices) fail(fmt::format("index {} of a primitive with {} vertices", i, vertices));
  return indices;
}

constexpr std::string_view kInstancing = "EXT_mesh_gpu_instancing";

// Whether an extension is applied here or is about looks alone. The triangles of a file that needs
// any other extension are not those that its plain glTF describes.
bool keeps_triangles(std::string_view extension) {
  static constexpr std::string_view kLooks[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                                "KHR_lights_",    "EXT_lights_",  "KHR_xmp"};
  return extension == kInstancing ||
         std::ranges::any_of(kLooks, [&](auto begin) { return extension.starts_with(begin); });
}

// Refuses a file that cannot be understood without an extension that is not applied here.
void check_required(const tinygltf::Model& model) {
  for (const std::string& name : model.extensionsRequired)
    if (!keeps_triangles(name))
      fail(
          fmt::format("the extension {}, which the file requires, is not read here; write the "
                      "mesh without it",
                      name));
}

// Calls visit(transform) for every instance of a node's mesh: once with the identity if the node
// has no EXT_mesh_gpu_instancing, and otherwise with each translation * rotation * scale.
template <class Visit>
void for_each_instance(const tinygltf::Model& model, const tinygltf::Node& node,
                       const Visit& visit) {
  const auto extension = node.extensions.find(std::string(kInstancing));
  if (extension == node.extensions.end()) return visit(Transform{});
  const tinygltf::Value& attributes = extension->second.Get("attributes");
  tinygltf::Node place;  // of one instance
  struct ReadPart {
    std::vector<double>& values;
    AccessorView source;
  };
  std::vector<ReadPart> parts;
  const auto find = [&](const char* name, std::vector<double>& values, int dimension) {
    if (!attributes.IsObject() || !attributes.Has(name)) return;
    const tinygltf::Value& accessor = attributes.Get(name);
    if (!accessor.IsInt()) fail(fmt::format("{} of {} is no accessor", name, kInstancing));
    parts.push_back({values, float_vectors(model, accessor.GetNumberAsInt(), dimension)});
    values.resize(static_cast<std::size_t>(dimension));
  };
  find("TRANSLATION", place.translation, 3);
  find("ROTATION", place.rotation, 4);
  find("SCALE", place.scale, 3);
  if (parts.empty()) fail(fmt::format("{} without places of instances", kInstancing));
  for (const ReadPart& part : parts)
    if (part.source.count != parts[0].source.count)
      fail(fmt::format("{} with attributes of different counts", kInstancing));
  for (std::size_t i = 0; i < parts[0].source.count; ++i) {
    for (const ReadPart& part : parts)
      for (std::size_t k = 0; k < part.values.size(); ++k)
        part.values[k] = double{part.source.number(i, k)};
    visit(transform_of(place));
  }
}

// The accessor of an attribute of a primitive, or -1.
int attribute(const tinygltf::Primitive& primitive, const char* name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

// Whether a primitive has triangles. One of no mode (-1) is a list of triangles, the default.
bool has_triangles(const tinygltf::Primitive& primitive) {
  return (primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode == -1 ||
          primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
          primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN) &&
         attribute(primitive, "POSITION") >= 0;
}

// Primitives of a mesh that name the same accessors of positions and normals share their vertices.
using VertexSource = std::pair<int, int>;
VertexSource vertex_source(const tinygltf::Primitive& primitive) {
  return {attribute(primitive, "POSITION"), attribute(primitive, "NORMAL")};
}

// Collects the triangles of the default scene (the first one if none is named), or of all meshes if
// the file has no scenes.
class GlbReader {
 public:
  explicit GlbReader(const tinygltf::Model& model) : model_(model) {}

  MeshFile read(std::uint64_t memory_limit) {
    reserve(memory_limit);
    for_each_mesh([&](int mesh, const Transform& transform) { add(mesh, transform); });
    // If only some primitives have normals, those are dropped: a mesh has one per vertex or none.
    if (file_.mesh.normals.size() != file_.mesh.vertex_count()) file_.mesh.normals.clear();
    add_notes();
    return std::move(file_);
  }

 private:
  // Calls visit(mesh, transform) for every mesh that is to be read, with its number, as often as it
  // is placed.
  template <class Visit>
  void for_each_mesh(const Visit& visit) const {
    if (!model_.scenes.empty()) {
      const int scene = std::max(model_.defaultScene, 0);
      return for_each_mesh_below(item(model_.scenes, scene, "scene").nodes, visit);
    }
    for (std::size_t m = 0; m < model_.meshes.size(); ++m) visit(static_cast<int>(m), Transform{});
  }

  // Takes the nodes and their descendants in depth-first order. The stack of open nodes is a
  // vector, because a hostile file could nest nodes deeper than recursion can go. A node that is
  // met twice is an error (glTF demands trees); so the loop ends even if nodes form a cycle.
  // Children are pushed in reverse, so that the first is taken first.
  template <class Visit>
  void for_each_mesh_below(const std::vector<int>& roots, const Visit& visit) const {
    std::vector<bool> visited(model_.nodes.size(), false);
    std::vector<std::pair<int, Transform>> open;
    for (const int root : std::views::reverse(roots)) open.push_back({root, Transform{}});
    while (!open.empty()) {
      const auto [index, above] = open.back();
      open.pop_back();
      const tinygltf::Node& node = item(model_.nodes, index, "node");
      if (visited[static_cast<std::size_t>(index)])
        fail(fmt::format("node {} has more than one parent", index));
      visited[static_cast<std::size_t>(index)] = true;
      const Transform here = above.after(transform_of(node));
      if (node.mesh >= 0)
        for_each_instance(model_, node, [&, mesh = node.mesh, &outer = here](const Transform& own) {
          visit(mesh, outer.after(own));
        });
      for (const int child : std::views::reverse(node.children)) open.push_back({child, here});
    }
  }

  // The vertices and triangles that one placement of a mesh adds. A primitive counts as one
  // triangle at least, so that the sum bounds the time, too.
  MeshSize size_of(const tinygltf::Mesh& mesh) const {
    MeshSize size{};
    std::map<VertexSource, std::size_t> vertices;
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      ++size.triangles;
      if (!has_triangles(primitive)) continue;
      const auto [source, added] = vertices.try_emplace(vertex_source(primitive), 0);
      if (added) {
        source->second = float_vectors(model_, source->first.first).count;
        size.vertices += source->second;
      }
      const std::size_t indices = index_count(model_, primitive, source->second);
      size.triangles +=
          primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode == -1 ? indices / 3 : indices;
    }
    return size;
  }

  // Makes room for the whole mesh. Throws LimitExceeded if it takes more than `memory_limit`.
  void reserve(std::uint64_t memory_limit) {
    std::vector<std::optional<MeshSize>> sizes(model_.meshes.size());
    MeshSize all{};
    for_each_mesh([&](int m, const Transform&) {
      const tinygltf::Mesh& mesh = item(model_.meshes, m, "mesh");
      auto& size = sizes[static_cast<std::size_t>(m)];
      if (!size) size = size_of(mesh);
      all.vertices += size->vertices;
      all.triangles += size->triangles;
      check_vertex_limit(all.vertices);
      const std::uint64_t bytes =
          all.vertices * (sizeof(Vec3d) + sizeof(Vec3f)) + all.triangles * sizeof(Triangle);
      if (bytes > memory_limit)
        throw LimitExceeded(fmt::format(
            "GLB: the file places {} vertices and {} triangles or more, which take {} bytes; {} "
            "are allowed: a higher memory limit would do",
            all.vertices, all.triangles, bytes, memory_limit));
    });
    file_.mesh.positions.reserve(all.vertices);
    file_.mesh.triangles.reserve(all.triangles);
  }

  void add_notes() {
    const auto note = [&](std::uint64_t count, std::string_view text) {
      if (count > 0) file_.notes.push_back(fmt::format("{} {}", count, text));
    };
    note(skipped_, "primitives that are no triangles were left out");
    note(left_over_, "indices at the ends of primitives make no whole triangle and were left out");
    note(static_cast<std::uint64_t>(std::ranges::count_if(
             model_.nodes, [](const tinygltf::Node& node) { return node.skin >= 0; })),
         "nodes have a skin, which is not applied: their meshes are as they were bound");
    const auto has_targets = [](const tinygltf::Mesh& mesh) {
      return std::ranges::any_of(mesh.primitives,
                                 [](const auto& primitive) { return !primitive.targets.empty(); });
    };
    note(static_cast<std::uint64_t>(std::ranges::count_if(model_.meshes, has_targets)),
         "meshes have morph targets, which are not applied: they are as without");
    for (const std::string& name : model_.extensionsUsed)
      if (!keeps_triangles(name))
        file_.notes.push_back(fmt::format("the extension {} is not applied", name));
  }

  // Adds the primitives of a mesh.
  void add(int mesh, const Transform& transform) {
    std::map<VertexSource, std::size_t> first_of;
    for (const tinygltf::Primitive& primitive : item(model_.meshes, mesh, "mesh").primitives) {
      if (!has_triangles(primitive)) {
        ++skipped_;
        continue;
      }
      const VertexSource source = vertex_source(primitive);
      const auto [found, added] = first_of.try_emplace(source, file_.mesh.vertex_count());
      if (added) add_vertices(source, transform);
      const std::size_t count = float_vectors(model_, source.first).count;
      add_triangles(read_indices(model_, primitive, count), primitive.mode, found->second,
                    transform.determinant() < 0);
    }
  }

  void add_vertices(const VertexSource& source, const Transform& transform) {
    const AccessorView points = float_vectors(model_, source.first);
    for (std::size_t i = 0; i < points.count; ++i) {
      const Vec3d p = transform.apply(cast<double>(points.at<Vec3f>(i)));
      if (!std::isfinite(p.x + p.y + p.z)) fail(fmt::format("vertex {} is not finite", i));
      file_.mesh.positions.push_back(p);
    }
    if (source.second >= 0) add_normals(source.second, points.count, transform);
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
  // Strips turn every second triangle, and join their parts by triangles that name a vertex twice.
  void add_triangles(const std::vector<std::uint32_t>& indices, int mode, std::size_t first,
                     bool mirrored) {
    const bool strip = mode == TINYGLTF_MODE_TRIANGLE_STRIP,
               fan = mode == TINYGLTF_MODE_TRIANGLE_FAN;
    if (!strip && !fan) left_over_ += indices.size() % 3;
    for (std::size_t i = 0; i + 2 < indices.size(); i += strip || fan ? 1 : 3) {
      std::array<std::uint32_t, 3> t{indices[i], indices[i + 1], indices[i + 2]};
      if (fan) t = {indices[i + 1], indices[i + 2], indices[0]};
      if (strip && (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])) continue;
      if ((strip && i % 2 == 1) != mirrored) std::swap(t[1], t[2]);
      const auto corner = [&](std::uint32_t v) { return static_cast<std::uint32_t>(first + v); };
      file_.mesh.triangles.push_back({corner(t[0]), corner(t[1]), corner(t[2])});
    }
  }

  const tinygltf::Model& model_;
  MeshFile file_;
  std::uint64_t skipped_ = 0;    // primitives that are no triangles or have no positions
  std::uint64_t left_over_ = 0;  // indices at the ends of primitives that make no triangle
};

}  // namespace

MeshFile read_glb(std::string_view bytes, std::uint64_t memory_limit) {
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
  // The names of extensions are read before what the file needs them for.
  check_required(model);
  if (!loaded) fail(error.empty() ? "not understood" : error);
  return GlbReader(model).read(memory_limit);
}

}  // namespace vdwmesh::formats
