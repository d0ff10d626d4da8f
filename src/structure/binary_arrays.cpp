// ArrayDecoder goes through one chain of encodings. Integers are kept as 32 bits, as the
// specification has them, and numbers as doubles.
//
// The specification lets a fixed-point or quantised column be kept as floats. Here it becomes
// doubles: n / 10^k is then the double nearest to the decimal number of the mmCIF file, so both
// files hold the same atoms to the last bit.
#include "structure/binary_arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "core/errors.hpp"
#include "structure/cif_tokens.hpp"
#include "structure/lines.hpp"

namespace vdwmesh {
namespace {

// The longest chain that is useful has four encodings: FixedPoint, Delta, RunLength and
// IntegerPacking, with a ByteArray at the end.
constexpr std::size_t kLongestChain = 8;

constexpr std::int64_t kSmallest = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t kLargest = std::numeric_limits<std::int32_t>::max();

using Bytes = std::string_view;
using Array = std::variant<Bytes, Integers, Reals, TextArray>;

static_assert(std::endian::native == std::endian::little, "BinaryCIF is little-endian");

// The elements of type T in the bytes, as elements of type To.
template <class T, class To>
Buffer<To> elements_of(Bytes bytes) {
  Buffer<To> values(bytes.size() / sizeof(T));
  for (std::size_t i = 0; i < values.size(); ++i) {
    T value;
    std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
    values[i] = static_cast<To>(value);
  }
  return values;
}

// The elements of IntegerPacking become values: each is the sum of the elements up to the first
// that is not at a limit of its type.
class Unpacking {
 public:
  static constexpr std::size_t kBlock = 32;

  Unpacking(std::int32_t lower, std::int32_t upper) : lower_(lower), upper_(upper) {}

  // Takes a block of elements, and writes at most kBlock values to `next`, whose end it returns.
  // Returns null, and has taken none, if a sum has more than 32 bits.
  std::int32_t* take_block(const std::int32_t* block, std::int32_t* next) {
    if (!is_open_ && !any_at_limit(block)) return std::copy_n(block, kBlock, next);
    // Without branches on what is at a limit: the processor could not foresee them.
    std::int64_t sum = is_open_ ? sum_ : 0, wide = 0;
    bool is_open = is_open_;
    for (std::size_t i = 0; i < kBlock; ++i) {
      sum += block[i];
      const auto value = static_cast<std::int32_t>(sum);
      wide |= sum - value;
      *next = value;
      is_open = is_limit(block[i]);
      next += !is_open;
      sum &= -static_cast<std::int64_t>(is_open);
    }
    if (wide != 0) return nullptr;
    sum_ = sum;
    is_open_ = is_open;
    return next;
  }

  // Takes one element and returns the sum so far, which is a value unless is_open().
  std::int64_t take(std::int32_t element) {
    sum_ = element + (is_open_ ? sum_ : 0);
    is_open_ = is_limit(element);
    return sum_;
  }
  // Whether the last element was at a limit.
  bool is_open() const { return is_open_; }

 private:
  bool is_limit(std::int32_t element) const { return (element == upper_) | (element == lower_); }
  bool any_at_limit(const std::int32_t* block) const {
    bool any = false;
    for (std::size_t i = 0; i < kBlock; ++i) any |= is_limit(block[i]);
    return any;
  }

  std::int32_t lower_, upper_;
  std::int64_t sum_ = 0;  // of the elements since the last value
  bool is_open_ = false;
};

class ArrayDecoder {
 public:
  // No encoding may announce an array of more than `most` elements.
  ArrayDecoder(std::size_t most, const std::string& where) : most_(most), where_(where) {}

  // Each of these decodes `encoded`, a map with the keys encoding (a list) and data.
  std::variant<Integers, Reals, TextArray> values(const PackedValue& encoded) const {
    Array array = decode(encoded);
    if (Integers* found = std::get_if<Integers>(&array)) return std::move(*found);
    if (Reals* found = std::get_if<Reals>(&array)) return std::move(*found);
    if (TextArray* found = std::get_if<TextArray>(&array)) return std::move(*found);
    fail("has no encoding that makes numbers or texts of its bytes");
  }
  Integers integers(const PackedValue& encoded) const { return as_integers(decode(encoded)); }

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

  std::int32_t narrow(std::int64_t value) const {
    if (value < kSmallest || value > kLargest)
      fail(fmt::format("the integer {} has more than 32 bits", value));
    return static_cast<std::int32_t>(value);
  }

  Integers as_integers(Array array) const {
    if (Integers* found = std::get_if<Integers>(&array)) return std::move(*found);
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
    if (kind == "ByteArray") return byte_array(encoding, of<Bytes>(array, kind));
    if (kind == "StringArray") return string_array(encoding, of<Bytes>(array, kind));
    if (kind == "FixedPoint") return fixed_point(encoding, of<Integers>(array, kind));
    if (kind == "IntervalQuantization") return quantised(encoding, of<Integers>(array, kind));
    if (kind == "RunLength") return run_length(encoding, of<Integers>(array, kind));
    if (kind == "Delta") return delta(encoding, std::move(of<Integers>(array, kind)));
    if (kind == "IntegerPacking") return integer_packing(encoding, of<Integers>(array, kind));
    fail(fmt::format("its encoding {} is not known", in_quotes(kind)));
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
    switch (type) {
      case 1:
        return elements_of<std::int8_t, std::int32_t>(bytes);
      case 2:
        return elements_of<std::int16_t, std::int32_t>(bytes);
      case 3:
        return elements_of<std::int32_t, std::int32_t>(bytes);
      case 4:
        return elements_of<std::uint8_t, std::int32_t>(bytes);
      case 5:
        return elements_of<std::uint16_t, std::int32_t>(bytes);
      case 6:
        return unsigned_integers(bytes);
      case 32:
        return elements_of<float, double>(bytes);
      case 33:
        return elements_of<double, double>(bytes);
      default:
        fail(fmt::format("its type {} is not known", type));
    }
  }

  // Elements of 32 bits without a sign, of which those above 2^31 - 1 are refused.
  Integers unsigned_integers(Bytes bytes) const {
    const Buffer<std::int64_t> values = elements_of<std::uint32_t, std::int64_t>(bytes);
    Integers narrowed(values.size());
    std::transform(values.begin(), values.end(), narrowed.begin(),
                   [this](std::int64_t value) { return narrow(value); });
    return narrowed;
  }

  // Division, not multiplication by 1 / factor, which would round twice.
  Reals fixed_point(const PackedValue& encoding, const Integers& array) const {
    const double factor = real(encoding, "factor");
    if (factor == 0) fail("factor is 0");
    Reals values(array.size());
    std::transform(array.begin(), array.end(), values.begin(),
                   [factor](std::int32_t value) { return value / factor; });
    return values;
  }

  // numSteps values from min to max, both included.
  Reals quantised(const PackedValue& encoding, const Integers& array) const {
    const double min = real(encoding, "min"), max = real(encoding, "max");
    const auto steps = static_cast<double>(integer(encoding, "numSteps", 2, kLargest));
    const double step = (max - min) / (steps - 1);
    Reals values(array.size());
    std::transform(array.begin(), array.end(), values.begin(),
                   [min, step](std::int32_t value) { return min + step * value; });
    return values;
  }

  // Pairs of a value and the number of times it is repeated.
  Integers run_length(const PackedValue& encoding, const Integers& pairs) const {
    const std::size_t wanted = size(encoding);
    if (pairs.size() % 2 != 0) fail("RunLength has a value without its count");
    Integers values(wanted);
    std::size_t filled = 0;
    for (std::size_t i = 0; i < pairs.size(); i += 2) {
      const std::int32_t value = pairs[i], count = pairs[i + 1];
      if (count < 0 || static_cast<std::size_t>(count) > wanted - filled)
        fail(fmt::format("the counts of RunLength are not those of {} values", wanted));
      std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(filled), count, value);
      filled += static_cast<std::size_t>(count);
    }
    if (filled != wanted) fail(fmt::format("RunLength gives {} values of {}", filled, wanted));
    return values;
  }

  Integers delta(const PackedValue& encoding, Integers array) const {
    std::int64_t sum = integer(encoding, "origin", kSmallest, kLargest);
    for (std::int32_t& value : array) value = narrow(sum += value);
    return array;
  }

  Integers integer_packing(const PackedValue& encoding, const Integers& packed) const {
    const std::size_t wanted = size(encoding);
    const bool is_byte = integer(encoding, "byteCount", 1, 2) == 1;
    const bool is_unsigned = integer(encoding, "isUnsigned", 0, 1) == 1;
    const std::int32_t upper = is_unsigned ? (is_byte ? 0xFF : 0xFFFF) : (is_byte ? 0x7F : 0x7FFF);
    const std::int32_t lower = is_unsigned ? -1 : -upper - 1;  // -1: not the limit of any value
    Unpacking unpacking(lower, upper);
    Integers values(wanted);
    std::size_t filled = 0, i = 0;
    for (; std::min(packed.size() - i, wanted - filled) >= Unpacking::kBlock;
         i += Unpacking::kBlock) {
      const std::int32_t* const end = unpacking.take_block(&packed[i], &values[filled]);
      if (!end) break;  // the next loop finds the element
      filled = static_cast<std::size_t>(end - values.data());
    }
    for (; i < packed.size(); ++i) {
      const std::int32_t value = narrow(unpacking.take(packed[i]));
      if (unpacking.is_open()) continue;
      if (filled == wanted) return values;
      values[filled++] = value;
    }
    if (unpacking.is_open() || filled != wanted)
      fail(fmt::format("IntegerPacking gives not the {} values that it should", wanted));
    return values;
  }

  TextArray string_array(const PackedValue& encoding, Bytes bytes) const {
    const std::optional<std::string_view> all = get(encoding, "stringData").text();
    if (!all) fail("stringData is no text");
    // Offsets count the letters of JavaScript, which are bytes only in ASCII.
    if (std::any_of(all->begin(), all->end(), [](char c) { return (c & 0x80) != 0; }))
      fail("texts that are not ASCII are not read");
    const Integers offsets = as_integers(
        decode(get(encoding, "offsetEncoding"), bytes_of(get(encoding, "offsets"), "offsets")));
    TextArray array;
    for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
      const std::int64_t first = offsets[i], last = offsets[i + 1];
      if (first < 0 || last < first || last > static_cast<std::int64_t>(all->size()))
        fail(fmt::format("offset {} of its texts is not in them", i + 1));
      array.texts.push_back(
          all->substr(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first)));
    }
    array.indices = as_integers(decode(get(encoding, "dataEncoding"), bytes));
    // The extremes first, which lanes find: an index that is not one of them need not be looked at.
    std::int32_t least = 0, most = -1;
    for (const std::int32_t index : array.indices) {
      least = std::min(least, index);
      most = std::max(most, index);
    }
    for (const std::int32_t index : {least, most})
      if (index < -1 || index >= static_cast<std::int64_t>(array.texts.size()))
        fail(fmt::format("text {} is not one of its {}", index, array.texts.size()));
    return array;
  }

  std::size_t most_;
  const std::string& where_;
};

}  // namespace

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

BinaryColumn decode_column(const PackedValue& column, std::size_t rows, const std::string& where) {
  // The longest array that an encoding announces is one of pairs, for RunLength, in which no value
  // is repeated; or the offsets of `rows` different texts. Lengths of other arrays are not
  // announced: their data are in the file.
  const ArrayDecoder decoder(2 * rows + 2, where);
  BinaryColumn decoded;
  decoded.values = decoder.values(decoder.get(column, "data"));
  if (decoded.size() != rows)
    decoder.fail(fmt::format("has {} values in a table of {} rows", decoded.size(), rows));
  if (const std::optional<PackedValue> mask = column.find("mask")) {
    decoded.mask = decoder.integers(*mask);
    if (decoded.mask.size() != rows)
      decoder.fail(
          fmt::format("its mask has {} values in a table of {} rows", decoded.mask.size(), rows));
  }
  return decoded;
}

}  // namespace vdwmesh
