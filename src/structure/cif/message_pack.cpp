// The library msgpack-cxx walks through the bytes and calls a visitor for each element; its own
// objects are not used, because they take memory for the counts that the bytes announce.
#include "structure/cif/message_pack.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <msgpack.hpp>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kFewNodes = 65536;
constexpr std::size_t kDeepest = 32;  // nested arrays and maps; BinaryCIF needs 12

// Appends a node for each element. A function that returns false ends the parse.
class NodeMaker : public msgpack::null_visitor {
 public:
  // `size` of the document, in bytes.
  explicit NodeMaker(std::size_t size)
      : most_(std::min<std::size_t>(kFewNodes + size / 4,
                                    std::numeric_limits<std::uint32_t>::max() - 1)) {}

  std::vector<PackedNode> nodes;
  std::string fault;  // why the parse was ended; empty: by the library

  bool visit_nil() { return add({}); }
  bool visit_boolean(bool value) { return add_integer(value ? 1 : 0); }
  bool visit_positive_integer(std::uint64_t value) {
    constexpr auto kLargest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    if (value > kLargest) return add_real(static_cast<double>(value));
    return add_integer(static_cast<std::int64_t>(value));
  }
  bool visit_negative_integer(std::int64_t value) { return add_integer(value); }
  bool visit_float32(float value) { return add_real(static_cast<double>(value)); }
  bool visit_float64(double value) { return add_real(value); }
  bool visit_str(const char* data, std::uint32_t size) {
    return add_view(PackedKind::text, data, size);
  }
  bool visit_bin(const char* data, std::uint32_t size) {
    return add_view(PackedKind::bytes, data, size);
  }
  bool visit_ext(const char*, std::uint32_t) { return fail("has an extension type"); }
  bool start_array(std::uint32_t) { return open(PackedKind::array); }
  bool end_array() { return close(); }
  bool start_map(std::uint32_t) { return open(PackedKind::map); }
  bool end_map() { return close(); }

 private:
  bool fail(const char* why) {
    fault = why;
    return false;
  }
  bool add(const PackedNode& node) {
    if (nodes.size() == most_) return fail("has too many small elements");
    nodes.push_back(node);
    nodes.back().end = static_cast<std::uint32_t>(nodes.size());
    return true;
  }
  bool add_integer(std::int64_t value) {
    PackedNode node;
    node.kind = PackedKind::integer;
    node.integer = value;
    return add(node);
  }
  bool add_real(double value) {
    PackedNode node;
    node.kind = PackedKind::real;
    node.real = value;
    return add(node);
  }
  bool add_view(PackedKind kind, const char* data, std::uint32_t size) {
    PackedNode node;
    node.kind = kind;
    node.view = {data, size};
    return add(node);
  }
  bool open(PackedKind kind) {
    if (open_.size() == kDeepest) return fail("is nested too deeply");
    open_.push_back(static_cast<std::uint32_t>(nodes.size()));
    PackedNode node;
    node.kind = kind;
    return add(node);
  }
  bool close() {
    nodes[open_.back()].end = static_cast<std::uint32_t>(nodes.size());
    open_.pop_back();
    return true;
  }

  std::size_t most_;                 // nodes
  std::vector<std::uint32_t> open_;  // the arrays and maps that contain the next element
};

}  // namespace

std::optional<std::string_view> PackedValue::text() const {
  if (kind() != PackedKind::text) return std::nullopt;
  return node().view;
}

std::optional<std::string_view> PackedValue::bytes() const {
  if (kind() != PackedKind::bytes) return std::nullopt;
  return node().view;
}

std::optional<std::int64_t> PackedValue::integer() const {
  if (kind() == PackedKind::integer) return node().integer;
  constexpr double kExact = 9007199254740992;  // 2^53: up to here doubles are exact integers
  const double value = node().real;
  if (kind() != PackedKind::real || !(std::abs(value) <= kExact) || value != std::trunc(value))
    return std::nullopt;
  return static_cast<std::int64_t>(value);
}

std::optional<double> PackedValue::real() const {
  if (kind() == PackedKind::real) return node().real;
  if (kind() == PackedKind::integer) return static_cast<double>(node().integer);
  return std::nullopt;
}

std::optional<std::vector<PackedValue>> PackedValue::elements() const {
  if (kind() != PackedKind::array) return std::nullopt;
  std::vector<PackedValue> found;
  for (std::uint32_t i = index_ + 1; i < node().end; i = (*nodes_)[i].end)
    found.emplace_back(*nodes_, i);
  return found;
}

std::optional<PackedValue> PackedValue::find(std::string_view key) const {
  if (kind() != PackedKind::map) return std::nullopt;
  for (std::uint32_t i = index_ + 1; i < node().end;) {
    const std::uint32_t value = (*nodes_)[i].end;
    if ((*nodes_)[i].kind == PackedKind::text && (*nodes_)[i].view == key) {
      if ((*nodes_)[value].kind == PackedKind::nil) return std::nullopt;
      return PackedValue(*nodes_, value);
    }
    i = (*nodes_)[value].end;
  }
  return std::nullopt;
}

std::vector<PackedNode> parse_message_pack(std::string_view bytes, const std::string& path) {
  NodeMaker maker(bytes.size());
  std::size_t end = 0;
  const bool whole = msgpack::parse(bytes.data(), bytes.size(), end, maker);
  if (!maker.fault.empty())
    throw FileFormatError(fmt::format("{}: {}, which BinaryCIF files have not", path, maker.fault));
  if (!whole)
    throw FileFormatError(
        fmt::format("{}: is damaged or was cut off (no whole MessagePack document)", path));
  if (end != bytes.size())
    throw FileFormatError(
        fmt::format("{}: holds {} bytes after its document", path, bytes.size() - end));
  return std::move(maker.nodes);
}

}  // namespace vdwmesh
