// Writers of several meshes with names as one file: GLB and OBJ. That of 3MF is in three_mf.cpp.
// GLB has the parts of a mesh one by one, each relative to the middle of all, as doubles do not
// fit.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "core/errors.hpp"
#include "core/no_index.hpp"
#include "mesh/formats/chunk_writer.hpp"
#include "mesh/formats/float_loss.hpp"
#include "mesh/formats/formats.hpp"
#include "mesh/formats/glb_file.hpp"
#include "mesh/formats/record_writer.hpp"
#include "spheres/box.hpp"

namespace vdwmesh::formats {
namespace {

// One part of a mesh, with vertices and normals of its own.
struct GlbPart {
  std::string name;
  IndexedMesh mesh;
  std::array<std::uint8_t, 4> color;
  std::size_t parent;  // the part it hangs on, or itself
};

IndexedMesh triangles_of(const NamedMesh& whole, std::uint32_t part) {
  IndexedMesh out;
  std::vector<std::uint32_t> numbers(whole.mesh.vertex_count(), kNoIndex);
  for (std::size_t t = 0; t < whole.mesh.triangle_count(); ++t) {
    if (whole.parts[t] != part) continue;
    Triangle triangle = whole.mesh.triangles[t];
    for (std::uint32_t& v : triangle) {
      if (numbers[v] == kNoIndex) {
        numbers[v] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(whole.mesh.positions[v]);
      }
      v = numbers[v];
    }
    out.triangles.push_back(triangle);
  }
  out.normals = normals_of_triangles(out);
  return out;
}

// glTF has no empty arrays, so parts without a triangle are left out.
std::vector<GlbPart> parts_of(std::span<const NamedMesh> meshes) {
  std::vector<GlbPart> parts;
  for (const NamedMesh& m : meshes) {
    const std::size_t first = parts.size();
    for (std::uint32_t i = 0; i < m.part_names.size(); ++i) {
      IndexedMesh mesh = triangles_of(m, i);
      if (mesh.triangles.empty()) continue;
      const bool is_first = parts.size() == first;
      parts.push_back(
          {is_first ? m.name : m.part_names[i], std::move(mesh), m.part_colors[i], first});
    }
  }
  return parts;
}

class PartsWriter {
 public:
  PartsWriter(std::vector<GlbPart> parts, ByteSink& sink)
      : parts_(std::move(parts)), sink_(sink), out_(sink) {
    Box box = empty_box();
    for (const GlbPart& part : parts_) include(box, box_around(part.mesh.positions));
    origin_ = middle(box);
  }

  void run(Warnings& warnings) {
    json_["asset"] = {{"version", "2.0"}, {"generator", "vdwmesh; lengths in angstrom"}};
    json_["scene"] = 0;
    json_["scenes"] = nlohmann::json::array({nlohmann::json::object()});
    for (std::size_t i = 0; i < parts_.size(); ++i) describe(i);
    if (binary_ > 0) json_["buffers"] = {{{"byteLength", binary_}}};
    const std::string text = padded(json_.dump());
    if (binary_ + text.size() + 64 > std::numeric_limits<std::uint32_t>::max())
      throw LimitExceeded("meshes of more bytes than the 32 bits of a GLB file can count");
    sink_.expect(text.size() + binary_ + 64);
    write_header(text, binary_, out_);
    write_arrays(warnings);
    out_.flush();
  }

 private:
  // All parts are relative to one place, to which the meshes' nodes are moved.
  void describe(std::size_t i) {
    const GlbPart& part = parts_[i];
    const Box box = box_around(part.mesh.positions);
    const auto rounded = [&](const Vec3d& p) {
      const Vec3f r = cast<float>(p - origin_);
      return nlohmann::json{r.x, r.y, r.z};
    };
    const std::size_t vertices = part.mesh.vertex_count(), first = json_["accessors"].size();
    add_array(kVectorSize * vertices, kArrayBuffer,
              {{"componentType", kFloat},
               {"count", vertices},
               {"type", "VEC3"},
               {"min", rounded(box.lower)},
               {"max", rounded(box.upper)}});
    add_array(kVectorSize * vertices, kArrayBuffer,
              {{"componentType", kFloat}, {"count", vertices}, {"type", "VEC3"}});
    add_array(kTriangleSize * part.mesh.triangle_count(), kElementArrayBuffer,
              {{"componentType", kUnsignedInt},
               {"count", 3 * part.mesh.triangle_count()},
               {"type", "SCALAR"}});
    json_["meshes"].push_back({{"name", part.name},
                               {"primitives",
                                {{{"attributes", {{"POSITION", first}, {"NORMAL", first + 1}}},
                                  {"indices", first + 2},
                                  {"material", i},
                                  {"mode", kTriangles}}}}});
    json_["materials"].push_back(material(part));
    nlohmann::json node{{"name", part.name}, {"mesh", i}};
    if (part.parent == i) {
      node["translation"] = {origin_.x, origin_.y, origin_.z};
      json_["scenes"][0]["nodes"].push_back(i);
    } else {
      json_["nodes"][part.parent]["children"].push_back(i);
    }
    json_["nodes"].push_back(std::move(node));
  }

  static nlohmann::json material(const GlbPart& part) {
    const auto [red, green, blue, opaque] = part.color;
    nlohmann::json out{
        {"name", part.name},
        {"doubleSided", true},
        {"pbrMetallicRoughness",
         {{"baseColorFactor",
           {linear_light(red), linear_light(green), linear_light(blue), opaque / 255.0}},
          {"metallicFactor", 0},
          {"roughnessFactor", 0.6}}}};
    if (opaque < 255) out["alphaMode"] = "BLEND";
    return out;
  }

  void add_array(std::uint64_t bytes, int target, nlohmann::json accessor) {
    accessor["bufferView"] = json_["bufferViews"].size();
    json_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary_}, {"byteLength", bytes}, {"target", target}});
    json_["accessors"].push_back(std::move(accessor));
    binary_ += bytes;
  }

  // In the order of describe().
  void write_arrays(Warnings& warnings) {
    FloatLoss loss(1);
    const auto write = [&](const auto& array, const auto& convert) {
      for (const auto& element : array) {
        out_.begin_record();
        out_.raw(convert(element));
      }
    };
    const auto as_is = [](const auto& value) { return value; };
    for (const GlbPart& part : parts_) {
      write(part.mesh.positions, [&](const Vec3d& p) { return loss.round(p - origin_); });
      write(part.mesh.normals, as_is);
      write(part.mesh.triangles, as_is);
    }
    loss.finish("GLB", warnings);
  }

  std::vector<GlbPart> parts_;
  ByteSink& sink_;
  ChunkWriter out_;
  Vec3d origin_{};
  nlohmann::json json_;
  std::uint64_t binary_ = 0;  // bytes of all arrays
};

std::string with_underscores(std::string name) {
  std::ranges::replace(name, ' ', '_');
  return name;
}

}  // namespace

void write_glb(std::span<const NamedMesh> meshes, ByteSink& sink, Warnings& warnings) {
  PartsWriter(parts_of(meshes), sink).run(warnings);
}

// Numbers of vertices go through the whole file.
void write_obj(std::span<const NamedMesh> meshes, ByteSink& sink) {
  const auto write = [&](const std::string& text) { sink.write(text.data(), text.size()); };
  write("# made by vdwmesh; lengths in angstrom\n");
  constexpr std::size_t kMostPerLine = 3 * (RecordBytes::kMostPerNumber + 1) + 3;
  const auto write_line = [](RecordBytes& out, char keyword, const auto& value) {
    out.character(keyword);
    for (int k = 0; k < 3; ++k) out.character(' '), out.number(value(k));
    out.character('\n');
  };
  std::uint64_t before = 1;
  for (const NamedMesh& m : meshes) {
    write(fmt::format("o {}\n", with_underscores(m.name)));
    write_records(sink, m.mesh.vertex_count(), kMostPerLine, [&](RecordBytes& out, std::size_t v) {
      write_line(out, 'v', [&](int k) { return m.mesh.positions[v][k]; });
    });
    for (std::uint32_t part = 0; part < m.part_names.size(); ++part) {
      std::vector<Triangle> triangles;
      for (std::size_t t = 0; t < m.mesh.triangle_count(); ++t) {
        if (m.parts[t] == part) triangles.push_back(m.mesh.triangles[t]);
      }
      write(fmt::format("g {}\n", with_underscores(m.part_names[part])));
      write_records(sink, triangles.size(), kMostPerLine, [&](RecordBytes& out, std::size_t t) {
        write_line(out, 'f',
                   [&](int k) { return before + triangles[t][static_cast<std::size_t>(k)]; });
      });
    }
    before += m.mesh.vertex_count();
  }
}

}  // namespace vdwmesh::formats
