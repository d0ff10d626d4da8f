// Makes the copies of an assembly, which choose.cpp has listed: an atom of the file once for each
// of its copies, moved and with another chain.
#include "structure/read/unexpanded.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "structure/read/parsed_file.hpp"

namespace vdwmesh {
namespace {

// Throws if a copy of an atom is too far away.
void refuse_if_far(const Vec3d& p, const ChainCopy& copy, const Molecule& molecule) {
  if (!is_far(p)) return;
  throw FileFormatError(
      fmt::format("{}: assembly {}: operator {} moves an atom to {:g}, {:g}, {:g} Å; coordinates "
                  "of up to {:g} Å can be meshed",
                  molecule.path, molecule.assembly, copy.operators, p.x, p.y, p.z, kFarthest));
}

}  // namespace

bool is_far(const Vec3d& position) {
  const auto is_near = [](double x) { return std::abs(x) <= kFarthest; };  // false for NaN
  return !(is_near(position.x) && is_near(position.y) && is_near(position.z));
}

void reserve_atoms(std::size_t atoms, Molecule& molecule) {
  molecule.atoms.reserve(atoms);
  advise_large_pages(molecule.atoms.data(), atoms);
}

std::uint64_t count_atoms(const Molecule& molecule, const std::vector<ChainCopy>& copies) {
  if (copies.empty()) return molecule.atoms.size();
  std::uint64_t count = 0;
  for (const ChainCopy& copy : copies) count += copy.count;
  return count;
}

Molecule expanded(UnexpandedMolecule unexpanded) {
  Molecule& molecule = unexpanded.molecule;
  if (unexpanded.copies.empty()) return std::move(molecule);
  const std::uint64_t count = count_atoms(molecule, unexpanded.copies);
  const std::vector<Atom> unit = std::exchange(molecule.atoms, {});
  reserve_atoms(count, molecule);
  for (const ChainCopy& copy : unexpanded.copies)
    for (std::uint64_t i = copy.first; i < copy.first + copy.count; ++i) {
      Atom& atom = molecule.atoms.emplace_back(unit[i]);
      atom.position = copy.map(atom.position);
      atom.chain = copy.chain;
      refuse_if_far(atom.position, copy, molecule);
    }
  return std::move(molecule);
}

}  // namespace vdwmesh
