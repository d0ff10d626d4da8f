// Reads XYZR files, which have one sphere per line: x y z radius.
//
// Lists of spheres may be large, so the lines of XYZR are read on all cores: the text is cut into
// pieces at line ends, the lines and spheres of each are counted, and each piece is read to where
// its first sphere belongs. Which line is at fault does not depend on the pieces: the first one is.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <gemmi/model.hpp>
#include <optional>
#include <utility>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "structure/read/lines.hpp"
#include "structure/read/parsed_file.hpp"
#include "structure/read/unexpanded.hpp"

namespace vdwmesh {
namespace {

[[noreturn]] void refuse(const std::string& path, std::uint32_t line, const std::string& what) {
  throw FileFormatError(fmt::format("{}:{}: {}", path, line, what));
}

// Lines of XYZR that one thread reads at a time.
struct PieceOfLines {
  std::string_view text;
  std::size_t first_line = 0, first_sphere = 0;  // in the file, from 0
  std::size_t faulty_line = kNoLine;             // the first of its lines that is at fault, from 0
  static constexpr std::size_t kNoLine = ~std::size_t{0};
};

std::vector<PieceOfLines> cut(std::string_view text) {
  std::vector<PieceOfLines> pieces;
  for (const std::string_view piece : pieces_of_spheres(text)) pieces.push_back({piece});
  return pieces;
}

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

std::string_view without_comment(std::string_view line) { return line.substr(0, line.find('#')); }

// Moves the next word from the front of the line; empty behind the last one.
std::string_view next_word(std::string_view& line) {
  std::size_t first = 0;
  while (first < line.size() && is_blank(line[first])) ++first;
  std::size_t last = first;
  while (last < line.size() && !is_blank(line[last])) ++last;
  const std::string_view word = line.substr(first, last - first);
  line.remove_prefix(last);
  return word;
}

// Reads a sphere from a line without a comment. False if the line is at fault.
bool take_sphere(std::string_view line, AtomRecord& record) {
  std::array<double, 4> values{};
  for (double& value : values) {
    const std::optional<double> number = finite_number(next_word(line));
    if (!number) return false;
    value = *number;
  }
  record.position = {values[0], values[1], values[2]};
  record.radius = values[3];
  return record.radius >= 0;
}

// Calls visit(index, line) for each line with a sphere, with its index in the piece and without its
// comment. Returns the number of all lines.
template <class Visit>
std::size_t for_each_sphere(std::string_view piece, const Visit& visit) {
  std::size_t count = 0;
  for (std::string_view line; next_line(piece, line); ++count) {
    line = without_comment(line);
    if (!std::all_of(line.begin(), line.end(), is_blank)) visit(count, line);
  }
  return count;
}

// Throws, and says what is wrong with the line.
[[noreturn]] void refuse_sphere(std::string_view text, std::size_t index, const std::string& path) {
  std::string_view line;
  for (std::size_t i = 0; i <= index; ++i) next_line(text, line);
  const auto number = static_cast<std::uint32_t>(index + 1);
  const std::vector<std::string_view> fields = split_at_blanks(without_comment(line));
  if (fields.size() < 4)
    refuse(path, number, fmt::format("has {} fields; XYZR needs x y z radius", fields.size()));
  static constexpr std::array<std::string_view, 4> kNames{"x", "y", "z", "the radius"};
  double value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = number_or_refuse(fields[i], kNames[i], path, number);
  if (value < 0)
    refuse(path, number, fmt::format("the radius is {}; it cannot be negative", value));
  throw InternalError("a line of XYZR was at fault, and is not when it is read again");
}

// Counts the lines and spheres of the pieces, so that each knows its first ones. Returns the number
// of spheres.
std::size_t number_pieces(std::vector<PieceOfLines>& pieces) {
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&pieces](std::size_t i) {
    std::size_t spheres = 0;
    const auto count = [&spheres](std::size_t, std::string_view) { ++spheres; };
    pieces[i].first_line = for_each_sphere(pieces[i].text, count);
    pieces[i].first_sphere = spheres;
  });
  std::size_t lines = 0, spheres = 0;
  for (PieceOfLines& piece : pieces) {
    lines += std::exchange(piece.first_line, lines);
    spheres += std::exchange(piece.first_sphere, spheres);
  }
  return spheres;
}

// Fills the records of the spheres in the piece, and notes the first line that is at fault.
void read_piece(PieceOfLines& piece, std::vector<AtomRecord>& atoms) {
  std::size_t next = piece.first_sphere;
  for_each_sphere(piece.text, [&](std::size_t index, std::string_view line) {
    const std::size_t in_file = piece.first_line + index;
    AtomRecord& record = atoms[next++];
    record.line = static_cast<std::uint32_t>(in_file + 1);
    record.serial = static_cast<std::int64_t>(next);
    if (!take_sphere(line, record)) piece.faulty_line = std::min(piece.faulty_line, in_file);
  });
}

// Throws if a line of the first piece is at fault. A file of something else shows it here mostly,
// before records are made for all of its lines: these take 72 bytes each, and a line may have two.
void check_first(const PieceOfLines& piece, std::string_view text, const std::string& path) {
  std::size_t faulty = PieceOfLines::kNoLine;
  for_each_sphere(piece.text, [&](std::size_t index, std::string_view line) {
    AtomRecord record;
    if (faulty == PieceOfLines::kNoLine && !take_sphere(line, record)) faulty = index;
  });
  if (faulty != PieceOfLines::kNoLine) refuse_sphere(text, faulty, path);
}

}  // namespace

// Cuts the text behind line feeds. A text without them is one piece.
std::vector<std::string_view> pieces_of_spheres(std::string_view text) {
  constexpr std::size_t kLength = std::size_t{1} << 18;  // bytes
  std::vector<std::string_view> pieces;
  while (!text.empty()) {
    const std::size_t feed = text.find('\n', std::min(kLength, text.size() - 1));
    const std::size_t length = feed == text.npos ? text.size() : feed + 1;
    pieces.push_back(text.substr(0, length));
    text.remove_prefix(length);
  }
  return pieces;
}

std::uint64_t count_spheres(std::string_view piece) {
  std::uint64_t spheres = 0;
  for_each_sphere(piece, [&spheres](std::size_t, std::string_view) { ++spheres; });
  return spheres;
}

bool read_spheres(std::string_view piece, const std::function<void(const Vec3d&, double)>& put) {
  bool is_sound = true;
  for_each_sphere(piece, [&](std::size_t, std::string_view line) {
    AtomRecord record;
    is_sound = is_sound && take_sphere(line, record) && record.radius > 0 &&
               record.radius <= kFarthest && !is_far(record.position);
    if (is_sound) put(record.position, record.radius);
  });
  return is_sound;
}

ParsedFile parse_xyzr(std::string_view text, const std::string& path) {
  ParsedFile file;
  file.path = path;
  file.format = "xyzr";
  file.own_radii = true;
  file.structure = std::make_shared<gemmi::Structure>();
  file.structure->models.emplace_back("1");
  file.structure->models.back().chains.emplace_back("");
  file.structure->models.back().chains.back().residues.emplace_back().het_flag = 'A';
  std::vector<PieceOfLines> pieces = cut(text);
  if (pieces.size() > 1) check_first(pieces.front(), text, path);  // one piece is read at once
  const std::size_t count = number_pieces(pieces);
  if (count == 0)
    throw FileFormatError(path + ": has no line with x y z radius, so there is nothing to mesh");
  std::vector<AtomRecord>& atoms = file.atoms;
  atoms.reserve(count);
  advise_large_pages(atoms.data(), count);
  atoms.resize(count);
  tbb::parallel_for(std::size_t{0}, pieces.size(),
                    [&](std::size_t i) { read_piece(pieces[i], atoms); });
  for (const PieceOfLines& piece : pieces)
    if (piece.faulty_line != PieceOfLines::kNoLine) refuse_sphere(text, piece.faulty_line, path);
  return file;
}

}  // namespace vdwmesh
