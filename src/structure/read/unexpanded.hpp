// Structures that are read without a record for each of their atoms, for processes that make the
// atoms where they need them: an assembly as the atoms of its file and the maps that copy them, and
// a list of spheres as its text.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "structure/molecule.hpp"
#include "structure/read/assembly.hpp"
#include "structure/read/text_source.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {

// Whether a coordinate is beyond what is accepted (kFarthest), or NaN.
bool is_far(const Vec3d& position);

// A run of atoms of one chain, and how one copy of them is made.
struct ChainCopy {
  std::uint64_t first, count;  // the atoms [first, first + count) of UnexpandedMolecule::molecule
  AffineMap map;
  ShortText chain;        // what the chain of the copy is called
  std::string operators;  // that make the map, for messages
};

struct UnexpandedMolecule {
  Molecule molecule;  // its `atoms` are those of the file that are in use, each once
  // The copies that stand behind each other in the assembly. Empty: there is no assembly, and
  // `molecule` has all atoms already.
  std::vector<ChainCopy> copies;
};

// Of the structure, with the copies.
std::uint64_t count_atoms(const Molecule& molecule, const std::vector<ChainCopy>& copies);
// Reserves memory for that many atoms.
void reserve_atoms(std::size_t atoms, Molecule& molecule);

// What read_structure() reads, before the copies of an assembly are made, and read_structure()'s
// last step. The first function throws what read_structure() throws, but for one failure that the
// second one finds: FileFormatError if an operator moves an atom farther than kFarthest.
UnexpandedMolecule read_unexpanded(const std::filesystem::path& path, const ReadOptions& options);
Molecule expanded(UnexpandedMolecule unexpanded);

// An XYZR file of which every sphere is wanted.
struct SphereText {
  Molecule molecule;      // what read_structure() says of it, without atoms and their numbers
  Text bytes;             // the whole file, unpacked
  std::size_t first = 0;  // where the text begins behind a byte order mark
};

// Reads the text of a file if read_structure() with these options would make an atom of each of its
// spheres. Nothing for other formats, or if an option may drop or mark some atoms. Throws what
// read_structure() throws for the file and its text, but does not look at the lines.
std::optional<SphereText> read_sphere_text(const std::filesystem::path& path,
                                           const ReadOptions& options);

// Pieces of the text, each of whole lines, by which threads and processes share it. They depend on
// nothing but the text.
std::vector<std::string_view> pieces_of_spheres(std::string_view text);

// The number of spheres in a piece. And calls put(centre, radius), in Å, for each of them in the
// order of the lines. Returns false if there is a line that read_structure() would refuse or whose
// sphere it would drop, because its radius is 0; put is not called from there on.
std::uint64_t count_spheres(std::string_view piece);
bool read_spheres(std::string_view piece,
                  const std::function<void(const Vec3d& center, double radius)>& put);

}  // namespace vdwmesh
