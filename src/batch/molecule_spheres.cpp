// The step from atoms to balls. A probe may be negative, as long as it leaves every atom a radius
// above 0.
#include "batch/molecule_spheres.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

std::string label_of(const Atom& atom) {
  return fmt::format("{} {} {} {} (serial {})", atom.chain.view(), atom.residue_name.view(),
                     atom.residue_number.view(), atom.name.view(), atom.serial);
}

}  // namespace

SphereSet to_spheres(const Molecule& molecule, double probe) {
  std::vector<Sphere> spheres;
  spheres.reserve(molecule.atoms.size());
  for (const Atom& atom : molecule.atoms) {
    const double radius = atom.radius + probe;
    if (!(radius > 0)) {
      throw InvalidInput(fmt::format(
          "--probe {}: atom {} of radius {} Å would have {:g} Å; every radius must stay above 0",
          probe, label_of(atom), atom.radius, radius));
    }
    spheres.push_back({atom.position, radius});
  }
  return SphereSet(std::move(spheres));
}

std::optional<std::vector<SphereId>> measured_spheres(const Molecule& molecule) {
  std::vector<SphereId> measured;
  for (std::size_t i = 0; i < molecule.atoms.size(); ++i) {
    if (molecule.atoms[i].measured) measured.push_back(static_cast<SphereId>(i));
  }
  return measured.size() == molecule.atoms.size() ? std::nullopt : std::optional(measured);
}

}  // namespace vdwmesh
