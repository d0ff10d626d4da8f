// Reads MessagePack (https://github.com/msgpack/msgpack/blob/master/spec.md), the binary form of
// JSON in which BinaryCIF files stand. Internal header of this folder.
//
// Nothing is copied: texts and binary data are views of the bytes. Counts in the bytes are not
// trusted: no memory is taken for an element before it is met, and the number of elements is
// bounded by the number of bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vdwmesh {

enum class PackedKind : std::uint8_t { nil, integer, real, text, bytes, array, map };

// One element. A boolean is the integer 0 or 1.
struct PackedNode {
  PackedKind kind = PackedKind::nil;
  std::uint32_t end = 0;  // index of the first node behind this one and all that it contains
  std::int64_t integer = 0;
  double real = 0;
  std::string_view view;  // of texts and bytes
};

// A node and all that it contains; lasts as long as its document.
class PackedValue {
 public:
  PackedValue(const std::vector<PackedNode>& nodes, std::uint32_t index)
      : nodes_(&nodes), index_(index) {}

  PackedKind kind() const { return node().kind; }
  std::optional<std::string_view> text() const;
  std::optional<std::string_view> bytes() const;
  // JavaScript writes whole numbers in either form, so a real without a fraction is an integer,
  // too.
  std::optional<std::int64_t> integer() const;
  std::optional<double> real() const;
  // The elements of an array; nothing if it is none.
  std::optional<std::vector<PackedValue>> elements() const;
  // The value of a key in a map; nothing if this is no map or has no such key, or if the value is
  // nil.
  std::optional<PackedValue> find(std::string_view key) const;

 private:
  const PackedNode& node() const { return (*nodes_)[index_]; }

  const std::vector<PackedNode>* nodes_;
  std::uint32_t index_;
};

// The nodes of one document; the first contains all others. Throws FileFormatError if the bytes are
// not one whole document, and if it is nested more than 32 times or has more than 65,536 nodes and
// a quarter of its bytes. BinaryCIF files have some 50 nodes for each column and keep its values as
// binary data, each of which is one node.
std::vector<PackedNode> parse_message_pack(std::string_view bytes, const std::string& path);

}  // namespace vdwmesh
