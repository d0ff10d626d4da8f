// Sums over atoms, by polarity and by main and side chain, and their quotients. Sums are wide, so
// that their last digits do not depend on how many atoms there are.
#include "analysis/exposure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace vdwmesh {
namespace {

// The atoms that a residue shares with all others.
bool is_main_chain(std::string_view atom_name) {
  constexpr std::array<std::string_view, 5> kMainChain{"N", "CA", "C", "O", "OXT"};
  return std::find(kMainChain.begin(), kMainChain.end(), atom_name) != kMainChain.end();
}

double share(double area, double reference) {
  return reference > 0 ? area / reference : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::optional<AreaByPolarity> area_by_polarity(const Molecule& molecule, const ExactUnion& exact) {
  if (!molecule.has_polarity) return std::nullopt;
  std::array<WideSum, 3> sums;  // by Polarity
  for (std::size_t i = 0; i < molecule.atoms.size(); ++i) {
    const double area = exact.per_sphere[i].area;
    if (!std::isnan(area)) sums[static_cast<std::size_t>(molecule.atoms[i].polarity)].add(area);
  }
  const auto sum = [&sums](Polarity polarity) {
    return sums[static_cast<std::size_t>(polarity)].value();
  };
  return AreaByPolarity{sum(Polarity::polar), sum(Polarity::apolar), sum(Polarity::unknown)};
}

void ResidueSum::add(const Atom& atom, double area) {
  (is_main_chain(atom.name) ? main_chain_ : side_chain_).add(area);
  if (atom.polarity == Polarity::polar) polar_.add(area);
  if (atom.polarity == Polarity::apolar) apolar_.add(area);
  if (atom.polarity == Polarity::unknown) unclassified_.add(area);
}

ResidueAreas ResidueSum::areas() const {
  WideSum total = main_chain_;
  total.add(side_chain_);
  return {total.value(), main_chain_.value(), side_chain_.value(), polar_.value(), apolar_.value()};
}

ResidueAreas relative_areas(const ResidueAreas& areas, const ResidueAreas& reference) {
  return {share(areas.total, reference.total), share(areas.main_chain, reference.main_chain),
          share(areas.side_chain, reference.side_chain), share(areas.polar, reference.polar),
          share(areas.apolar, reference.apolar)};
}

}  // namespace vdwmesh
