// Decodes the columns of BinaryCIF files. Internal header of this folder.
//
// A column is an array that went through a chain of encodings; decoding goes through the chain
// backwards. The encodings are those of the specification,
// https://github.com/molstar/BinaryCIF/blob/master/encoding.md: ByteArray, FixedPoint,
// IntervalQuantization, RunLength, Delta, IntegerPacking and StringArray.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/buffer.hpp"
#include "structure/cif/message_pack.hpp"

namespace vdwmesh {

using Integers = Buffer<std::int32_t>;
using Reals = Buffer<double>;

// Different texts, and which of them each row has; -1: none.
struct TextArray {
  std::vector<std::string_view> texts;
  Integers indices;
};

// The values of one column.
class BinaryColumn {
 public:
  std::variant<Integers, Reals, TextArray> values;
  Integers mask;  // by row 0: given, 1: "." (does not apply), 2: "?" (unknown); empty: all given

  std::size_t size() const;
  bool is_given(std::size_t row) const { return mask.empty() || mask[row] == 0; }
  // The value as a text, empty if it is not given; numbers are written into `scratch`, which must
  // last as long as the text.
  std::string_view text(std::size_t row, std::string& scratch) const;
  // The value as a number; NaN if it is not given or not a number.
  double number(std::size_t row) const;
};

// The column of `rows` values that `column` describes: a map with the keys data and mask. Throws
// FileFormatError, with `where` (file, table and column) before the fault, if anything in it does
// not fit together. Takes memory for the rows alone, whatever sizes the column announces.
BinaryColumn decoded_column(const PackedValue& column, std::size_t rows, const std::string& where);

}  // namespace vdwmesh
