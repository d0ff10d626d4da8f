#include "structure/reader.hpp"

#include <fmt/format.h>

#include <string_view>

#include "core/errors.hpp"
#include "structure/choose.hpp"
#include "structure/formats.hpp"
#include "structure/lines.hpp"
#include "structure/parsed_file.hpp"
#include "structure/samples.hpp"
#include "structure/text_source.hpp"

namespace vdwmesh {
namespace {

RadiusTable radius_table(const std::string& radii) {
  if (radii == "bondi" || radii == "alvarez") return RadiusTable::named(radii);
  if (!std::filesystem::exists(radii))
    throw InvalidInput(
        fmt::format("radii {}: neither a set (bondi, alvarez) nor a file that is "
                    "there",
                    in_quotes(radii)));
  return RadiusTable::from_file(radii);
}

ParsedFile parse(std::string_view text, StructureFormat format, const std::string& path) {
  switch (format) {
    case StructureFormat::pdb:
      return parse_pdb(text, path);
    case StructureFormat::mmcif:
      return parse_mmcif(text, path);
    case StructureFormat::pqr:
      return parse_pqr(text, path);
    case StructureFormat::xyzr:
      return parse_xyzr(text, path);
    case StructureFormat::by_extension:
      break;
  }
  throw InvalidInput(path + ": its format is not known; say --format");
}

ParsedFile parse_file(const std::filesystem::path& path, StructureFormat format) {
  if (format == StructureFormat::by_extension) format = format_of_name(path);
  const Text bytes = read_text(path);
  const std::string name = path == "-" ? "standard input" : path.string();
  return parse(checked_text({bytes.data(), bytes.size()}, format, name), format, name);
}

}  // namespace

Molecule read_structure(const std::filesystem::path& path, const ReadOptions& options) {
  const RadiusTable table = radius_table(options.radii);
  return choose_atoms(parse_file(path, options.format), options, table);
}

Molecule read_sample(const std::string& name, const ReadOptions& options) {
  const std::string_view text = sample_text(name);
  if (text.empty())
    throw InvalidInput(
        fmt::format("there is no sample {}; there are ubiquitin and bpti", in_quotes(name)));
  const RadiusTable table = radius_table(options.radii);
  return choose_atoms(parse_pdb(text, "sample " + name), options, table);
}

}  // namespace vdwmesh
