// ArrayDecoder goes through one chain of encodings and makes a stream of it; the streams of
// integers are in binary_streams.cpp. Integers are kept as 32 bits, as the specification has them,
// and numbers as doubles.
//
// The specification lets a fixed-point or quantised column be kept as floats. Here it becomes
// doubles: n / 10^k is then the double nearest to the decimal number of the mmCIF file, so both
// files hold the same atoms to the last bit.
#include "structure/binary_arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "core/errors.hpp"
#include "structure/binary_streams.hpp"
#include "structure/cif_tokens.hpp"
#include "structure/lines.hpp"

namespace vdwmesh {
namespace {

// The longest chain that is useful has four encodings: FixedPoint, Delta, RunLength and
// IntegerPacking, with a ByteArray at the end.
constexpr std::size_t kLongestChain = 8;

constexpr std::int64_t kSmallest = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t kLargest = std::numeric_limits<std::int32_t>::max();

static_assert(std::endian::native == std::endian::little, "BinaryCIF is little-endian");

using Bytes = std::string_view;

// Numbers: elements of a ByteArray of that many bytes, or a line through integers.
struct RealStream {
  Bytes bytes;
  std::size_t width = 0;  // 4 or 8; 0: of integers
  IntegerSource integers;
  double origin = 0, step = 0, factor = 0;  // factor / integer, or with 0 origin + step * integer
  std::size_t next = 0;

  std::size_t size() const { return integers ? integers->size() : bytes.size() / width; }
  void take(double* to, std::size_t count);
};

struct TextStream {
  std::vector<std::string_view> texts;
  IntegerSource indices;
};

// What a chain of encodings makes of the bytes. Elements are kept apart from other integers,
// because IntegerPacking reads them where they stand.
using Array = std::variant<Bytes, Elements, IntegerSource, RealStream, TextStream>;

template <class T>
void copy_elements(Bytes bytes, double* to, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
    to[i] = static_cast<double>(value);
  }
}

void RealStream::take(double* to, std::size_t count) {
  const Bytes rest = bytes.substr(std::min(next * width, bytes.size()));
  next += count;
  if (width == 4) return copy_elements<float>(rest, to, count);
  if (width == 8) return copy_elements<double>(rest, to, count);
  constexpr std::size_t kSome = 1024;
  std::array<std::int32_t, kSome> some;
  for (std::size_t first = 0; first < count; first += kSome) {
    const std::size_t size = std::min(kSome, count - first);
    integers->take(some.data(), size);
    // Division, not multiplication by 1 / factor, which would round twice.
    if (factor != 0)
      for (std::size_t i = 0; i < size; ++i) to[first + i] = some[i] / factor;
    else
      for (std::size_t i = 0; i < size; ++i) to[first + i] = origin + step * some[i];
  }
}

class ArrayDecoder {
 public:
  // No encoding may announce an array of more than `most` elements.
  ArrayDecoder(std::size_t most, const std::string& where) : most_(most), where_(where) {}

  // Each of these decodes `encoded`, a map with the keys encoding (a list) and data.
  std::variant<IntegerSource, RealStream, TextStream> values(const PackedValue& encoded) const {
    Array array = decode(encoded);
    if (IntegerSource* found = std::get_if<IntegerSource>(&array)) return std::move(*found);
    if (RealStream* found = std::get_if<RealStream>(&array)) return std::move(*found);
    if (TextStream* found = std::get_if<TextStream>(&array)) return std::move(*found);
    if (const Elements* found = std::get_if<Elements>(&array)) return stream_of(*found, where_);
    fail("has no encoding that makes numbers or texts of its bytes");
  }
  IntegerSource integers(const PackedValue& encoded) const { return as_integers(decode(encoded)); }

  [[noreturn]] void fail(const std::string& what) const {
    throw FileFormatError(fmt::format("{}: {}", where_, what));
  }

  PackedValue get(const PackedValue& map, std::string_view key) const {
    const std::optional<PackedValue> found = map.find(key);
    if (!found) fail(fmt::format("{} is not there", key));
    return *found;
  }

 private:
  Bytes bytes_of(const PackedValue& value, std::string_view key) const {
    const std::optional<Bytes> bytes = value.bytes();
    if (!bytes) fail(fmt::format("{} holds no binary data", key));
    return *bytes;
  }

  std::int64_t integer(const PackedValue& map, std::string_view key, std::int64_t least,
                       std::int64_t most) const {
    const std::optional<std::int64_t> value = get(map, key).integer();
    if (!value || *value < least || *value > most)
      fail(fmt::format("{} is not an integer from {} to {}", key, least, most));
    return *value;
  }

  double real(const PackedValue& map, std::string_view key) const {
    const std::optional<double> value = get(map, key).real();
    if (!value || !std::isfinite(*value)) fail(fmt::format("{} is not a finite number", key));
    return *value;
  }

  // The number of elements that the array has before it is encoded.
  std::size_t size(const PackedValue& encoding) const {
    return static_cast<std::size_t>(
        integer(encoding, "srcSize", 0, static_cast<std::int64_t>(most_)));
  }

  IntegerSource as_integers(Array array) const {
    if (IntegerSource* found = std::get_if<IntegerSource>(&array)) return std::move(*found);
    if (const Elements* found = std::get_if<Elements>(&array)) return stream_of(*found, where_);
    fail("numbers with a fraction, texts or bytes stand where integers are needed");
  }

  Array decode(const PackedValue& encoded) const {
    return decode(get(encoded, "encoding"), bytes_of(get(encoded, "data"), "data"));
  }

  Array decode(const PackedValue& encodings, Bytes bytes) const {
    const std::optional<std::vector<PackedValue>> chain = encodings.elements();
    if (!chain || chain->empty() || chain->size() > kLongestChain)
      fail(fmt::format("encoding is not a list of 1 to {} encodings", kLongestChain));
    Array array = bytes;
    for (auto encoding = chain->rbegin(); encoding != chain->rend(); ++encoding)
      array = decode_step(*encoding, std::move(array));
    return array;
  }

  Array decode_step(const PackedValue& encoding, Array array) const {
    const std::string_view kind = get(encoding, "kind").text().value_or("");
    if (Elements* found = std::get_if<Elements>(&array)) {
      if (kind == "IntegerPacking") return unpacked(packing_of(encoding), *found, where_);
      // Differences of 32 bits are the same with a sign as without.
      if (kind == "Delta" && found->type == 6) found->type = 3;
      array = stream_of(*found, where_);
    }
    if (kind == "ByteArray") return byte_array(encoding, of<Bytes>(array, kind));
    if (kind == "StringArray") return string_array(encoding, of<Bytes>(array, kind));
    if (kind == "FixedPoint") return fixed_point(encoding, of<IntegerSource>(array, kind));
    if (kind == "IntervalQuantization") return quantised(encoding, of<IntegerSource>(array, kind));
    if (kind == "RunLength")
      return repeated(size(encoding), std::move(of<IntegerSource>(array, kind)), where_);
    if (kind == "Delta")
      return summed(integer(encoding, "origin", kSmallest, kLargest), source_type(encoding),
                    std::move(of<IntegerSource>(array, kind)), where_);
    if (kind == "IntegerPacking")
      return unpacked(packing_of(encoding), std::move(of<IntegerSource>(array, kind)), where_);
    fail(fmt::format("its encoding {} is not known", in_quotes(kind)));
  }

  // The type of the elements before they were encoded; 0 where it is not given.
  std::int64_t source_type(const PackedValue& encoding) const {
    const std::optional<PackedValue> type = encoding.find("srcType");
    return type ? type->integer().value_or(0) : 0;
  }

  // The array as the kind of array that an encoding needs.
  template <class Needed>
  Needed& of(Array& array, std::string_view kind) const {
    if (Needed* found = std::get_if<Needed>(&array)) return *found;
    fail(fmt::format("{} cannot decode what the encodings behind it give", kind));
  }

  Array byte_array(const PackedValue& encoding, Bytes bytes) const {
    const std::int64_t type = integer(encoding, "type", 1, 33);
    const std::size_t width = type == 1 || type == 4   ? 1
                              : type == 2 || type == 5 ? 2
                              : type == 33             ? 8
                                                       : 4;
    if (bytes.size() % width != 0)
      fail(fmt::format("its {} bytes are not elements of {} bytes each", bytes.size(), width));
    if (type < 7) return Elements{bytes, type};
    if (type < 32) fail(fmt::format("its type {} is not known", type));
    RealStream reals;
    reals.bytes = bytes;
    reals.width = width;
    return reals;
  }

  RealStream fixed_point(const PackedValue& encoding, IntegerSource& array) const {
    RealStream reals;
    reals.factor = real(encoding, "factor");
    if (reals.factor == 0) fail("factor is 0");
    reals.integers = std::move(array);
    return reals;
  }

  // numSteps values from min to max, both included.
  RealStream quantised(const PackedValue& encoding, IntegerSource& array) const {
    RealStream reals;
    const double min = real(encoding, "min"), max = real(encoding, "max");
    const auto steps = static_cast<double>(integer(encoding, "numSteps", 2, kLargest));
    reals.origin = min;
    reals.step = (max - min) / (steps - 1);
    reals.integers = std::move(array);
    return reals;
  }

  Packing packing_of(const PackedValue& encoding) const {
    return {size(encoding), integer(encoding, "byteCount", 1, 2) == 1,
            integer(encoding, "isUnsigned", 0, 1) == 1};
  }

  TextStream string_array(const PackedValue& encoding, Bytes bytes) const {
    const std::optional<std::string_view> all = get(encoding, "stringData").text();
    if (!all) fail("stringData is no text");
    // Offsets count the letters of JavaScript, which are bytes only in ASCII.
    if (std::any_of(all->begin(), all->end(), [](char c) { return (c & 0x80) != 0; }))
      fail("texts that are not ASCII are not read");
    const IntegerSource source = as_integers(
        decode(get(encoding, "offsetEncoding"), bytes_of(get(encoding, "offsets"), "offsets")));
    Integers offsets(source->size());
    source->take(offsets.data(), offsets.size());
    source->finish();
    TextStream stream;
    for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
      const std::int64_t first = offsets[i], last = offsets[i + 1];
      if (first < 0 || last < first || last > static_cast<std::int64_t>(all->size()))
        fail(fmt::format("offset {} of its texts is not in them", i + 1));
      stream.texts.push_back(
          all->substr(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first)));
    }
    stream.indices = as_integers(decode(get(encoding, "dataEncoding"), bytes));
    return stream;
  }

  std::size_t most_;
  const std::string& where_;
};

std::size_t size_of(const IntegerSource& values) { return values->size(); }
std::size_t size_of(const RealStream& values) { return values.size(); }
std::size_t size_of(const TextStream& values) { return values.indices->size(); }

}  // namespace

struct ColumnStream::Parts {
  std::string where;
  std::variant<IntegerSource, RealStream, TextStream> values;
  IntegerSource mask;  // nullptr: all values are given

  // Each of these decodes the next `count` values into what `block` holds of their kind.
  void take(IntegerSource& source, std::size_t count, BinaryColumn& block) const {
    Integers& to = held<Integers>(block);
    to.resize(count);
    source->take(to.data(), count);
  }
  void take(RealStream& source, std::size_t count, BinaryColumn& block) const {
    Reals& to = held<Reals>(block);
    to.resize(count);
    source.take(to.data(), count);
  }
  void take(TextStream& source, std::size_t count, BinaryColumn& block) const {
    TextArray& to = held<TextArray>(block);
    if (to.texts.empty()) to.texts = source.texts;
    to.indices.resize(count);
    source.indices->take(to.indices.data(), count);
    check_indices(to);
  }

  // The array of the kind that the block holds, or is to hold.
  template <class Kind>
  static Kind& held(BinaryColumn& block) {
    if (Kind* const found = std::get_if<Kind>(&block.values)) return *found;
    return block.values.emplace<Kind>();
  }

  // The extremes first, which lanes find: an index that is not one of them need not be looked at.
  void check_indices(const TextArray& array) const {
    std::int32_t least = 0, most = -1;
    for (const std::int32_t index : array.indices) {
      least = std::min(least, index);
      most = std::max(most, index);
    }
    for (const std::int32_t index : {least, most})
      if (index < -1 || index >= static_cast<std::int64_t>(array.texts.size()))
        throw FileFormatError(
            fmt::format("{}: text {} is not one of its {}", where, index, array.texts.size()));
  }
};

ColumnStream::ColumnStream(const PackedValue& column, std::size_t rows, const std::string& where)
    : parts_(std::make_unique<Parts>()) {
  // The longest array that an encoding announces is one of pairs, for RunLength, in which no value
  // is repeated; or the offsets of `rows` different texts. Lengths of other arrays are not
  // announced: their data are in the file.
  const ArrayDecoder decoder(2 * rows + 2, where);
  parts_->where = where;
  parts_->values = decoder.values(decoder.get(column, "data"));
  const std::size_t size =
      std::visit([](const auto& values) { return size_of(values); }, parts_->values);
  if (size != rows) decoder.fail(fmt::format("has {} values in a table of {} rows", size, rows));
  const std::optional<PackedValue> mask = column.find("mask");
  // Some writers give a mask that is null or an empty map to columns that need none.
  if (!mask) return;
  if (mask->kind() == PackedKind::map && !mask->find("encoding") && !mask->find("data")) return;
  parts_->mask = decoder.integers(*mask);
  if (parts_->mask->size() != rows)
    decoder.fail(
        fmt::format("its mask has {} values in a table of {} rows", parts_->mask->size(), rows));
}

ColumnStream::~ColumnStream() = default;
ColumnStream::ColumnStream(ColumnStream&&) noexcept = default;

void ColumnStream::take(std::size_t count, BinaryColumn& block) {
  std::visit([&](auto& values) { parts_->take(values, count, block); }, parts_->values);
  if (!parts_->mask) return;
  block.mask.resize(count);
  parts_->mask->take(block.mask.data(), count);
}

void ColumnStream::finish() {
  if (IntegerSource* const values = std::get_if<IntegerSource>(&parts_->values))
    (*values)->finish();
  if (TextStream* const values = std::get_if<TextStream>(&parts_->values))
    values->indices->finish();
  RealStream* const values = std::get_if<RealStream>(&parts_->values);
  if (values && values->integers) values->integers->finish();
  if (parts_->mask) parts_->mask->finish();
}

std::size_t BinaryColumn::size() const {
  if (const TextArray* array = std::get_if<TextArray>(&values)) return array->indices.size();
  if (const Integers* array = std::get_if<Integers>(&values)) return array->size();
  return std::get<Reals>(values).size();
}

std::string_view BinaryColumn::text(std::size_t row, std::string& scratch) const {
  if (!is_given(row)) return {};
  if (const TextArray* array = std::get_if<TextArray>(&values)) {
    const std::int32_t index = array->indices[row];
    return index < 0 ? std::string_view() : array->texts[static_cast<std::size_t>(index)];
  }
  constexpr std::size_t kLongest = 32;  // letters of a number; doubles have at most 24
  scratch.resize(kLongest);
  char* const first = scratch.data();
  const Integers* const integers = std::get_if<Integers>(&values);
  const auto [end, error] =
      integers ? std::to_chars(first, first + kLongest, (*integers)[row])
               : std::to_chars(first, first + kLongest, std::get<Reals>(values)[row]);
  return {first, end};
}

double BinaryColumn::number(std::size_t row) const {
  if (!is_given(row)) return std::numeric_limits<double>::quiet_NaN();
  if (const Reals* array = std::get_if<Reals>(&values)) return (*array)[row];
  if (const Integers* array = std::get_if<Integers>(&values)) return (*array)[row];
  std::string scratch;
  return cif_number(text(row, scratch));
}

}  // namespace vdwmesh
