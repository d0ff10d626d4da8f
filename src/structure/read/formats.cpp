// Two independent tests, both before any parsing. format_of_name() looks at the extension only.
// checked_text() looks at the content: magic numbers of binary formats, a zero byte anywhere, and
// the first words of the text. Users often hand over a wrong file (an error page saved as .pdb, a
// zip archive), and a parser's message about its first line would not help them.
#include "structure/read/formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

using namespace std::string_view_literals;

constexpr const char* kReadable =
    "read are .pdb .ent .pdbqt .cif .mmcif .bcif .pqr .xyzr .gro .mol2 .sdf .mol .xyz, each also "
    ".gz";

// Extensions in lower case, each with its format.
constexpr std::array kExtensions{
    std::pair{".pdb"sv, StructureFormat::pdb},     std::pair{".ent"sv, StructureFormat::pdb},
    std::pair{".pdbqt"sv, StructureFormat::pdb},   std::pair{".cif"sv, StructureFormat::mmcif},
    std::pair{".mmcif"sv, StructureFormat::mmcif}, std::pair{".bcif"sv, StructureFormat::bcif},
    std::pair{".pqr"sv, StructureFormat::pqr},     std::pair{".xyzr"sv, StructureFormat::xyzr},
    std::pair{".gro"sv, StructureFormat::gro},     std::pair{".mol2"sv, StructureFormat::mol2},
    std::pair{".sdf"sv, StructureFormat::sdf},     std::pair{".mol"sv, StructureFormat::sdf},
    std::pair{".xyz"sv, StructureFormat::xyz},
};

// The first bytes of formats that are often mistaken for structure files, and what to do about
// them. Gzip stands here because the bytes are already unpacked once. The magic number of xz is
// divided in two, because "\xfd7" would be one escape sequence.
constexpr std::array kMagic{
    std::pair{"\x1f\x8b"sv, "gzip data inside gzip data; unpack it once"},
    std::pair{"PK\x03\x04"sv, "a zip archive; unpack it first"},
    std::pair{"BZh"sv, "bzip2 data; unpack it first"},
    std::pair{"\xfd"
              "7zXZ"sv,
              "xz data; unpack it first"},
    std::pair{"\x28\xb5\x2f\xfd"sv, "Zstandard data; unpack it first"},
    std::pair{"\xff\xfe"sv, "UTF-16 text; write it as UTF-8"},
    std::pair{"\xfe\xff"sv, "UTF-16 text; write it as UTF-8"},
    std::pair{"\0\0\x07\xcb"sv, "an XTC trajectory, which has no elements; give the PDB or mmCIF"},
};

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
  throw FileFormatError(fmt::format("{}: {}", path.string(), what));
}

// The last extension in lower case, or the one before ".gz".
std::string extension_of(std::filesystem::path name) {
  if (lower_case(name.extension().string()) == ".gz") name = name.stem();
  return lower_case(name.extension().string());
}

std::optional<StructureFormat> known_format(std::string_view extension) {
  for (const auto& [known, format] : kExtensions)
    if (extension == known) return format;
  return std::nullopt;
}

// Throws if the bytes are packed, or of a format that is no structure file. The magic number of tar
// stands at offset 257.
void refuse_other_formats(std::string_view bytes, const std::filesystem::path& path) {
  for (const auto& [magic, name] : kMagic)
    if (bytes.starts_with(magic)) refuse(path, fmt::format("is {}", name));
  if (bytes.substr(std::min<std::size_t>(bytes.size(), 257), 5) == "ustar")
    refuse(path, "is a tar archive; unpack it first");
}

// BinaryCIF is MessagePack, whose first byte tells what the document is: here a map. The key
// dataBlocks stands behind the few others of that map.
bool is_message_pack_map(std::string_view bytes) {
  const auto first = static_cast<unsigned char>(bytes.empty() ? '\0' : bytes.front());
  return (first & 0xF0U) == 0x80U || first == 0xDEU || first == 0xDFU;
}
bool is_binary_cif(std::string_view bytes) {
  return is_message_pack_map(bytes) && bytes.substr(0, 1000).find("dataBlocks") != bytes.npos;
}

// Throws if the bytes are no text.
void refuse_binary(std::string_view bytes, const std::filesystem::path& path) {
  if (is_binary_cif(bytes))
    refuse(path, "holds BinaryCIF; rename it to .bcif or say --format bcif");
  const std::size_t zero = bytes.find('\0');
  if (zero != std::string_view::npos)
    refuse(path, fmt::format("is not text (a zero byte at offset {}); {}", zero, kReadable));
}

// The first 16 characters, in lower case, of the first line that is neither blank nor a comment.
// Empty if there is no such line.
std::string first_words(std::string_view text) {
  std::string_view line;
  while (next_line(text, line)) {
    line = trimmed(line);
    if (!line.empty() && line[0] != '#') return lower_case(line.substr(0, 16));
  }
  return {};
}

// Whether one of the first 1000 lines is a record that PDB files have and mmCIF files do not. It
// only decides which advice the message gives.
bool has_pdb_records(std::string_view text) {
  std::string_view line;
  for (int i = 0; i < 1000 && next_line(text, line); ++i)
    if (line.starts_with("ATOM  ") || line.starts_with("HETATM") || line.starts_with("HEADER    "))
      return true;
  return false;
}

// Whether the fourth line ends with the version of a molfile, as in each molfile since 1992.
bool is_molfile(std::string_view text) {
  std::string_view line;
  for (int i = 0; i < 4; ++i)
    if (!next_line(text, line)) return false;
  return trimmed(line).ends_with("V2000") || trimmed(line).ends_with("V3000");
}

// Throws if the text is of a format that its own words tell, and not of the one that is asked for.
void refuse_told_format(std::string_view text, std::string_view first, StructureFormat format,
                        const std::filesystem::path& path) {
  // Every mmCIF file begins with a data block, "data_" and its name. No other format that is read
  // begins like this.
  const bool cif = first.starts_with("data_"), mol2 = first.starts_with("@<tripos>");
  if (cif && format != StructureFormat::mmcif)
    refuse(path, "holds mmCIF; rename it to .cif or say --format mmcif");
  if (!cif && format == StructureFormat::mmcif)
    refuse(path, has_pdb_records(text) ? "holds PDB; rename it to .pdb or say --format pdb"
                                       : "is not mmCIF: it does not begin with a data_ block");
  if (mol2 && format != StructureFormat::mol2)
    refuse(path, "holds MOL2; rename it to .mol2 or say --format mol2");
  if (format != StructureFormat::sdf && is_molfile(text))
    refuse(path, "holds a molfile or SDF; rename it to .sdf or say --format sdf");
}

}  // namespace

bool has_structure_extension(const std::filesystem::path& name) {
  return known_format(extension_of(name)).has_value();
}

StructureFormat format_of_name(const std::filesystem::path& path) {
  if (path == "-")
    throw InvalidInput(
        "standard input has no extension; say --format pdb, mmcif, bcif, pqr, xyzr, gro, mol2, sdf "
        "or xyz");
  const std::string extension = extension_of(path);
  if (const auto format = known_format(extension)) return *format;
  if (extension == ".xtc" || extension == ".trr" || extension == ".dcd")
    refuse(
        path,
        fmt::format("is a trajectory ({}), which has no elements; give the structure file, or both "
                    "to be told how the frames are measured",
                    extension));
  refuse(path, fmt::format("its extension {} is not one that is read ({}); or say --format",
                           in_quotes(extension), kReadable));
}

// Who types the name of an entry has no such file, and needs another hint than about its name.
StructureFormat format_of_file(const std::filesystem::path& path) {
  std::error_code error;
  if (path != "-" && !known_format(extension_of(path)) && !std::filesystem::exists(path, error))
    refuse(path, fmt::format("there is no such file; name a structure file ({}), or a built-in "
                             "structure (--sample ubiquitin, --sample bpti)",
                             kReadable));
  if (std::filesystem::is_directory(path, error))
    refuse(path, "is a directory; name one structure file, or give the directory to vdwmesh batch");
  return format_of_name(path);
}

std::string_view checked_text(std::string_view bytes, StructureFormat format,
                              const std::filesystem::path& path) {
  refuse_other_formats(bytes, path);
  if (format == StructureFormat::bcif) {
    if (bytes.empty()) refuse(path, "is empty");
    if (!is_message_pack_map(bytes))
      refuse(path, "is not BinaryCIF: it does not begin with a map in MessagePack");
    return bytes;
  }
  refuse_binary(bytes, path);
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  const std::string first = first_words(bytes);
  if (first.empty()) refuse(path, "is empty");
  if (first[0] == '<') refuse(path, "is a web page or XML; get the file itself, as PDB or mmCIF");
  if (first[0] == '{') refuse(path, "is JSON; get the file as PDB or mmCIF");
  refuse_told_format(bytes, first, format, path);
  return bytes;
}

}  // namespace vdwmesh
