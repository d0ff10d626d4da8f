// What every parser makes of a file, before any choice is made. Inside the room only.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "structure/assembly.hpp"
#include "structure/text_source.hpp"

namespace gemmi {
struct Structure;
}

namespace vdwmesh {

// What gemmi's atom cannot hold. gemmi's `serial` is the index of the atom in the file, so it leads
// here, and sorting by it restores the order of the file.
struct AtomRecord {
  std::int64_t serial = 0;       // as the file numbers it
  std::uint32_t line = 0;        // line of the file (mmCIF: row of its atom table), from 1
  bool hetero = false;           // HETATM
  bool element_guessed = false;  // from its name, because the file does not give it
  double radius = 0;             // Å, where the file gives it
};

// Beyond this, in Å, doubles no longer keep the digits that meshes are promised to.
inline constexpr double kFarthest = 1e6;

struct ParsedFile {
  std::shared_ptr<gemmi::Structure> structure;
  AssemblyTables assemblies;
  std::vector<AtomRecord> atoms;
  std::string path;
  std::string format;
  bool own_radii = false;
  bool coarse_grained = false;        // its atoms are beads of several atoms each, without elements
  std::vector<std::string> warnings;  // what may be wrong with the file
};

// Each throws FileFormatError, one line that names the file and the line or row.
ParsedFile parse_pdb(std::string_view text, const std::string& path);
ParsedFile parse_mmcif(std::string_view text, const std::string& path);
ParsedFile parse_pqr(std::string_view text, const std::string& path);
ParsedFile parse_xyzr(std::string_view text, const std::string& path);

}  // namespace vdwmesh
