// The steps of `vdwmesh pockets`, for one structure of many.
#include "verbs/batch_pockets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "batch/molecule_spheres.hpp"
#include "memory_plan.hpp"

namespace vdwmesh::apps {
namespace {

void pockets_into(PocketsRow& row, const NamedStructure& source, const Options& options,
                  const BatchOptions& one) {
  const std::uint64_t limit = one.read.memory_limit;
  const Molecule molecule = read_named_structure(source, one.read);
  describe_input(molecule, row);
  const SphereSet spheres = to_spheres(molecule, one.probe);
  MemoryDemand demand;
  demand.exact = UnionMethod::cgal;
  check_memory_before(demand, spheres, limit);
  const PocketTable table =
      pockets(spheres, {.measures = options.pocket_measures, .memory_limit = limit});
  if (table.face_ties > 0) row.warnings.push_back(fmt::format(kPocketTies, table.face_ties));
  row.voids = static_cast<std::uint64_t>(
      std::ranges::count(table.pockets, PocketKind::enclosed, &Pocket::kind));
  row.measures = options.pocket_measures;
  row.pockets = pocket_report(table, molecule, one.probe, options.pocket_measures);
}

}  // namespace

PocketsRow make_pockets_row(const NamedStructure& structure, const Options& options,
                            const BatchOptions& one) {
  PocketsRow row;
  row.name = structure.name;
  row.content = content_of(structure);
  row.error = refusal_of([&] { pockets_into(row, structure, options, one); });
  return row;
}

}  // namespace vdwmesh::apps
