// Writes what UnionTopology says about its voids.
#include "report/void_table.hpp"

#include <fmt/format.h>

#include "report/atom_names.hpp"
#include "report/csv.hpp"

namespace vdwmesh::apps {
std::string void_table_csv(const Molecule& molecule, const std::vector<Void>& voids) {
  std::string csv = "void,volume,area,center_x,center_y,center_z,clearance,lining_atoms,lining\n";
  for (std::size_t i = 0; i < voids.size(); ++i) {
    const Void& v = voids[i];
    std::string lining;
    for (const SphereId id : v.lining) {
      if (!lining.empty()) lining += ' ';
      lining += name_of_atom(molecule, id);
    }
    csv += fmt::format("{},{},{},{},{},{},{},{},{}\n", i + 1, v.volume, v.area, v.center.x,
                       v.center.y, v.center.z, v.clearance, v.lining.size(), csv_field(lining));
  }
  return csv;
}

}  // namespace vdwmesh::apps
