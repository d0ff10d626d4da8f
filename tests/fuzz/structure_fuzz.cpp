// A structure reader on any bytes. VDWMESH_FUZZ_FORMAT names the format.
#include "fuzz/memory_file.hpp"
#include "fuzz/molecule_checks.hpp"
#include "structure/reader.hpp"

namespace vdwmesh::fuzz {
namespace {

ReadOptions everything() {
  ReadOptions options;
  options.model = "all";
  options.altloc = "all";
  options.waters = Inclusion::keep;
  return options;
}

ReadOptions little() {
  ReadOptions options;
  options.assembly = std::string(1, '1');  // GCC 12 warns of a literal
  options.hydrogens = Inclusion::drop;
  options.hetero_atoms = Inclusion::drop;
  options.radii = "alvarez";
  return options;
}

void read(const MemoryFile& file, ReadOptions options) {
  options.format = StructureFormat::VDWMESH_FUZZ_FORMAT;
  // Formats with radii of their own refuse others, and one without names cannot tell waters.
  const bool nameless = options.format == StructureFormat::xyzr;
  if (nameless || options.format == StructureFormat::pqr) options.radii.clear();
  if (nameless) options.hydrogens = options.hetero_atoms = Inclusion::keep;
  if (nameless || options.format == StructureFormat::xyz || options.format == StructureFormat::sdf)
    options.waters = Inclusion::drop;
  allow_refusal([&] { check_molecule(read_structure(file.path(), options)); });
}

}  // namespace

void run_input(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(as_text(data, size));
  read(file, {});
  read(file, everything());
  read(file, little());
}

}  // namespace vdwmesh::fuzz
