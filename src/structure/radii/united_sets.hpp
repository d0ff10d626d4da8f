// The radius sets of united atoms as tables. Internal header of this folder.
//
// A united atom is an atom with the hydrogens that are bonded to it: its radius includes them, so
// structures are measured without hydrogens. The radius depends on the chemistry of the atom, which
// follows from the names of residue and atom.
#pragma once

#include <span>
#include <string_view>

#include "structure/polarity.hpp"

namespace vdwmesh {

// A kind of united atom. An atom gets it only if its element is this one, or if `element` is empty:
// CA is a carbon in an amino acid, but calcium in an ion.
struct AtomType {
  std::string_view name, element;
  double radius;  // Å
  Polarity polarity;
};

// Atoms of some residues. `residues` holds names between blanks; "*" stands for every residue, and
// entries of the residue itself take precedence over it. `atoms` holds groups between commas: names
// of atoms, then the name of their type ("CB CG C4H2, NE N3H1").
struct TypedAtoms {
  std::string_view residues, atoms;
};

struct UnitedSet {
  std::string_view name;  // as RadiusTable::named() knows it
  std::span<const AtomType> types;
  std::span<const TypedAtoms> atoms;
};

// "protor", "naccess" and "oons"; radii.hpp names the papers.
std::span<const UnitedSet> united_sets();

}  // namespace vdwmesh
