// Steps that measure the union of the spheres exactly, and set a mesh beside it. Each fills its
// part of the report.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "analysis/distance_measurer.hpp"
#include "steps/steps.hpp"

namespace vdwmesh {
struct BallGradient;
}

namespace vdwmesh::apps {

// The spheres that are measured, as UnionOptions::measured; empty: all of them.
using MeasuredSpheres = std::optional<std::vector<SphereId>>;

// Measures the union exactly.
void measure_exactly(const SphereSet& spheres, const ExactOptions& options, Session& session,
                     const MeasuredSpheres& measured = std::nullopt);
// Whether only the CPU can: a device measures all spheres by arcs, without a certificate and
// without topology.
bool needs_cpu(const ExactOptions& options, const MeasuredSpheres& measured);
// Whether a device is to measure: if it can, and if the choice is automatic, only where that saves
// time. Throws BackendUnavailable if a device is asked for and there is none.
bool wants_device(const SphereSet& spheres, const ExactOptions& options, const Session& session,
                  const MeasuredSpheres& measured);
// Measures on the CPU, and does not end the stage.
void measure_on_cpu(const SphereSet& spheres, const ExactOptions& options, Session& session,
                    const MeasuredSpheres& measured);

// Writes how deep the atoms lie if --depth names a file.
void write_depths(const OutputOptions& output, const Molecule& molecule, double probe,
                  VerbSession& session);

// Throws InvalidInput where --rsa or --b-factor exposure asks for relative areas, and the radii or
// the probe have no reference.
void check_references(const OutputOptions& output, const Molecule& molecule, double probe);
// Writes the atoms with their figures if --write names a file. Precondition: the measures of the
// surface, and of the excluded one the shares of atoms, are in the report.
void write_atoms(const OutputOptions& output, const Molecule& molecule, double probe,
                 VerbSession& session);

// Writes the derivatives of the union's area and volume if --gradient names a file, and notes what
// may have none.
void write_gradient(const OutputOptions& output, const SphereSet& spheres, VerbSession& session);
// The same of derivatives that are there, of which so many spheres may have none.
void write_gradient(const OutputOptions& output, const std::vector<BallGradient>& gradients,
                    std::uint64_t kink_spheres, VerbSession& session);

// The same of the excluded surface in the report.
void write_excluded_gradient(const OutputOptions& output, VerbSession& session);

// Writes the table of voids, or a sphere for each where viewers take such a file, if --voids names
// one. Precondition: the exact union is in the report.
void write_voids(const OutputOptions& output, const Molecule& molecule, double probe,
                 VerbSession& session);

// Adds the polar and apolar parts of the exact area. Precondition: the exact union is in the
// report.
void measure_polarity(const Molecule& molecule, Session& session);

// The backend that measures the distances of a mesh. If the choice is automatic and falls on the
// CPU, `reason` says why.
struct DistanceBackend {
  Backend backend;
  std::optional<std::string> reason;
};
DistanceBackend choose_for_distances(std::uint64_t triangles, const Session& session);

MeasuredDistances measure_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                                    const DistanceChoice& choice, const Session& session);

// Returns the signed distance (Å) of the centre of each triangle to the boundary of the union. If
// the report has an excluded surface, the distances are to that, and `spheres` must be the atoms
// without the probe.
std::vector<float> measure_centers(const IndexedMesh& mesh, const SphereSet& spheres,
                                   Session& session);

// Distances, and what backend was chosen for them.
struct TakenDistances {
  DistanceBackend chosen;
  MeasuredDistances measured;
};
TakenDistances take_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                              const DistanceChoice& choice, const Session& session);

// Compares the mesh with the exact union and measures the distances between them. Precondition:
// both are in the report.
void compare_with_exact(const IndexedMesh& mesh, const SphereSet& spheres,
                        const DistanceChoice& choice, Session& session);
// The same with distances that were measured before, if they were wanted.
void compare_with_exact(const SphereSet& spheres, const std::optional<TakenDistances>& taken,
                        Session& session);

// Adds what proves a crease-exact mesh: its topology, its areas of atoms and its extrapolated
// figures beside the exact ones. Does nothing for other meshes. Precondition: mesh, exact union and
// comparison are in the report.
void prove(const IndexedMesh& mesh, const Molecule& molecule, Session& session);

// Warns if the mesh has fewer pieces than the union, because it lacks balls or has joined some to
// others. Serves runs without an exact union: the pieces are counted from the pairs of balls that
// overlap.
void warn_of_lost_balls(const SphereSet& spheres, Session& session);
// The same for a union whose number of pieces is known.
void warn_of_lost_balls(std::uint64_t pieces, Session& session);

}  // namespace vdwmesh::apps
