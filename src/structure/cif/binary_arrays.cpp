// ArrayDecoder goes through one chain of encodings. Each encoding makes a whole array of the one
// behind it. Integers are kept as 32 bits, as the specification has them, and numbers as doubles.
//
// The specification lets a fixed-point or quantised column be kept as floats. Here it becomes
// doubles: n / 10^k is then the double nearest to the decimal number of the mmCIF file, so both
// files hold the same atoms to the last bit.
#include "structure/cif/binary_arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/errors.hpp"
#include "structure/cif/cif_tokens.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

// The longest chain that is useful has four encodings: FixedPoint, Delta, RunLength and
// IntegerPacking, with a ByteArray at the end.
constexpr std::size_t kLongestChain = 8;

constexpr std::int64_t kSmallest = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t kLargest = std::numeric_limits<std::int32_t>::max();

static_assert(std::endian::native == std::endian::little, "BinaryCIF is little-endian");

using Bytes = std::string_view;

// What a chain of encodings makes of the bytes.
using DecodedArray = std::variant<Bytes, Integers, Reals, TextArray>;

// Copies the elements of type T that the bytes are, each as convert() gives it.
template <class T, class Value, class Convert>
void copy_elements(Bytes bytes, Buffer<Value>& to, const Convert& convert) {
  to.resize(bytes.size() / sizeof(T));
  for (std::size_t i = 0; i < to.size(); ++i) {
    T element;
    std::memcpy(&element, bytes.data() + i * sizeof(T), sizeof(T));
    to[i] = convert(element);
  }
}

class ArrayDecoder {
 public:
  // No encoding may announce an array of more than `most` elements.
  ArrayDecoder(std::size_t most, const std::string& where) : most_(most), where_(where) {}

  // Each of these decodes `encoded`, a map with the keys encoding (a list) and data.
  std::variant<Integers, Reals, TextArray> values(const PackedValue& encoded) const {
    DecodedArray array = decode(encoded);
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

  // Throws if the value has more than 32 bits.
  std::int32_t narrow(std::int64_t value) const {
    if (value < kSmallest || value > kLargest)
      fail(fmt::format("the integer {} has more than 32 bits", value));
    return static_cast<std::int32_t>(value);
  }

  Integers as_integers(DecodedArray array) const {
    if (Integers* found = std::get_if<Integers>(&array)) return std::move(*found);
    fail("numbers with a fraction, texts or bytes stand where integers are needed");
  }

  DecodedArray decode(const PackedValue& encoded) const {
    return decode(get(encoded, "encoding"), bytes_of(get(encoded, "data"), "data"));
  }

  DecodedArray decode(const PackedValue& encodings, Bytes bytes) const {
    const std::optional<std::vector<PackedValue>> chain = encodings.elements();
    if (!chain || chain->empty() || chain->size() > kLongestChain)
      fail(fmt::format("encoding is not a list of 1 to {} encodings", kLongestChain));
    DecodedArray array = bytes;
    for (std::size_t i = chain->size(); i-- > 0;) {
      const bool is_delta_next = i > 0 && kind_of((*chain)[i - 1]) == "Delta";
      array = decode_step((*chain)[i], std::move(array), is_delta_next);
    }
    return array;
  }

  static std::string_view kind_of(const PackedValue& encoding) {
    const std::optional<PackedValue> kind = encoding.find("kind");
    return kind ? kind->text().value_or("") : "";
  }

  DecodedArray decode_step(const PackedValue& encoding, DecodedArray array,
                           bool is_delta_next) const {
    get(encoding, "kind");  // throws if there is none
    const std::string_view kind = kind_of(encoding);
    if (kind == "ByteArray") return byte_array(encoding, of<Bytes>(array, kind), is_delta_next);
    if (kind == "StringArray") return string_array(encoding, of<Bytes>(array, kind));
    if (kind == "FixedPoint") return fixed_point(encoding, of<Integers>(array, kind));
    if (kind == "IntervalQuantization") return quantised(encoding, of<Integers>(array, kind));
    if (kind == "RunLength") return repeated(size(encoding), of<Integers>(array, kind));
    if (kind == "Delta") return summed(encoding, std::move(of<Integers>(array, kind)));
    if (kind == "IntegerPacking") return unpacked(encoding, of<Integers>(array, kind));
    fail(fmt::format("its encoding {} is not known", in_quotes(kind)));
  }

  // The array as the kind of array that an encoding needs.
  template <class Needed>
  Needed& of(DecodedArray& array, std::string_view kind) const {
    if (Needed* found = std::get_if<Needed>(&array)) return *found;
    fail(fmt::format("{} cannot decode what the encodings behind it give", kind));
  }

  // `are_differences`: of 32 bits they are the same with a sign as without. Other integers without
  // a sign are refused above 2^31 - 1.
  DecodedArray byte_array(const PackedValue& encoding, Bytes bytes, bool are_differences) const {
    const std::int64_t type = integer(encoding, "type", 1, 33);
    const std::size_t width = type == 1 || type == 4   ? 1
                              : type == 2 || type == 5 ? 2
                              : type == 33             ? 8
                                                       : 4;
    if (bytes.size() % width != 0)
      fail(fmt::format("its {} bytes are not elements of {} bytes each", bytes.size(), width));
    if (type >= 7 && type < 32) fail(fmt::format("its type {} is not known", type));
    if (type >= 32) {
      Reals reals;
      const auto as_double = [](auto element) { return static_cast<double>(element); };
      type == 32 ? copy_elements<float>(bytes, reals, as_double)
                 : copy_elements<double>(bytes, reals, as_double);
      return reals;
    }
    Integers integers;
    const auto as_integer = [](auto element) { return static_cast<std::int32_t>(element); };
    const auto narrowed = [this](std::int64_t element) { return narrow(element); };
    if (type == 1) copy_elements<std::int8_t>(bytes, integers, as_integer);
    if (type == 2) copy_elements<std::int16_t>(bytes, integers, as_integer);
    if (type == 4) copy_elements<std::uint8_t>(bytes, integers, as_integer);
    if (type == 5) copy_elements<std::uint16_t>(bytes, integers, as_integer);
    if (type == 3 || (type == 6 && are_differences))
      copy_elements<std::int32_t>(bytes, integers, as_integer);
    else if (type == 6)
      copy_elements<std::uint32_t>(bytes, integers, narrowed);
    return integers;
  }

  Reals fixed_point(const PackedValue& encoding, const Integers& integers) const {
    const double factor = real(encoding, "factor");
    if (factor == 0) fail("factor is 0");
    Reals reals(integers.size());
    // Division, not multiplication by 1 / factor, which would round twice.
    std::transform(integers.begin(), integers.end(), reals.begin(),
                   [factor](std::int32_t integer) { return integer / factor; });
    return reals;
  }

  // numSteps values from min to max, both included.
  Reals quantised(const PackedValue& encoding, const Integers& integers) const {
    const double min = real(encoding, "min"), max = real(encoding, "max");
    const auto steps = static_cast<double>(integer(encoding, "numSteps", 2, kLargest));
    const double step = (max - min) / (steps - 1);
    Reals reals(integers.size());
    std::transform(integers.begin(), integers.end(), reals.begin(),
                   [min, step](std::int32_t integer) { return min + step * integer; });
    return reals;
  }

  // Pairs of a value and the number of times it is repeated become `size` values.
  Integers repeated(std::size_t size, const Integers& pairs) const {
    if (pairs.size() % 2 != 0) fail("RunLength has a value without its count");
    std::size_t announced = 0;  // before memory is taken for them
    for (std::size_t i = 1; i < pairs.size(); i += 2) {
      if (pairs[i] < 0 || static_cast<std::size_t>(pairs[i]) > size - announced)
        fail(fmt::format("the counts of RunLength are not those of {} values", size));
      announced += static_cast<std::size_t>(pairs[i]);
    }
    if (announced != size) fail(fmt::format("RunLength gives {} values of {}", announced, size));
    Integers values(size);
    std::int32_t* next = values.data();
    for (std::size_t i = 0; i < pairs.size(); i += 2)
      next = std::fill_n(next, static_cast<std::size_t>(pairs[i + 1]), pairs[i]);
    return values;
  }

  // The sums of the origin and all differences so far. Elements without a sign go round: what is
  // above the largest begins again at 0, and below 0 at the largest.
  Integers summed(const PackedValue& encoding, Integers values) const {
    std::int64_t sum = integer(encoding, "origin", kSmallest, kLargest);
    const std::optional<PackedValue> given = encoding.find("srcType");
    const std::int64_t type = given ? given->integer().value_or(0) : 0;
    for (std::int32_t& value : values) {
      sum = wrapped(type, sum + value);
      value = narrow(sum);
    }
    return values;
  }

  // The sum as an integer of this type has it: 127 + 1 is -128 in eight bits with a sign.
  static std::int64_t wrapped(std::int64_t type, std::int64_t sum) {
    switch (type) {
      case 1:
        return static_cast<std::int8_t>(sum);
      case 2:
        return static_cast<std::int16_t>(sum);
      case 3:
        return static_cast<std::int32_t>(sum);
      case 4:
        return static_cast<std::uint8_t>(sum);
      case 5:
        return static_cast<std::uint16_t>(sum);
      case 6:
        return static_cast<std::uint32_t>(sum);
      default:
        return sum;
    }
  }

  // Each value is the sum of the elements up to the first that is not at a limit of its type.
  // Values behind the last are ignored, but there may be no half one.
  Integers unpacked(const PackedValue& encoding, const Integers& elements) const {
    const std::size_t count = size(encoding);
    const bool is_byte = integer(encoding, "byteCount", 1, 2) == 1,
               is_unsigned = integer(encoding, "isUnsigned", 0, 1) == 1;
    const std::int32_t upper = (is_byte ? 0x7F : 0x7FFF) * (is_unsigned ? 2 : 1) + is_unsigned,
                       lower = is_unsigned ? -1 : -upper - 1;  // -1: not the limit of any value
    // Written without a branch on what is at a limit, which the processor could not foresee; so
    // each element writes, the last ones behind the values.
    Integers values(std::min(count, elements.size()) + 1);
    std::size_t made = 0;
    std::int64_t sum = 0;
    bool is_open = false;
    for (std::size_t i = 0; i < elements.size() && made < values.size(); ++i) {
      sum += elements[i];
      values[made] = narrow(sum);
      is_open = (int{elements[i] == upper} | int{elements[i] == lower}) != 0;
      made += !is_open;
      sum &= -static_cast<std::int64_t>(is_open);
    }
    if (made < count || is_open)
      fail(fmt::format("IntegerPacking gives not the {} values that it should", count));
    values.resize(count);
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
    for (const std::int32_t index : array.indices)
      if (index < -1 || index >= static_cast<std::int64_t>(array.texts.size()))
        fail(fmt::format("text {} is not one of its {}", index, array.texts.size()));
    return array;
  }

  std::size_t most_;
  const std::string& where_;
};

}  // namespace

BinaryColumn decoded_column(const PackedValue& column, std::size_t rows, const std::string& where) {
  // The longest array that an encoding announces is one of pairs, for RunLength, in which no value
  // is repeated; or the offsets of `rows` different texts. Lengths of other arrays are not
  // announced: their data are in the file.
  const ArrayDecoder decoder(2 * rows + 2, where);
  BinaryColumn decoded;
  decoded.values = decoder.values(decoder.get(column, "data"));
  if (decoded.size() != rows)
    decoder.fail(fmt::format("has {} values in a table of {} rows", decoded.size(), rows));
  const std::optional<PackedValue> mask = column.find("mask");
  // Some writers give a mask that is null or an empty map to columns that need none.
  if (!mask) return decoded;
  if (mask->kind() == PackedKind::map && !mask->find("encoding") && !mask->find("data"))
    return decoded;
  decoded.mask = decoder.integers(*mask);
  if (decoded.mask.size() != rows)
    decoder.fail(
        fmt::format("its mask has {} values in a table of {} rows", decoded.mask.size(), rows));
  return decoded;
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
