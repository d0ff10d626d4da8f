// Steps that measure interfaces between chains or chosen groups of atoms.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "interface/interfaces.hpp"
#include "steps/steps.hpp"

namespace vdwmesh::apps {

// What the sides of interfaces are called, and for each atom the number of its side; kNoGroup: it
// is on none.
struct Sides {
  std::vector<std::string> names;
  std::vector<std::int32_t> of_atom;
};

// Smaller losses of an atom are rounding, which is some 1e-13 Å².
inline constexpr double kLeastBurial = 1e-9;

// The chains, in the order of their first atoms. A chain without an id goes by its segment; those
// of several models are told apart.
Sides chains_of(const Molecule& molecule);

// The selections by which the molecule was read or, if there are none, its chains. Throws
// InvalidInput if there are fewer than two.
Sides sides_of(const Molecule& molecule, const std::vector<std::string>& selections);

// What is measured beside the accessible surface: with `fit` on how the shapes of sides fit, from
// so many samples on; with `excluded` what is buried of that surface.
struct InterfaceChoice {
  const DistanceChoice& fit;
  ExactSurface surface;
};

// Measures the interfaces and fills their part of the report: of selections all pairs, of chains
// those that touch. Warns of atoms that clash.
Interfaces measure_interfaces(const Structure& structure, const Sides& sides,
                              const InputOptions& input, const InterfaceChoice& choice,
                              Session& session);

// The figures of atoms, `first` before the others. An atom in several interfaces has the sums over
// them; one on no side buries nothing, and has no area of a side alone.
AtomColumns interface_figures(const Interfaces& found, InterfaceFigure first);

}  // namespace vdwmesh::apps
