// Structure files -> Molecule: PDB, mmCIF, PQR, XYZR, each also gzipped, and standard input.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "structure/molecule.hpp"

namespace vdwmesh {

enum class StructureFormat { by_extension, pdb, mmcif, pqr, xyzr };
enum class Inclusion { keep, drop };

struct ReadOptions {
  StructureFormat format = StructureFormat::by_extension;
  std::string model = "first";          // "first", "all", or a model number
  std::string assembly = "asymmetric";  // or the name of a biological assembly of the file
  std::string select;                   // gemmi selection, applied after the water rule; "" = all
  Inclusion waters = Inclusion::drop;
  Inclusion hydrogens = Inclusion::keep;
  Inclusion hetero_atoms = Inclusion::keep;  // HETATM records
  std::string altloc = "highest";            // highest mean occupancy per residue, or a label
  std::string radii = "bondi";               // "bondi", "alvarez", or the path of a radius file
};

// Reads `path`; "-" is standard input and needs a format. Atoms keep the order of the file.
// Throws FileFormatError (cannot be opened or understood; names file and line where known) and
// InvalidInput (no atom left: says what dropped them; unknown radius: names the atom; unknown
// model, assembly or label: says which the file has).
Molecule read_structure(const std::filesystem::path& path, const ReadOptions& options = {});

// One of the samples built into the library: "ubiquitin" (1UBQ) or "bpti".
Molecule read_sample(const std::string& name, const ReadOptions& options = {});

}  // namespace vdwmesh
