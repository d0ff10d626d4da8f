// Finds the low probes near a low probe: those that may cut its concave patch.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "excluded/probes/accessible_surface.hpp"

namespace vdwmesh::excluded {

// Calls visit(number) for the cell of this number along an axis and for those beside it. Cells are
// numbered by doubles, which no extent of coordinates overflows. Beyond 2^53 one more is the same
// number, which is then visited once.
template <class Visit>
void visit_cells_beside(double home, const Visit& visit) {
  if (home - 1 < home) visit(home - 1);
  visit(home);
  if (home + 1 > home) visit(home + 1);
}

// A grid of cells as wide as the diameter of a probe. The cells are sorted.
class LowProbes {
 public:
  // Takes the low ones of the probes for which included[component] is set.
  LowProbes(const AccessibleSurface& surface, std::span<const std::uint8_t> included);

  // The low probes, ascending.
  const std::vector<std::uint32_t>& list() const { return list_; }

  // Calls visit(probe) for all low probes but `probe` whose balls overlap it, in an order that
  // depends on the places of the probes alone.
  template <class Visit>
  void near(std::uint32_t probe, const Visit& visit) const;

 private:
  using Cell = std::array<double, 3>;  // z, y, x
  struct ListedProbe {
    Cell cell;
    std::uint32_t probe;
  };
  Cell cell_of(const Vec3d& point) const;
  const ListedProbe* first_from(const Cell& cell) const;

  const AccessibleSurface& surface_;
  double width_;
  std::vector<std::uint32_t> list_;
  std::vector<ListedProbe> entries_;
};

template <class Visit>
void LowProbes::near(std::uint32_t probe, const Visit& visit) const {
  const Probe& self = surface_.probes[probe];
  const Cell home = cell_of(self.center);
  visit_cells_beside(home[0], [&](double z) {
    visit_cells_beside(home[1], [&](double y) {
      const Cell last{z, y, home[2] + 1};
      const ListedProbe* const end = entries_.data() + entries_.size();
      for (const ListedProbe* e = first_from({z, y, home[2] - 1}); e != end && e->cell <= last;
           ++e) {
        const Vec3d apart = surface_.between(self, surface_.probes[e->probe]);
        if (e->probe != probe && squared_norm(apart) < width_ * width_) visit(e->probe);
      }
    });
  });
}

}  // namespace vdwmesh::excluded
