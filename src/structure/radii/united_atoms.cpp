// Unpacks the table of a set into a map from residue and atom name to the atom's type. An atom is
// searched under its residue's name and then under the residue "*", which stands for every residue;
// if the set does not have it, the same is done with the standard names of residue and atom.
#include "structure/radii/united_atoms.hpp"

#include <algorithm>
#include <string>

#include "core/errors.hpp"
#include "structure/molecule/standard_names.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

constexpr std::string_view kEveryResidue = "*";

// Removes the next group from `rest` and returns it. Commas separate groups; a group is the names
// of atoms and, last, the name of their type.
std::string_view next_group(std::string_view& rest) {
  const std::size_t end = std::min(rest.find(','), rest.size());
  const std::string_view group = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return group;
}

}  // namespace

UnitedAtoms::UnitedAtoms(const UnitedSet& set) {
  for (const TypedAtoms& entry : set.atoms) {
    for (const std::string_view residue : split_at_blanks(entry.residues)) {
      residues_.insert(residue);
      for (std::string_view rest = entry.atoms; !rest.empty();) {
        std::vector<std::string_view> names = split_at_blanks(next_group(rest));
        const AtomType* type = type_named(set, names.back());
        names.pop_back();
        for (const std::string_view atom : names) types_[{residue, atom}] = type;
      }
    }
  }
}

const AtomType* UnitedAtoms::type_named(const UnitedSet& set, std::string_view name) const {
  const auto found = std::find_if(set.types.begin(), set.types.end(),
                                  [name](const AtomType& type) { return type.name == name; });
  if (found == set.types.end()) throw InternalError("a radius set names a type that it lacks");
  return &*found;
}

const AtomType* UnitedAtoms::exact(std::string_view residue, std::string_view atom,
                                   std::string_view element) const {
  for (const std::string_view name : {residue, kEveryResidue}) {
    const auto found = types_.find({name, atom});
    if (found == types_.end()) continue;
    const AtomType* type = found->second;
    return type->element.empty() || type->element == element ? type : nullptr;
  }
  return nullptr;
}

std::optional<std::pair<const AtomType*, bool>> UnitedAtoms::find(std::string_view residue,
                                                                  std::string_view atom,
                                                                  std::string_view element) const {
  const bool known = residues_.count(residue) != 0;
  if (known) {
    if (const AtomType* type = exact(residue, atom, element)) return std::pair(type, false);
  }
  const std::string residue_name = standard_residue_name(residue);
  for (const std::string& atom_name : {std::string(atom), standard_atom_name(residue_name, atom)}) {
    if (const AtomType* type = exact(residue_name, atom_name, element))
      return std::pair(type, residue_name != residue || atom_name != atom);
  }
  return std::nullopt;
}

}  // namespace vdwmesh
