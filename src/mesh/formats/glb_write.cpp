// Writer of GLB, the binary form of glTF 2.0: a header, a chunk of JSON and a chunk of binary
// arrays.
//
// glTF has float32 positions only. To lose little, positions are stored relative to the middle of
// the mesh's bounding box, and the translation of the node, a double in the JSON, moves them back.
// tinygltf could write the file, but only from a second copy of all arrays and in one call. Here
// each array goes through a ChunkWriter into the sink, which can stop between two writes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "core/errors.hpp"
#include "mesh/formats/chunk_writer.hpp"
#include "mesh/formats/float_loss.hpp"
#include "mesh/formats/formats.hpp"
#include "mesh/formats/glb_file.hpp"
#include "spheres/box.hpp"

namespace vdwmesh::formats {
namespace {

using Json = nlohmann::json;

// An upper bound of the JSON, with the headers. Its length depends on the mesh by few numbers only.
constexpr std::uint64_t kMaxJsonBytes = 4096;

// The bounding box of all vertices as in the file; a mesh without any has a box at the origin.
Box box_of(const MeshView& view) {
  if (view.mesh.vertex_count() == 0) return {{0, 0, 0}, {0, 0, 0}};
  const Box box = box_around(view.mesh.positions);
  return {view.scale * box.lower, view.scale * box.upper};
}

// Bytes of the four arrays: positions, normals, colours, corners of the triangles.
std::uint64_t binary_size(const IndexedMesh& mesh) {
  return (2 * kVectorSize + kColorSize) * std::uint64_t{mesh.vertex_count()} +
         kTriangleSize * std::uint64_t{mesh.triangle_count()};
}

// The header stores the size of the file as uint32.
void check_size(const IndexedMesh& mesh) {
  const std::uint64_t bytes = binary_size(mesh) + kMaxJsonBytes;
  if (bytes > std::numeric_limits<std::uint32_t>::max())
    throw LimitExceeded(fmt::format(
        "a GLB file of {} bytes is more than its 32 bits can count; PLY holds any mesh", bytes));
}

template <class T>
Json as_json(const Vec3<T>& v) {
  return {v.x, v.y, v.z};
}

// Adds the four arrays to the JSON, each as a buffer view and an accessor, in the order in which
// write_arrays() writes them, and the mesh that uses them.
void describe_arrays(const IndexedMesh& mesh, const Box& box, Json& json) {
  const std::uint64_t vertices = mesh.vertex_count(), faces = mesh.triangle_count();
  std::uint64_t offset = 0;
  // `offset` is where the next array begins in the binary chunk; 0 is the default and not written.
  const auto add = [&](std::uint64_t bytes, int target, Json accessor) {
    Json view{{"buffer", 0}, {"byteLength", bytes}, {"target", target}};
    if (offset > 0) view["byteOffset"] = offset;
    accessor["bufferView"] = json["bufferViews"].size();
    json["bufferViews"].push_back(std::move(view));
    json["accessors"].push_back(std::move(accessor));
    offset += bytes;
  };
  // glTF demands the exact bounds of the stored positions. Subtracting the middle and rounding are
  // monotone, so the rounded corners of the box are the bounds of the rounded vertices.
  const auto rounded = [&](const Vec3d& p) { return as_json(cast<float>(p - middle(box))); };
  add(kVectorSize * vertices, kArrayBuffer,
      {{"componentType", kFloat},
       {"count", vertices},
       {"type", "VEC3"},
       {"min", rounded(box.lower)},
       {"max", rounded(box.upper)}});
  add(kVectorSize * vertices, kArrayBuffer,
      {{"componentType", kFloat}, {"count", vertices}, {"type", "VEC3"}});
  add(kColorSize * vertices, kArrayBuffer,
      {{"componentType", kUnsignedShort},
       {"count", vertices},
       {"type", "VEC4"},
       {"normalized", true}});
  add(kTriangleSize * faces, kElementArrayBuffer,
      {{"componentType", kUnsignedInt}, {"count", 3 * faces}, {"type", "SCALAR"}});
  json["buffers"] = {{{"byteLength", offset}}};
  json["meshes"] = {{{"primitives",
                      {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"COLOR_0", 2}}},
                        {"indices", 3},
                        {"material", 0},
                        {"mode", kTriangles}}}}}};
  // The material that glTF takes where none is named is a metal, whose colours look wrong.
  json["materials"] = {
      {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.6}}}}};
}

// The JSON chunk.
std::string json_of(const MeshView& view, const Box& box) {
  const IndexedMesh& mesh = view.mesh;
  Json json{
      {"asset",
       {{"version", "2.0"}, {"generator", fmt::format("vdwmesh; {}", unit_text(view.scale))}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"translation", as_json(middle(box))}}}}};
  if (mesh.triangle_count() > 0) {  // glTF has no empty buffers
    describe_arrays(mesh, box, json);
    json["nodes"][0]["mesh"] = 0;
  }
  return padded(json.dump());
}

// linear_light() of each byte in 16 bits, in which no two bytes become equal.
std::array<std::uint16_t, 256> linear_colors() {
  std::array<std::uint16_t, 256> linear;
  for (std::size_t byte = 0; byte < linear.size(); ++byte) {
    const double value = linear_light(static_cast<std::uint8_t>(byte));
    linear[byte] = static_cast<std::uint16_t>(std::lround(65535 * value));
  }
  return linear;
}

// Writes the arrays in the order of describe_arrays(). `origin` is the middle of the box. Colours
// get a fourth number, for alpha.
void write_arrays(const MeshView& view, const Vec3d& origin, ChunkWriter& out, Warnings& warnings) {
  const auto for_each = [&](std::size_t count, const auto& write) {
    for (std::size_t i = 0; i < count; ++i) {
      out.begin_record();
      write(i);
    }
  };
  const IndexedMesh& mesh = view.mesh;
  FloatLoss loss(view.scale);
  for_each(mesh.vertex_count(),
           [&](std::size_t v) { out.raw(loss.round(view.position(v) - origin)); });
  loss.finish("GLB", warnings);
  for_each(mesh.vertex_count(), [&](std::size_t v) { out.raw(view.normals[v]); });
  const std::array<std::uint16_t, 256> linear = linear_colors();
  for_each(mesh.vertex_count(), [&](std::size_t v) {
    const RgbColor c = view.color(v);
    out.raw(std::array<std::uint16_t, 4>{linear[c[0]], linear[c[1]], linear[c[2]], 0xffff});
  });
  for_each(mesh.triangle_count(), [&](std::size_t f) { out.raw(mesh.triangles[f]); });
}

}  // namespace

void write_glb(const MeshView& view, ByteSink& sink, Warnings& warnings) {
  const IndexedMesh& mesh = view.mesh;
  check_size(mesh);
  const Box box = box_of(view);
  const std::string json = json_of(view, box);
  const std::uint64_t binary = mesh.triangle_count() > 0 ? binary_size(mesh) : 0;
  sink.expect(kHeaderSize + 2 * kChunkHeaderSize + json.size() + binary);
  ChunkWriter out(sink);
  write_header(json, binary, out);
  if (binary > 0) write_arrays(view, middle(box), out, warnings);
  out.flush();
}

}  // namespace vdwmesh::formats
