// Distances to the solvent-excluded surface of a set of balls: signed ones of points, and those
// between a mesh of any program and the surface, in both directions.
//
// The surface is the complete one of excluded_measures.hpp, with the walls of cavities, or the
// exterior one, inside of which cavities lie. Distances are to its nearest point, which may be
// inside a patch, on a crease or in a cusp; they are exact up to rounding. docs/excluded_surface.md
// states what is computed, and proves it.
#pragma once

#include <span>
#include <vector>

#include "analysis/distances.hpp"
#include "excluded/excluded_measures.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class Monitor;

// Returns the distance of each point to the surface, Å: positive where a probe reaches, negative
// inside the excluded solid. Throws InvalidInput if there are no atoms, if the probe (Å) is not
// above 0 and finite, or if a coordinate is not finite, and Cancelled on request of the monitor.
// The result does not depend on the number of threads.
std::vector<double> excluded_signed_distances(std::span<const Vec3d> points, const SphereSet& atoms,
                                              double probe, Monitor* monitor = nullptr,
                                              ExcludedPart part = ExcludedPart::complete);

// Computes what distances() computes, with the excluded surface in place of the boundary of a union
// of balls; the samples on the mesh are the same ones. Samples on the surface lie on lattices on
// the spheres of atoms and probes, and evenly spread over saddles, with samples_per_area points per
// Å²; points of creases, cusps and corners of patches count for the maximum alone. The result is
// the same bit for bit for any number of threads.
//
// Throws as distances() does, and InvalidInput for a probe that is not above 0 and finite. The
// memory that is checked includes the triangulation of the atoms.
MeshDistances excluded_distances(const IndexedMesh& mesh, const SphereSet& atoms, double probe,
                                 const DistanceOptions& options = {},
                                 ExcludedPart part = ExcludedPart::complete);

// Upper bound of the bytes that excluded_distances() takes beside the mesh, for molecules.
std::uint64_t excluded_distances_bytes(const MeshSize& mesh, std::uint64_t atoms);

}  // namespace vdwmesh
