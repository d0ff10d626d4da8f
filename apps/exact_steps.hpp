// Steps that measure the union of the spheres exactly, and set a mesh beside it. Each fills its
// part of the report.
#pragma once

#include <optional>
#include <vector>

#include "steps.hpp"

namespace vdwmesh::apps {

// The exact union; `measured` as in UnionOptions.
void measure_exactly(const SphereSet& spheres, const ExactOptions& options, Session& session,
                     const std::optional<std::vector<SphereId>>& measured = std::nullopt);

// Writes the table of voids where --voids asked for it; the exact union must be in the report.
void write_voids(const OutputOptions& output, const Molecule& molecule, VerbSession& session);

// The polar and apolar parts of the exact area, which must be in the report.
void measure_polarity(const Molecule& molecule, Session& session);

// Which backend measures distances of a mesh, and if the choice is automatic and the CPU does, why.
struct DistanceBackend {
  Backend backend;
  std::optional<std::string> reason;
};
DistanceBackend choose_for_distances(std::uint64_t triangles, const Session& session);

MeasuredDistances measure_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                                    const DistanceChoice& choice, const Session& session);

// The signed distance of the centre of each triangle to the boundary of the union, Å; or to the
// excluded surface, if the report has that. Then the spheres are the atoms without the probe.
std::vector<float> measure_centers(const IndexedMesh& mesh, const SphereSet& spheres,
                                   Session& session);

// Mesh beside exact union, which both must be in the report, and the distances between them.
void compare_with_exact(const IndexedMesh& mesh, const SphereSet& spheres,
                        const DistanceChoice& choice, Session& session);

// What proves a crease-exact mesh: topology, areas of atoms and extrapolated figures beside the
// exact ones. Mesh, exact union and comparison must be in the report. Other meshes have none.
void prove(const IndexedMesh& mesh, const Molecule& molecule, Session& session);

// Warns of balls that the mesh lacks, or has joined to others, where no exact union was made: the
// pieces of the union are counted by the pairs of balls that overlap.
void warn_of_lost_balls(const SphereSet& spheres, Session& session);
// The same, for a union whose pieces have been counted.
void warn_of_lost_balls(std::uint64_t pieces, Session& session);

}  // namespace vdwmesh::apps
