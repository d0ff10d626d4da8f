// Which part of a mesh one process makes, whether it has the memory for it, and the borders between
// the parts of a set that several processes have arranged, each its own.
//
// A process knows the arcs and corners at its own balls (part_arrangement.hpp). An arc between own
// balls of two processes is known to both. It is the arc of the process that has its lower ball;
// this one has the lower number, because processes have runs of balls one behind the other. Corners
// likewise. Numbers need not travel to tell arcs and corners apart: both sides list those that they
// share in the same order, which is that of the whole set.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "creases/arcs/arc_sampling.hpp"
#include "creases/arcs/boundary_arcs.hpp"
#include "creases/arcs/split_limits.hpp"
#include "creases/exact_mesher.hpp"
#include "creases/share/mesh_team.hpp"

namespace vdwmesh {

// What a mesh of patches has beside positions, normals and triangles.
inline constexpr MeshArrays kPatchArrays = {.labels = TriangleLabels::spheres,
                                            .width = LabelWidth::three};

// The runs [first, second) of balls, corners and arcs that one process has.
struct MeshShare {
  using Run = std::pair<std::uint32_t, std::uint32_t>;
  Run balls, corners, arcs;

  // Whether the process meshes the ball's patch.
  bool has_patch_of(std::uint32_t ball) const { return ball >= balls.first && ball < balls.second; }
};

// The edge length of each ball, scaled as the triangulation.
std::vector<double> scaled_edge_lengths(const PlacedBalls& balls, const ExactMeshOptions& options);

// The areas of patches, and the edge lengths wanted there, by ball and in one unit.
struct PatchExtents {
  std::span<const double> areas, edge_lengths;
};

// The share of this process of the team: all, if it is alone.
MeshShare own_share(const MeshTeam& team, const BoundaryArcs& boundary,
                    const PatchExtents& patches);

// Refuses a share that will not fit the memory limit, before its memory is taken; `pieces` is how
// many pieces of arcs it has. Throws LimitExceeded.
void check_memory(const MeshShare& share, const PatchExtents& patches, std::uint64_t pieces,
                  const ExactMeshOptions& options);

// Throws LimitExceeded if a mesh cannot hold so many vertices.
void check_vertices(std::uint64_t vertices);

// What a process has of the balls that it has arranged.
struct OwnedPart {
  MeshShare share;                   // the own balls, and the corners and arcs of which they are
                                     // the lowest
  std::vector<std::uint32_t> owner;  // by ball: the number of its process, ascending
};

class MeshBorders {
 public:
  // Keeps references to its arguments. `boundary` has arcs and corners at own balls alone.
  MeshBorders(const BoundaryArcs& boundary, const OwnedPart& part, const MeshTeam& team);

  // Does a check that may throw CurvesTooClose, and throws it in all processes if it does in one.
  // Collective.
  template <class Check>
  void agree(const Check& check) const {
    bool refused = false;
    try {
      check();
    } catch (const CurvesTooClose&) {
      refused = true;
    }
    if (team_.sum(std::uint64_t{refused}) > 0) {
      throw CurvesTooClose("curves of a part are too close to be told apart");
    }
  }

  // Adds the requests of other processes for the arcs here to those of this one; then they are
  // sorted by piece, each piece once. Collective.
  void merge(std::vector<PieceSplit>& splits) const;

  // How many of the requests are for pieces of arcs of this process.
  std::uint64_t count_own(std::span<const PieceSplit> splits) const;

  // Replaces numbers of corners and points of arcs here, ascending, which are not of this process,
  // by those in the whole mesh, ascending. The vertices of the sampling are numbered. Collective.
  void number_in_whole(const ArcSampling& sampling, std::vector<std::uint64_t>& numbers) const;

 private:
  using Lists = std::vector<std::vector<std::uint32_t>>;  // by process

  bool is_own_ball(std::uint32_t ball) const { return part_.share.has_patch_of(ball); }
  // The numbers that `number` gives to the elements of this process, on all that share them:
  // set(element, number) is called for the shared elements of other processes. Collective.
  template <class Number, class Set>
  void tell_numbers(const Lists& shared, const MeshShare::Run& own, const Number& number,
                    const Set& set) const;

  const BoundaryArcs& boundary_;
  const OwnedPart& part_;
  const MeshTeam& team_;
  Lists arcs_, corners_;  // shared with each process, ascending
};

}  // namespace vdwmesh
