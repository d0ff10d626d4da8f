// The balls of a molecule.
#pragma once

#include <optional>
#include <vector>

#include "spheres/sphere_set.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh {

// One ball for each atom, in their order, grown by the probe (Å). Throws InvalidInput, naming the
// first atom whose radius would not be positive.
SphereSet to_spheres(const Molecule& molecule, double probe);

// The spheres that ReadOptions::measure chose; nothing if all of them are measured.
std::optional<std::vector<SphereId>> measured_spheres(const Molecule& molecule);

}  // namespace vdwmesh
