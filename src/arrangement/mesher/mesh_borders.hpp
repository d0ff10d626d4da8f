// The borders between the parts of a set that several processes have arranged, each its own.
//
// A process knows the arcs and corners at its own balls (part_arrangement.hpp). An arc between own
// balls of two processes is known to both. It is the arc of the process that has its lower ball;
// this one has the lower number, because processes have runs of balls one behind the other. Corners
// likewise. Numbers need not travel to tell arcs and corners apart: both sides list those that they
// share in the same order, which is that of the whole set.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "arrangement/mesher/arc_sampling.hpp"
#include "arrangement/mesher/boundary_arcs.hpp"
#include "arrangement/mesher/mesh_share.hpp"
#include "arrangement/mesher/mesh_team.hpp"
#include "arrangement/mesher/split_limits.hpp"

namespace vdwmesh {

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
