// Which atoms of a file an assembly has, how many in all its copies, and these copies. Internal
// header of this folder.
//
// Atoms are counted before copies are listed. An operator expression of a few characters can stand
// for billions of copies, so the number is checked against the limits first.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "structure/molecule/site.hpp"
#include "structure/read/assembly.hpp"
#include "structure/read/parsed_file.hpp"
#include "structure/read/unexpanded.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {

// Index of the site's atom in the file.
inline std::size_t index_in(const ParsedFile& file, const Site& site) {
  return static_cast<std::size_t>(site.atom - file.atoms.data());
}

// Throws InvalidInput, with the names that there are, if the file has no assembly of this name.
AssemblyRecipe recipe_of(const ParsedFile& file, const std::string& assembly);

// Returns how many atoms the assembly has, and marks in `used`, by index in the file, those of
// `sites` that are in it. The result is a double because it may be huge. It is exact up to 2^53,
// far above the atoms of any molecule, so no assembly within the limits is miscounted.
double count_copies(const AssemblyRecipe& recipe, const ParsedFile& file, const Sites& sites,
                    std::vector<bool>& used);

// Throws LimitExceeded if so many atoms are more than a molecule or the memory limit allows.
void refuse_if_too_many(double atoms, const std::string& path, const ReadOptions& options);

// Model by model, in a model part by part of the recipe, in a part copy by copy. The atoms of the
// molecule have the indices of their sites. Precondition: the sites of a model are consecutive,
// and count_copies() is within the limits.
std::vector<ChainCopy> list_copies(const AssemblyRecipe& recipe, const ParsedFile& file,
                                   const Sites& sites);

}  // namespace vdwmesh
