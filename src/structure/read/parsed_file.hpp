// The common result of all parsers: all atoms of a file, before any of them is chosen or dropped.
// choose.hpp turns a ParsedFile into a Molecule. Internal header of this folder.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec3.hpp"
#include "structure/molecule.hpp"
#include "structure/read/assembly.hpp"
#include "structure/read/text_source.hpp"
#include "structure/short_text.hpp"

namespace gemmi {
enum class El : unsigned char;
struct Structure;
}  // namespace gemmi

namespace vdwmesh {

// An atom of the file. Its residue, chain and model are gemmi's; hierarchy.hpp finds them by the
// residue's number. gemmi's own atoms take 104 bytes each, these 72. What the choice of atoms
// (choose.hpp) finds out about an atom stands here too, where it takes no memory of its own.
struct AtomRecord {
  Vec3d position;             // Å
  double radius = 0;          // Å; 0 if the format has no radii, until they are assigned
  ShortText name;             // "CA"
  std::int64_t serial = 0;    // the serial number that the file gives
  std::uint32_t line = 0;     // line of the file (CIF and mmCIF: row of the atom table), from 1
  std::uint32_t residue = 0;  // its number in the hierarchy, from 0
  float occupancy = 1;
  float b_iso = 20;  // Å²; temperature factor, for selections; gemmi's where the format has none
  std::int32_t group = kNoGroup;  // as Atom has it; so are `measured` and `polarity`
  gemmi::El element{};
  char altloc = '\0';                 // label of the alternate location; '\0': none
  bool hetero : 1 = false;            // the record is HETATM
  bool element_guessed : 1 = false;   // the file gives no element; it was derived from the names
  bool symbol_overruled : 1 = false;  // the file gives another element than that of the names
  bool is_other_ion : 1 = false;      // symbol and name are of one ion, the residue of another
  bool is_virtual : 1 = false;        // a virtual site, a dummy or an alpha sphere: no atom
  bool measured : 1 = true;
  Polarity polarity = Polarity::unknown;
};
static_assert(sizeof(AtomRecord) == 72);

// Largest absolute value of a coordinate, and largest radius, that is accepted, in Å. Doubles near
// 1e6 are 1.2e-10 apart; for larger numbers they would not keep the digits that meshes promise.
inline constexpr double kFarthest = 1e6;

struct ParsedFile {
  std::shared_ptr<gemmi::Structure> structure;  // models, chains and residues
  AssemblyTables assemblies;
  std::vector<AtomRecord> atoms;  // in the order of the file
  std::string path;               // for messages
  std::string format;             // by Molecule::format
  bool own_radii = false;         // the file gives the radii (PQR, XYZR)
  bool coarse_grained = false;    // atoms are Martini beads: several atoms each, no elements
  // What parsers know of all atoms spares others a look at each of them: the largest absolute value
  // of a coordinate in Å, and whether any atom has an altloc. Those that do not know leave these.
  double farthest = std::numeric_limits<double>::infinity();
  bool has_labels = true;
  bool elements_in_doubt = false;     // settle_elements() has something to decide
  std::vector<std::string> warnings;  // what may be wrong with the file
  std::vector<std::string> notes;     // what was not read, or read otherwise than it stands
};

// One parser per format. `text` is the whole file, checked by checked_text(); `path` serves the
// messages. Positions are in the unit of the format. Each throws FileFormatError; the message is
// one line that names the file and, if there is one, the line or row. A monitor is asked once in
// kLinesPerCheck lines or rows whether to stop.
inline constexpr std::uint32_t kLinesPerCheck = 1u << 13;
ParsedFile parse_pdb(std::string_view text, const std::string& path, Monitor* monitor = nullptr);
ParsedFile parse_mmcif(std::string_view text, const std::string& path, Monitor* monitor = nullptr);
// `limit` bytes of text is the most that is read: a table with more rows than so much text has room
// for throws LimitExceeded.
ParsedFile parse_binary_cif(std::string_view bytes, const std::string& path, std::uint64_t limit);
ParsedFile parse_pqr(std::string_view text, const std::string& path);
ParsedFile parse_xyzr(std::string_view text, const std::string& path);
ParsedFile parse_gro(std::string_view text, const std::string& path, Monitor* monitor = nullptr);
ParsedFile parse_mol2(std::string_view text, const std::string& path, Monitor* monitor = nullptr);
ParsedFile parse_sdf(std::string_view text, const std::string& path, Monitor* monitor = nullptr);
ParsedFile parse_xyz(std::string_view text, const std::string& path, Monitor* monitor = nullptr);

}  // namespace vdwmesh
