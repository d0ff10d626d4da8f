// The reader's pipeline. Each step has its own file:
//   format (formats.cpp) -> text (text_source.cpp) -> check of the content (formats.cpp)
//   -> one parser per format (pdb.cpp, mmcif.cpp, gro.cpp, sphere_lists.cpp, ...) -> range check
//   -> choice of atoms (choose.cpp) -> copies of an assembly (expanded(), there too).
// This file connects the steps. Radii are looked up first, because a mistyped option should be
// reported before a large file is read.
#include "structure/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "core/errors.hpp"
#include "structure/molecule/choose.hpp"
#include "structure/molecule/elements.hpp"
#include "structure/molecule/samples.hpp"
#include "structure/read/formats.hpp"
#include "structure/read/lines.hpp"
#include "structure/read/parsed_file.hpp"
#include "structure/read/text_source.hpp"
#include "structure/read/unexpanded.hpp"

namespace vdwmesh {
namespace {

// Throws if the options ask for what files of the format cannot have: it would be without effect.
void refuse_idle_options(StructureFormat format, const ReadOptions& options,
                         const std::string& path) {
  if ((format == StructureFormat::xyz || format == StructureFormat::sdf) &&
      options.waters == Inclusion::keep)
    throw InvalidInput(path +
                       ": its atoms have no residues, so that no waters are told, and all "
                       "are kept; leave out --waters");
  const bool nameless = format == StructureFormat::xyzr;
  if (!nameless && format != StructureFormat::pqr) return;
  if (!options.radii.empty())
    throw InvalidInput(fmt::format("{}: {} gives the radii; leave out --radii {}", path,
                                   nameless ? "XYZR" : "PQR", options.radii));
  if (nameless && options.waters == Inclusion::keep)
    throw InvalidInput(path + ": the spheres of XYZR have no names; leave out --waters");
  if (nameless && options.hydrogens == Inclusion::drop)
    throw InvalidInput(path + ": the spheres of XYZR have no elements; leave out --no-hydrogens");
  if (nameless && options.hetero_atoms == Inclusion::drop)
    throw InvalidInput(path + ": the spheres of XYZR have no records; leave out --no-hetatm");
}

bool listed(const std::string& text, std::initializer_list<const char*> texts) {
  return std::find(texts.begin(), texts.end(), text) != texts.end();
}

// `limit`: the most bytes of text that are read.
ParsedFile parse(std::string_view text, StructureFormat format, const std::string& path,
                 std::uint64_t limit, Monitor* monitor) {
  switch (format) {
    case StructureFormat::pdb:
      return parse_pdb(text, path, monitor);
    case StructureFormat::mmcif:
      return parse_mmcif(text, path, monitor);
    case StructureFormat::bcif:
      return parse_binary_cif(text, path, limit);
    case StructureFormat::pqr:
      return parse_pqr(text, path);
    case StructureFormat::xyzr:
      return parse_xyzr(text, path);
    case StructureFormat::gro:
      return parse_gro(text, path, monitor);
    case StructureFormat::mol2:
      return parse_mol2(text, path, monitor);
    case StructureFormat::sdf:
      return parse_sdf(text, path, monitor);
    case StructureFormat::xyz:
      return parse_xyz(text, path, monitor);
    case StructureFormat::by_extension:
      break;
  }
  throw InvalidInput(path + ": its format is not known; say --format");
}

// Adds a warning if the last line may hold an atom but has no line end. The file may have been cut
// off there, in the middle of a number: "1.5" could be what is left of "1.53".
void warn_of_unfinished_line(std::string_view text, std::vector<std::string>& warnings) {
  if (text.ends_with('\n') || text.ends_with('\r')) return;
  const std::size_t end = text.find_last_of("\r\n");
  const std::string_view last = trimmed(text.substr(end == std::string_view::npos ? 0 : end + 1));
  if (last.empty() || last[0] == '#' || last.starts_with("END") || last.starts_with("TER")) return;
  warnings.push_back(
      "the last line has no line break: the file may have been cut off, and what it says of the "
      "last atom with it");
}

// The unit of the file in Å. Who leaves it to the format is told where that has others.
double size_of(LengthUnit unit, StructureFormat format, std::vector<std::string>& notes) {
  if (unit == LengthUnit::by_format && format == StructureFormat::gro) {
    notes.push_back("coordinates of .gro are in nm, and became Å; --units says where they are not");
    return 10;
  }
  return unit == LengthUnit::nanometre ? 10 : unit == LengthUnit::picometre ? 0.01 : 1;
}

// Brings the file to Å.
void scale(ParsedFile& file, double factor) {
  if (factor == 1) return;
  for (AtomRecord& atom : file.atoms) {
    atom.position = factor * atom.position;
    atom.radius *= factor;
  }
  file.farthest *= factor;
}

// Throws for the first atom whose position or radius is beyond kFarthest.
void check_ranges(const ParsedFile& file) {
  if (file.farthest <= kFarthest && !file.own_radii) return;
  for (const AtomRecord& atom : file.atoms) {
    if (!is_far(atom.position) && atom.radius <= kFarthest) continue;
    const Vec3d& p = atom.position;
    const double far = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const bool has_rows = file.format.ends_with("cif");
    throw FileFormatError(fmt::format(
        "{}:{}{}{}: {} of {:g} Å; coordinates and radii of up to {:g} Å can be meshed", file.path,
        has_rows ? " row " : "", atom.line, has_rows ? " of _atom_site" : "",
        far <= kFarthest ? "a radius" : "a coordinate", std::max(far, atom.radius), kFarthest));
  }
}

std::string name_of(const std::filesystem::path& path) {
  return path == "-" ? "standard input" : path.string();
}

// The most bytes of text that are read.
std::uint64_t text_limit(const ReadOptions& options) {
  return std::min(kMaxTextBytes, options.memory_limit / kReadingFactor);
}

// `text_within(limit)` returns the text, which has at most `limit` bytes.
template <class TextWithin>
ParsedFile parse_file(const std::filesystem::path& path, StructureFormat format,
                      const ReadOptions& options, const TextWithin& text_within) {
  const std::uint64_t limit = text_limit(options);
  const std::string name = name_of(path);
  refuse_idle_options(format, options, name);
  Text bytes = text_within(limit);
  const std::string_view text = checked_text({bytes.data(), bytes.size()}, format, name);
  advance(options.monitor, 0);
  ParsedFile file = parse(text, format, name, limit, options.monitor);
  scale(file, size_of(options.unit, format, file.notes));
  settle_elements(file);
  advance(options.monitor, 0);
  check_ranges(file);
  if (format != StructureFormat::bcif) warn_of_unfinished_line(text, file.warnings);
  return file;
}

StructureFormat format_of(const std::filesystem::path& path, const ReadOptions& options) {
  return options.format == StructureFormat::by_extension ? format_of_file(path) : options.format;
}

// Whether the options keep every sphere of a list and mark none. Spheres have no names, chains,
// elements or labels, so the options that drop atoms by these have no effect.
bool keep_all_spheres(const ReadOptions& options) {
  return options.unit == LengthUnit::by_format && options.select.empty() &&
         options.measure.empty() && options.groups.empty() &&
         listed(options.model, {"first", "all", "1"}) && options.assembly == "asymmetric" &&
         listed(options.altloc, {"highest", "all"});
}

}  // namespace

UnexpandedMolecule read_unexpanded(const std::filesystem::path& path, const ReadOptions& options) {
  const RadiusTable table = RadiusTable::from_list(radii_or_default(options));
  const auto text_within = [&](std::uint64_t limit) {
    return read_text(path, limit, options.monitor);
  };
  return choose_atoms(parse_file(path, format_of(path, options), options, text_within), options,
                      table);
}

std::optional<SphereText> read_sphere_text(const std::filesystem::path& path,
                                           const ReadOptions& options) {
  const RadiusTable table =
      RadiusTable::from_list(radii_or_default(options));  // throws if there is none of that name
  if (format_of(path, options) != StructureFormat::xyzr || !keep_all_spheres(options)) return {};
  refuse_idle_options(StructureFormat::xyzr, options, name_of(path));
  SphereText spheres;
  spheres.bytes = read_text(path, text_limit(options), options.monitor);
  const std::string name = name_of(path);
  const std::string_view whole(spheres.bytes.data(), spheres.bytes.size());
  const std::string_view text = checked_text(whole, StructureFormat::xyzr, name);
  spheres.first = static_cast<std::size_t>(text.data() - whole.data());
  Molecule& molecule = spheres.molecule;
  molecule.path = name;
  molecule.format = "xyzr";
  molecule.model = options.model == "all" ? "all" : "1";
  molecule.assembly = options.assembly;
  molecule.radius_set = "file";
  warn_of_unfinished_line(text, molecule.warnings);
  return spheres;
}

Molecule read_structure(const std::filesystem::path& path, const ReadOptions& options) {
  return expanded(read_unexpanded(path, options));
}

Molecule read_structure(const std::filesystem::path& name, std::string_view bytes,
                        const ReadOptions& options) {
  const RadiusTable table = RadiusTable::from_list(radii_or_default(options));
  const auto text_within = [&](std::uint64_t limit) {
    return text_of(bytes, name, limit, options.monitor);
  };
  const StructureFormat format =
      options.format == StructureFormat::by_extension ? format_of_name(name) : options.format;
  return expanded(choose_atoms(parse_file(name, format, options, text_within), options, table));
}

Molecule read_sample(const std::string& name, const ReadOptions& options) {
  const std::string_view text = sample_text(name);
  if (text.empty())
    throw InvalidInput(
        fmt::format("there is no sample {}; there are ubiquitin and bpti", in_quotes(name)));
  const RadiusTable table = RadiusTable::from_list(radii_or_default(options));
  return expanded(choose_atoms(parse_pdb(text, "sample " + name), options, table));
}

}  // namespace vdwmesh
