// Looks up the united atom that an atom is, by the names of residue and atom. Internal header of
// this folder.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "structure/radii/united_sets.hpp"

namespace vdwmesh {

class UnitedAtoms {
 public:
  // `set` must outlive the object.
  explicit UnitedAtoms(const UnitedSet& set);

  // The type, and whether it was found by the standard name of residue or atom instead of the name
  // given. Nothing if the set does not have the atom. Where the set does not know a name, the
  // standard name takes its place (standard_names.hpp).
  std::optional<std::pair<const AtomType*, bool>> find(std::string_view residue,
                                                       std::string_view atom,
                                                       std::string_view element) const;

 private:
  const AtomType* exact(std::string_view residue, std::string_view atom,
                        std::string_view element) const;
  const AtomType* type_named(const UnitedSet& set, std::string_view name) const;

  std::set<std::string_view> residues_;
  std::map<std::pair<std::string_view, std::string_view>, const AtomType*> types_;  // residue, atom
};

}  // namespace vdwmesh
