// Selections in words, as "protein and not chain B". Internal header of this folder.
//
//   protein nucleic polymer backbone water ligand hydrogen hetatm all
//                                 kinds of residues and atoms; a polymer is one of the first two, a
//                                 ligand is neither that nor water, backbone are N, CA, C and O
//   chain A B    resn HEM,PO4    name CA    element MG    segid P1
//   resi 10-40 52A -3--1          residue numbers, also 10:40 and "10 to 40"
//   and or not ( )                "not" binds closest, then "and"
//
// Values are separated by blanks, commas or plus signs; * in a name stands for any characters.
// Keywords are taken in any case, and by the names that PyMOL, VMD and MDAnalysis have for them.
#pragma once

#include <functional>
#include <string_view>

#include "structure/molecule/site.hpp"

namespace vdwmesh {

using SiteTest = std::function<bool(const Site&)>;

// Whether the text begins with a keyword of this grammar.
bool is_in_words(std::string_view text);

// The atoms that the text means. Throws InvalidInput, which names the place, for a text that the
// grammar does not have.
SiteTest test_in_words(std::string_view text);

// Throws InvalidInput for what selections of other programs have and these do not: distances, whole
// residues around atoms, and the name that PyMOL puts in front.
void refuse_words_of_others(std::string_view text);

}  // namespace vdwmesh
