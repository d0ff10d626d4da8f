// Reads structure files into a Molecule. Formats: PDB, mmCIF, BinaryCIF, PQR, XYZR, GRO, MOL2, SDF
// and XYZ, each also gzipped, from a file or from standard input. A CIF file of a small molecule is
// read too, as its asymmetric unit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/monitor.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh {

enum class StructureFormat { by_extension, pdb, mmcif, bcif, pqr, xyzr, gro, mol2, sdf, xyz };

// Reading takes up to this many times the bytes of the unpacked text: the text itself, the parsed
// atoms and the Molecule exist at the same time. read_structure() refuses texts for which
// ReadOptions::memory_limit is too small. An atom of a BinaryCIF file counts as 40 bytes of text.
inline constexpr std::uint64_t kReadingFactor = 12;

// drop_where_told: dropped, or kept where the format does not tell them from others, which `drop`
// refuses.
enum class Inclusion { keep, drop, drop_where_told };
enum class SharedAtoms { to_last_group, refused };

// What a coordinate of 1 in the file stands for. Formats have one of their own, nm for GRO and Å
// for all others; programs write others into them all the same.
enum class LengthUnit { by_format, angstrom, nanometre, picometre };

// Which atoms are taken from the file, and which radii they get. The options drop atoms in this
// order: model, waters, virtual sites, hydrogens, HETATM records, alternate locations, selection,
// radii of zero, chains that are not in the assembly. An atom is counted for the first reason that
// drops it.
struct ReadOptions {
  StructureFormat format = StructureFormat::by_extension;
  LengthUnit unit = LengthUnit::by_format;
  std::string model = "first";          // "first", "all", or a model number
  std::string assembly = "asymmetric";  // or the name of a biological assembly of the file
  // Selection in gemmi's syntax ("A/10-40/CA") or in words ("chain A and not hydrogen"); "" = all.
  std::string select;
  // Selection of the atoms to be measured, as `select`; "" = all. It drops no atom: the others stay
  // to cover these, with Atom::measured false. Chains are called as in the file, so that in an
  // assembly all copies of a selected atom are measured.
  std::string measure;
  // Selections that divide the atoms into groups, as `select`; Atom::group says which is whose.
  // An atom of several groups belongs to the last one, or is refused.
  std::vector<std::string> groups;
  SharedAtoms shared_atoms = SharedAtoms::to_last_group;
  Inclusion waters = Inclusion::drop;
  Inclusion hydrogens = Inclusion::keep;     // deuterium counts as hydrogen
  Inclusion hetero_atoms = Inclusion::keep;  // HETATM records
  // Which alternate locations (conformations of one residue, each with a label) are kept.
  // "highest": in every residue the label of highest mean occupancy; the first label in the file
  //   wins ties. If several residues share one sequence number, the same rule chooses among them.
  //   Atoms that the chosen label lacks come from the next label that has them.
  // A label, such as "B": the atoms of this label where there is one, and "highest" elsewhere.
  // "all": every atom, so conformations overlap.
  // Atoms without a label are kept, unless they are a partial copy of a labelled atom.
  std::string altloc = "highest";
  // Bytes. Texts above memory_limit / kReadingFactor are refused, and so are assemblies whose atoms
  // take more than the limit.
  std::uint64_t memory_limit = ~std::uint64_t{0};
  // As RadiusTable::from_list() takes it: a set of RadiusTable::names(), the path of a radius file,
  // or several with commas. Empty: the radii that PQR and XYZR files bring, which go with no
  // others, and "bondi" for other files. Sets of united atoms drop the hydrogens, as part of the
  // atoms that they are bonded to.
  std::string radii;
  // Asked now and then whether to stop.
  Monitor* monitor = nullptr;
};

inline std::string radii_or_default(const ReadOptions& options) {
  return options.radii.empty() ? "bondi" : options.radii;
}

// Whether the extension of the name is that of a structure file that is read; ".gz" behind it does
// not matter.
bool has_structure_extension(const std::filesystem::path& name);

// Reads the file `path`; "-" is standard input, which needs an explicit format. Gzipped data are
// recognised by their first bytes. Atoms keep the order of the file. An assembly lists one copy
// after the other; the copies of chain A are named A1, A2, ... Throws FileFormatError if the file
// cannot be opened or understood (the message names the file, and the line if there is one),
// LimitExceeded if the text is longer than 2 GiB or than the memory limit allows, and InvalidInput
// if the options do not suit the file: no atom is left or none to be measured, a
// group has none or shares one that it may not, an atom has no known
// radius, or the file lacks the model, assembly or label; and Cancelled.
Molecule read_structure(const std::filesystem::path& path, const ReadOptions& options = {});

// The same for the bytes of a file that are in memory, plain or gzipped. `name` stands for the
// path: in messages, and its extension for the format.
Molecule read_structure(const std::filesystem::path& name, std::string_view bytes,
                        const ReadOptions& options);

// Reads a sample that is built into the library: "ubiquitin" (PDB entry 1UBQ) or "bpti".
Molecule read_sample(const std::string& name, const ReadOptions& options = {});

}  // namespace vdwmesh
