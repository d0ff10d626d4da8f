// Structure files -> Molecule: PDB, mmCIF, PQR, XYZR, each also gzipped, and standard input; CIF of
// small molecules as its asymmetric unit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "structure/molecule.hpp"

namespace vdwmesh {

enum class StructureFormat { by_extension, pdb, mmcif, pqr, xyzr };
// Reading takes up to this many times the bytes of the unpacked text.
inline constexpr std::uint64_t kReadingFactor = 12;

enum class Inclusion { keep, drop };

// What is taken from the file. Atoms are dropped in this order, each counted once: models, waters,
// hydrogens, HETATM, alternate locations, selection, radii of zero, not in the assembly.
struct ReadOptions {
  StructureFormat format = StructureFormat::by_extension;
  std::string model = "first";          // "first", "all", or a model number
  std::string assembly = "asymmetric";  // or the name of a biological assembly of the file
  std::string select;                   // gemmi selection, applied after the water rule; "" = all
  Inclusion waters = Inclusion::drop;
  Inclusion hydrogens = Inclusion::keep;     // deuterium counts as hydrogen
  Inclusion hetero_atoms = Inclusion::keep;  // HETATM records
  // "highest": one label per residue, that of highest mean occupancy (ties: first in the file),
  // likewise where several residues share a place, and atoms that this label lacks from the next
  // that has them; or a label; or "all", which keeps every one.
  std::string altloc = "highest";
  std::uint64_t memory_limit = ~std::uint64_t{0};  // bytes; a text of more than a part of it is
                                                   // refused, kReadingFactor
  std::string radii = "bondi";  // "bondi", "alvarez", or the path of a radius file; PQR and XYZR
                                // have their own
};

// Reads `path`; "-" is standard input and needs a format. Gzip is told by the first bytes. Atoms
// keep the order of the file; an assembly is copy after copy, chains named A1, A2, ...
// Throws FileFormatError (cannot be opened or understood; names file and line where known),
// LimitExceeded (more than 2 GiB of text, or than the memory allows) and InvalidInput (no atom
// left: says what dropped them; unknown radius: names the atom; unknown model, assembly or label:
// says which the file has).
Molecule read_structure(const std::filesystem::path& path, const ReadOptions& options = {});

// One of the samples built into the library: "ubiquitin" (1UBQ) or "bpti".
Molecule read_sample(const std::string& name, const ReadOptions& options = {});

}  // namespace vdwmesh
