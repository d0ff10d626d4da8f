// Decides the element of an atom, by the symbol that the file gives and by names. Internal header
// of this folder.
//
// An atom name alone is ambiguous: "CA" is the alpha carbon of an amino acid, or calcium. The
// residue decides first if its name is known: ions, standard residues (also under the names that
// force fields use), ligands with a metal. Otherwise the column decides in which the name begins,
// if the format has columns and the file respects them.
//
// All functions return gemmi's symbols ("Zn"), as pointers to static strings; "X" means unknown.
#pragma once

#include <cstdint>
#include <string_view>

namespace vdwmesh {

struct AtomRecord;
struct ParsedFile;

// Whether the place of a name tells something: it has the four columns 13-16 of a PDB record, or it
// is a word.
enum class NamePlace : std::uint8_t { columns, word };

// Decides atom.element, which must hold the element of `symbol`, or X if that is none. `symbol` is
// what the file has in its column of elements, or nothing. Where symbol and names contradict each
// other, the names decide in these cases, and atom.symbol_overruled is set:
// - In amino acids, nucleotides and water, an atom has the element by which its name begins: "CA"
//   is no calcium there. Selenium stands for sulphur, and a halogen or metal whose whole symbol
//   begins the name stands too ("CL1" of a modified residue).
// - An atom and a residue that have the same ion's name are that ion ("SOD" of "SOD").
// - A single letter is the rest of a symbol if the name says so: "C" of "CA" in "OEX" is calcium.
//   "C" is chlorine if the name begins with "CL" in column 13, or with "Cl".
// Symbol and name decide together against a residue that has the name of another ion, and
// atom.is_other_ion is set ("NA" of "CL").
// Without a symbol, or with one of no element, the names decide, and atom.element_guessed is set.
// Virtual sites, lone pairs, dummies and alpha spheres are no atoms: atom.is_virtual is set, and
// the element is X. So it is, without a symbol, with a name such as "DC1" where the residue has no
// hydrogen "HC1" (is_deuterium_name()): a dummy of a free-energy calculation, or a Drude particle.
// `symbol` "X" is an atom whose element nobody knows; it stays X.
void read_element(std::string_view symbol, std::string_view name, NamePlace place,
                  std::string_view residue, AtomRecord& atom);

// Decides what takes a look at the whole residue, if file.elements_in_doubt, and adds warnings
// that count the symbols that were overruled, the ions in residues of others, and what is no atom
// because its name begins with D. Drude particles become virtual: they are called as their atom
// with D in front and lie upon it, and no warning counts them. A name such as
// "CA1" or "HF" in column 13 means a light element if the residue has other atoms. Where the
// symbols of the file are the first letters of names, those of ligands are read as names too.
void settle_elements(ParsedFile& file);

// The element from an atom name as it stands in columns 13-16 of a PDB record. An element of two
// letters begins in column 13, and one of a single letter in column 14: "CA  " is calcium, " CA "
// is a carbon. In known residues the columns do not matter, so a name that is shifted is still read
// correctly.
const char* element_of_aligned_name(std::string_view four_columns, std::string_view residue);

// The element from a name without blanks, for formats without fixed columns. A name that begins
// with D is of no element where the residue, if it has a name, has no such deuterium.
const char* element_of_bare_name(std::string_view name, std::string_view residue);

// The symbol in its usual spelling, without a charge: "ZN", "zn" and "Zn2+" become "Zn". Tritium is
// hydrogen. "X" if there is no such element.
const char* element_of_symbol(std::string_view symbol);

// Whether an atom is a bead of the coarse-grained Martini force fields. A bead stands for several
// atoms and has no element. The function recognises only names that no real atom has: the beads of
// amino acids (BB, SC1, ...) in an amino acid, and the first glycerol bead of lipids (GL1). One
// such bead is enough to know that all atoms of the file are beads.
bool is_martini_bead(std::string_view name, std::string_view residue);

}  // namespace vdwmesh
