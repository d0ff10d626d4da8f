// Reads XYZ: the number of atoms, a comment, and lines of a symbol or an atomic number and x, y, z
// in Å; and so on for each frame. Extended XYZ keeps to this as long as species and positions are
// its first columns.
#include <fmt/format.h>

#include <gemmi/elem.hpp>
#include <optional>
#include <vector>

#include "structure/plain/atom_lines.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

constexpr std::int64_t kLastElement = 118;

// What the comments and the lines of atoms have that is not read.
struct XyzAccount {
  bool has_lattice = false;
  std::uint32_t first_with_more = 0;  // line; 0: none
};

void read_comment(const NumberedLines& lines, XyzAccount& account) {
  constexpr std::string_view kProperties = "Properties=", kRead = "species:S:1:pos:R:3";
  const std::string_view line = lines.line();
  account.has_lattice |= line.find("Lattice=") != line.npos;
  const std::size_t at = line.find(kProperties);
  if (at == line.npos) return;
  std::string_view properties = line.substr(at + kProperties.size());
  if (properties.starts_with('"')) properties.remove_prefix(1);
  if (!properties.starts_with(kRead))
    lines.refuse(fmt::format("the columns are {}; those that are read begin with {}",
                             in_quotes(properties.substr(0, properties.find(' '))), kRead));
}

void read_atom(const NumberedLines& lines, StructureBuilder& builder, XyzAccount& account) {
  const std::vector<std::string_view> words = split_at_blanks(lines.line());
  if (words.size() < 4)
    lines.refuse(fmt::format("has {} fields; XYZ needs a symbol, x, y and z", words.size()));
  if (words.size() > 4 && account.first_with_more == 0) account.first_with_more = lines.number();
  AtomRecord& atom =
      builder.add(kOnlyResidue, lines.position_in(words[1], words[2], words[3]), lines.number());
  const std::optional<std::int64_t> number = whole_number(words[0]);
  if (!number) return read_symbol(words[0], lines, atom);
  if (*number < 0 || *number > kLastElement)
    lines.refuse(fmt::format("{} is no atomic number", in_quotes(words[0])));
  atom.is_virtual = *number == 0;  // as programs number dummies
  atom.element = static_cast<gemmi::El>(*number);
  atom.name = atom.is_virtual ? "0" : gemmi::element_name(atom.element);
}

}  // namespace

ParsedFile parse_xyz(std::string_view text, const std::string& path, Monitor* monitor) {
  NumberedLines lines(text, path, monitor);
  StructureBuilder builder(path, "xyz");
  XyzAccount account;
  for (int frame = 1; frame == 1 || !lines.is_at_end(); ++frame) {
    const std::uint64_t count =
        lines.count_in(lines.expect("the number of atoms"),
                       frame == 1 ? "the number of atoms" : "the number of atoms of a next frame");
    lines.expect("a comment");
    read_comment(lines, account);
    builder.begin_model(std::to_string(frame));
    for (std::uint64_t i = 0; i < count; ++i) {
      lines.expect(fmt::format("atom {} of {}", i + 1, count));
      read_atom(lines, builder, account);
    }
  }
  if (account.has_lattice)
    builder.file().notes.push_back(
        "the lattice is not applied: molecules that it cuts are measured in pieces");
  if (account.first_with_more > 0)
    builder.file().notes.push_back(fmt::format(
        "columns behind z are not read, the first in line {}", account.first_with_more));
  return builder.finish();
}

}  // namespace vdwmesh
