// Reader of PLY files, text and binary. The header (ply_header.hpp) lists elements and properties
// in any order, and the reader takes what it knows by name: positions, normals and sphere ids of
// vertices; corner lists and atoms of faces. It drops the rest.
//
// PlyReader walks through the elements and does not know about bytes; BinaryBody and AsciiBody
// deliver numbers. Two fast paths of binary files avoid work per number: read_columns() for
// vertices without lists, and read_packed_triangles() for the usual layout of triangles.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "mesh/connect/polygons.hpp"
#include "mesh/formats/formats.hpp"
#include "mesh/formats/ply_header.hpp"
#include "mesh/formats/text_scanner.hpp"

namespace vdwmesh::formats {
namespace {

// Reads a T at any address. The host is little-endian, as chunk_writer.hpp asserts.
template <class T, PlyEncoding encoding>
T load(const char* from) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if constexpr (encoding == PlyEncoding::big_endian) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

// Calls use(T{}) with the C++ type T of a PlyScalar, so that a loop in `use` is compiled for T.
template <class Use>
auto with_type(PlyScalar scalar, Use&& use) {
  switch (scalar) {
    case PlyScalar::int8:
      return use(std::int8_t{});
    case PlyScalar::uint8:
      return use(std::uint8_t{});
    case PlyScalar::int16:
      return use(std::int16_t{});
    case PlyScalar::uint16:
      return use(std::uint16_t{});
    case PlyScalar::int32:
      return use(std::int32_t{});
    case PlyScalar::uint32:
      return use(std::uint32_t{});
    case PlyScalar::float32:
      return use(float{});
    default:  // float64
      return use(double{});
  }
}

// The body of a binary file, read number by number. Numbers are returned as double, which holds
// every PLY type exactly. All errors name the byte of the current position.
template <PlyEncoding encoding>
class BinaryBody {
 public:
  BinaryBody(std::string_view bytes, std::size_t start)
      : begin_(bytes.data()), at_(begin_ + start), end_(begin_ + bytes.size()) {}

  double number(PlyScalar scalar) {
    return with_type(scalar, [&]<class T>(T) {
      if (bytes_left() < sizeof(T)) fail("the file ends inside an element");
      const T value = load<T, encoding>(at_);
      at_ += sizeof(T);
      return static_cast<double>(value);
    });
  }
  // The T at `from`, in the byte order of the file. Does not check the end of the file.
  template <class T>
  static T load_as(const char* from) {
    return load<T, encoding>(from);
  }
  // Throws if the rest of the file cannot hold the elements that the header claims, even with empty
  // lists. Memory for an element is taken only after this check.
  void check_claimed_count(const PlyElement& element) const {
    const std::size_t least = element.least_size();
    if (least > 0 && element.count > bytes_left() / least)
      fail(fmt::format("{} '{}' elements are promised, but {} bytes are left for them",
                       element.count, element.name.substr(0, 24), bytes_left()));
  }
  // An upper bound of the list entries of this type that the rest of the file can hold.
  std::size_t max_list_entries(PlyScalar scalar) const { return bytes_left() / size_of(scalar); }
  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }
  // Steps over so many bytes and returns where they begin; take(0) is the current position. The
  // caller has checked that the file has them. rewind_to() returns to such a position.
  const char* take(std::size_t bytes) {
    const char* first = at_;
    at_ += bytes;
    return first;
  }
  void rewind_to(const char* position) { at_ = position; }
  // Whether the body is over. Some programs end a binary file with a line break.
  bool at_end() const {
    return std::all_of(at_, end_, [](char c) { return c == '\n' || c == '\r' || c == ' '; });
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw FileFormatError(fmt::format("byte {}: {}", at_ - begin_, in_ascii(what)));
  }

 private:
  const char* begin_;
  const char* at_;
  const char* end_;
};

// The body of a text file, with the same interface where PlyReader needs it. An element should be
// one line, but numbers are read across line ends. Errors name the line.
class AsciiBody {
 public:
  AsciiBody(std::string_view bytes, std::size_t start) : in_(bytes) {
    in_.move_to(bytes.data() + start);
  }
  double number(PlyScalar) {
    in_.skip_to_token();
    return in_.number();
  }
  void check_claimed_count(const PlyElement& element) const {
    // A number takes a digit and a separator at least; the last of the file needs none, hence + 1.
    const std::size_t least = 2 * element.properties.size();
    if (least > 0 && element.count > in_.bytes_left() / least + 1)
      fail(fmt::format("{} '{}' elements are promised, but {} bytes are left for them",
                       element.count, element.name.substr(0, 24), in_.bytes_left()));
  }
  std::size_t max_list_entries(PlyScalar) const { return in_.bytes_left(); }
  bool at_end() { return in_.at_end(); }
  [[noreturn]] void fail(const std::string& what) const { in_.fail(what); }

 private:
  TextScanner in_;
};

// What a property of a vertex means, and so where its value is stored. Properties with other names
// (colours, for instance) are read and dropped.
enum class Slot { other, x, y, z, nx, ny, nz, atom, sphere2, sphere3 };
constexpr std::size_t kSlots = 10;

// The slot of a property of this name. The names are in the order of the enumeration.
Slot slot_named(std::string_view name) {
  static constexpr std::string_view kNames[kSlots] = {"",   "x",  "y",    "z",       "nx",
                                                      "ny", "nz", "atom", "sphere2", "sphere3"};
  const auto* found = std::find(kNames + 1, kNames + kSlots, name);
  return found == kNames + kSlots ? Slot::other : static_cast<Slot>(found - kNames);
}

// Reads the elements in the order of the header. Body is BinaryBody or AsciiBody.
template <class Body>
class PlyReader {
 public:
  explicit PlyReader(Body body) : body_(body) {}

  MeshFile read(const PlyHeader& header) {
    for (const PlyElement& element : header.elements) {
      body_.check_claimed_count(element);
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element);
      } else if (element.name == "tristrips" && element.count > 0) {
        body_.fail("triangle strips are not read; write the mesh with an element 'face'");
      } else {
        skip(element);
      }
    }
    if (!has_vertices_) body_.fail("the file has no element 'vertex'");
    if (!body_.at_end()) body_.fail("more follows than the elements that the header promises");
    check_indices();
    file_.mesh.vertex_spheres.narrow();  // frees the second and third ids if no vertex has any
    label_all_triangles();
    polygons_.finish(file_);  // triangulates concave polygons; needs all positions
    return std::move(file_);
  }

 private:
  // Reads the element "vertex", by read_columns() if the layout allows that, else value by value.
  void read_vertices(const PlyElement& element) {
    if (std::exchange(has_vertices_, true)) body_.fail("a second element 'vertex'");
    check_vertex_limit(element.count);
    std::array<bool, kSlots> present{};
    std::vector<Slot> slots;  // one per property
    for (const PlyProperty& property : element.properties) {
      slots.push_back(property.list_count ? Slot::other : slot_named(property.name));
      present[static_cast<std::size_t>(slots.back())] = true;
    }
    const auto has = [&](Slot slot) { return present[static_cast<std::size_t>(slot)]; };
    if (!has(Slot::x) || !has(Slot::y) || !has(Slot::z)) body_.fail("vertices without x, y, z");
    const auto count = static_cast<std::size_t>(element.count);
    resize_untouched(file_.mesh.positions, count);
    if (has(Slot::nx) && has(Slot::ny) && has(Slot::nz))
      resize_untouched(file_.mesh.normals, count);
    // Without atoms there are no labels. If the file has only one of sphere2 and sphere3, the other
    // is preset to kNoSphere. If it has neither, `others` is empty, and the fill does nothing.
    if (has(Slot::atom)) {
      const bool has_others = has(Slot::sphere2) || has(Slot::sphere3);
      VertexLabels& labels = file_.mesh.vertex_spheres;
      labels.resize(count, has_others ? LabelWidth::three : LabelWidth::one);
      if (!has(Slot::sphere2) || !has(Slot::sphere3))
        std::fill(labels.others.begin(), labels.others.end(), kNoOthers);
    }
    if constexpr (!std::is_same_v<Body, AsciiBody>) {
      if (!element.has_lists()) return read_columns(element, slots);
    }
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t p = 0; p < slots.size(); ++p) {
        if (element.properties[p].list_count) {
          skip_list(element.properties[p]);
        } else {
          set(slots[p], i, body_.number(element.properties[p].type));
        }
      }
    check_finite(0, count);
  }

  // Reads vertices without lists from a binary file. In a block of 2048 vertices, which stays in
  // the cache, it reads one property of all vertices before the next property. So type and slot are
  // looked up only once for them. check_claimed_count() has made sure that the file holds them all.
  void read_columns(const PlyElement& element, const std::vector<Slot>& slots) {
    constexpr std::size_t kBlock = 2048;
    const std::size_t stride = element.least_size();
    for (std::size_t first = 0; first < element.count; first += kBlock) {
      const std::size_t last = std::min<std::size_t>(first + kBlock, element.count);
      const char* row = body_.take(0);  // address of property p in the block's first vertex
      for (std::size_t p = 0; p < slots.size(); ++p) {
        const PlyScalar type = element.properties[p].type;
        if (slots[p] != Slot::other) read_column(slots[p], type, row, stride, first, last);
        row += size_of(type);
      }
      check_finite(first, last);
      body_.take((last - first) * stride);
    }
  }

  // Reads one property of the vertices [first, last). `from` is its address in vertex `first`, and
  // `stride` is the size of a vertex in bytes.
  void read_column(Slot slot, PlyScalar type, const char* from, std::size_t stride,
                   std::size_t first, std::size_t last) {
    with_store(slot, [&](const auto& store) {
      with_type(type, [&]<class T>(T) {
        const char* at = from;
        for (std::size_t i = first; i < last; ++i, at += stride)
          store(i, static_cast<double>(body_.template load_as<T>(at)));
      });
    });
  }

  // Throws if a coordinate of the vertices [first, last) is not finite, or if their sum overflows.
  void check_finite(std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Vec3d& p = file_.mesh.positions[i];
      if (!std::isfinite(p.x + p.y + p.z))
        body_.fail(fmt::format("vertex {} is at {} {} {}", i, p.x, p.y, p.z));
    }
  }

  // A number of the file as a sphere id; kNoSphere if it is negative, not a number or too large.
  static SphereId sphere_id(double value) {
    return value >= 0 && value < kNoSphere ? static_cast<SphereId>(value) : kNoSphere;
  }

  // Calls use(store) with a function that stores a value of this slot: store(i, value) stores the
  // value of vertex i. Does not call `use` if the mesh has no array for the slot.
  template <class Use>
  void with_store(Slot slot, const Use& use) {
    IndexedMesh& mesh = file_.mesh;
    VertexLabels& labels = mesh.vertex_spheres;
    // How far the slot is behind `first` in the enumeration: for x, y, z behind x it is 0, 1, 2.
    const auto place = [slot](Slot first) {
      return static_cast<std::size_t>(slot) - static_cast<std::size_t>(first);
    };
    if (slot == Slot::other) return;
    if (slot <= Slot::z) {
      const auto axis = static_cast<int>(place(Slot::x));
      use([&mesh, axis](std::size_t i, double value) { mesh.positions[i][axis] = value; });
    } else if (slot <= Slot::nz) {
      const auto axis = static_cast<int>(place(Slot::nx));
      if (mesh.normals.empty()) return;
      use([&mesh, axis](std::size_t i, double value) {
        mesh.normals[i][axis] = static_cast<float>(value);
      });
    } else if (labels.empty()) {
      return;
    } else if (slot == Slot::atom) {
      use([&labels](std::size_t i, double value) { labels.atoms[i] = sphere_id(value); });
    } else {
      const std::size_t k = place(Slot::sphere2);
      use([&labels, k](std::size_t i, double value) { labels.others[i][k] = sphere_id(value); });
    }
  }

  void set(Slot slot, std::size_t i, double value) {
    with_store(slot, [&](const auto& store) { store(i, value); });
  }

  // Reads an element "face". The list of vertex indices has one of two names; both are common. In a
  // binary file, the fast path reads as many faces as it can, and the loop reads the others.
  void read_faces(const PlyElement& element) {
    std::size_t indices = element.properties.size();  // property number; this value: none
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (property.list_count &&
          (property.name == "vertex_indices" || property.name == "vertex_index"))
        indices = p;
    }
    if (indices == element.properties.size()) {
      file_.notes.push_back("faces without vertex indices were left out");
      return skip(element);
    }
    make_room(file_.mesh.triangles, static_cast<std::size_t>(element.count));
    std::uint64_t start = 0;
    if constexpr (!std::is_same_v<Body, AsciiBody>) start = read_packed_triangles(element);
    for (std::uint64_t f = start; f < element.count; ++f) read_face(element, indices);
  }

  // Reserves memory for `more` triangles: exactly as many for the first element "face". For more
  // such elements the capacity at least doubles, so all triangles are copied in linear time.
  static void make_room(Buffer<Triangle>& triangles, std::size_t more) {
    const std::size_t needed = triangles.size() + more;
    if (needed > triangles.capacity())
      triangles.reserve(std::max(needed, 2 * triangles.capacity()));
  }

  static bool is_atom(const PlyProperty& property) {
    return property.name == "atom" && !property.list_count;
  }

  // Reads one face, whose corners are property number `indices`. Its atom labels all its triangles.
  // The first resize() labels triangles of an earlier element "face" that had no atoms.
  void read_face(const PlyElement& element, std::size_t indices) {
    IndexedMesh& mesh = file_.mesh;
    const std::size_t before = mesh.triangle_count();
    std::optional<SphereId> atom;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (is_atom(property)) {
        atom = sphere_id(body_.number(property.type));
      } else {
        read_face_property(property, p == indices);
      }
    }
    if (!atom) return;
    mesh.triangle_spheres.resize(before, kNoSphere);
    mesh.triangle_spheres.resize(mesh.triangle_count(), *atom);
  }

  // The fast path for the usual layout of binary faces: a list with a count of one byte and indices
  // of 32 bits, then perhaps an atom of 32 bits (`has_atom`), and no other property. The caller has
  // found a list of vertex indices; here it must be property 0. Reads triangles up to the first
  // face of more or fewer corners, and returns how many: 0 in other layouts. Checks no indices.
  std::uint64_t read_packed_triangles(const PlyElement& element) {
    const PlyProperty& list = element.properties[0];
    const auto is_int32 = [](const PlyProperty& property) {  // an integer of 32 bits
      return property.type == PlyScalar::int32 || property.type == PlyScalar::uint32;
    };
    const bool has_atom = element.properties.size() == 2 && is_atom(element.properties[1]) &&
                          is_int32(element.properties[1]);
    if (element.properties.size() != (has_atom ? 2u : 1u)) return 0;
    if (!list.list_count || !is_int32(list) || size_of(*list.list_count) != 1) return 0;
    const std::size_t size = 1 + (has_atom ? 4 : 3) * sizeof(std::uint32_t);
    // The most triangles that fit. No memory is taken for them if the first face is no triangle.
    const std::size_t most = std::min<std::uint64_t>(element.count, body_.bytes_left() / size);
    if (most == 0 || *body_.take(0) != 3) return 0;
    Buffer<Triangle>& triangles = file_.mesh.triangles;
    Buffer<SphereId>& spheres = file_.mesh.triangle_spheres;
    const std::size_t before = triangles.size();
    // The new elements are uninitialised. expect_writing() is a hint; the loop may write fewer.
    triangles.resize(before + most);
    expect_writing(&triangles[before], most);
    if (has_atom) {
      spheres.resize(before, kNoSphere);
      spheres.resize(before + most);
      expect_writing(&spheres[before], most);
    }
    const bool is_signed = has_atom && element.properties[1].type == PlyScalar::int32;
    std::size_t t = before;
    for (; t < before + most; ++t) {
      const char* face = body_.take(size);
      if (*face != 3) {
        body_.rewind_to(face);
        break;
      }
      // The k-th 32-bit number after the count.
      const auto number = [&](std::size_t k) {
        return body_.template load_as<std::uint32_t>(face + 1 + k * sizeof(std::uint32_t));
      };
      triangles[t] = {number(0), number(1), number(2)};
      // An unsigned number is an id as it stands, because kNoSphere is 2^32 - 1.
      if (has_atom)
        spheres[t] = is_signed ? sphere_id(static_cast<std::int32_t>(number(3))) : number(3);
    }
    triangles.resize(t);
    if (has_atom) spheres.resize(t);
    return t - before;
  }

  // Reads one property of any element. If it is the index list of a face (`is_indices`), adds the
  // polygon; Polygons::add() leaves out those of one or two corners. Skips any other property.
  void read_face_property(const PlyProperty& property, bool is_indices) {
    if (!property.list_count) {
      body_.number(property.type);
      return;
    }
    if (!is_indices) return skip_list(property);
    const std::size_t corners = list_size(property);
    if (corners == 0) body_.fail("a face of no corners");
    polygon_.clear();
    for (std::size_t k = 0; k < corners; ++k)
      polygon_.push_back(index(body_.number(property.type)));
    polygons_.add(file_.mesh, polygon_);
  }

  // A number of the file as a vertex index. check_indices() checks later that it exists.
  std::uint32_t index(double value) {
    if (!(value >= 0 && value < static_cast<double>(kMaxVertices) && value == std::floor(value)))
      body_.fail(fmt::format("{} is no vertex index", value));
    return static_cast<std::uint32_t>(value);
  }

  // Reads the count before a list. A count that the rest of the file cannot hold is an error.
  std::size_t list_size(const PlyProperty& property) {
    const double size = body_.number(*property.list_count);
    if (!(size >= 0 && size <= static_cast<double>(body_.max_list_entries(property.type))))
      body_.fail(fmt::format("a list of {} entries is more than the file holds", size));
    return static_cast<std::size_t>(size);
  }

  void skip_list(const PlyProperty& property) {
    const std::size_t size = list_size(property);
    for (std::size_t k = 0; k < size; ++k) body_.number(property.type);
  }

  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;  // no bytes, so the file does not bound the count
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties) read_face_property(property, false);
  }

  // If a file has several elements "face", the last may lack the atoms that an earlier one has. Its
  // triangles get kNoSphere, so that triangle_spheres is either empty or complete.
  void label_all_triangles() {
    IndexedMesh& mesh = file_.mesh;
    if (!mesh.triangle_spheres.empty())
      mesh.triangle_spheres.resize(mesh.triangle_count(), kNoSphere);
  }

  // Faces may stand before the vertices in a file, so indices can only be checked at the end.
  void check_indices() {
    const std::size_t vertices = file_.mesh.vertex_count();
    for (std::size_t t = 0; t < file_.mesh.triangle_count(); ++t)
      for (const std::uint32_t v : file_.mesh.triangles[t])
        if (v >= vertices)
          body_.fail(fmt::format("triangle {} names vertex {}, but there are {}", t, v, vertices));
  }

  Body body_;
  MeshFile file_;
  bool has_vertices_ = false;
  Polygons polygons_;
  std::vector<std::uint32_t> polygon_;  // corners of the face that is being read
};

// Whether the file is a text file. Searches for the "format" line instead of reading the header,
// because line ends of CR alone have to be converted first. The line is the second, unless comments
// precede it; 200 bytes allow for a few of them.
bool is_text(std::string_view bytes) {
  constexpr std::size_t kFirstLines = 200;
  const std::string_view lines = bytes.substr(0, kFirstLines);
  return lines.find("\nformat ascii") != std::string_view::npos ||
         lines.find("\rformat ascii") != std::string_view::npos;
}

}  // namespace

MeshFile read_ply(std::string_view bytes) {
  if (is_text(bytes)) {
    const PlainText text(bytes);
    const PlyHeader header = read_ply_header(text.view());
    return PlyReader(AsciiBody(text.view(), header.size)).read(header);
  }
  const PlyHeader header = read_ply_header(bytes);
  switch (header.encoding) {
    case PlyEncoding::ascii:  // is_text() did not find the "format" line
      return PlyReader(AsciiBody(bytes, header.size)).read(header);
    case PlyEncoding::little_endian:
      return PlyReader(BinaryBody<PlyEncoding::little_endian>(bytes, header.size)).read(header);
    default:
      return PlyReader(BinaryBody<PlyEncoding::big_endian>(bytes, header.size)).read(header);
  }
}

}  // namespace vdwmesh::formats
