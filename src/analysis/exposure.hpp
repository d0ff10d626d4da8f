// What users of accessible surfaces ask of the exact areas: the polar and the apolar part, and how
// exposed a residue is beside the same residue in an extended tripeptide.
#pragma once

#include <optional>
#include <string_view>

#include "core/sum.hpp"
#include "measures/exact_union.hpp"
#include "structure/molecule.hpp"
#include "structure/reference_areas.hpp"

namespace vdwmesh {

// Parts of the area of the measured spheres, Å². The third is of atoms that the radius set lacks.
struct AreaByPolarity {
  double polar, apolar, unclassified;
};

// Returns the polar and apolar parts of the exposed area; empty if the radius set of the molecule
// has no polarity. Precondition: sphere i of the union is atom i.
std::optional<AreaByPolarity> area_by_polarity(const Molecule& molecule, const ExactUnion& exact);

// Adds up the areas of atoms, of a residue or more.
class ResidueSum {
 public:
  // `area` in Å².
  void add(const Atom& atom, double area);
  ResidueAreas areas() const;
  double unclassified_area() const { return unclassified_.value(); }  // Å²; of no polarity

 private:
  WideSum main_chain_, side_chain_, polar_, apolar_, unclassified_;
};

// The areas as shares of those of the reference: 1 for a residue that is as exposed as there; it
// may be more. NaN for a part that the reference does not have, such as the side chain of glycine.
ResidueAreas relative_areas(const ResidueAreas& areas, const ResidueAreas& reference);

}  // namespace vdwmesh
