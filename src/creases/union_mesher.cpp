// Meshes the boundary of a union of balls patch by patch and assembles the patches.
//
// A patch is the exposed part of one sphere; its boundary consists of arcs, which are sampled by
// points and so divided into pieces (arc_sampling.hpp).
//
// Steps: (1) Sample all arcs. (2) Mesh the patches in rounds. A round meshes its patches in
// parallel, each by itself. A patch may return requests to split pieces of its boundary. The pieces
// are split in the common sampling, and the patches on both sides of them are meshed again in the
// next round, until there are no requests. There are three series of rounds (RoundSeries). (3)
// Number the vertices (corners, points of arcs, interior points ball by ball) and copy the patches
// into one mesh, which goes to the team.
//
// Several processes may do this together (mesh_team.hpp). Each meshes the patches of a run of
// balls. If all of them have arranged all balls, all split the pieces that any of them wants split.
// If each has arranged its part (OwnedPart), those on both sides of a border do (mesh_borders.hpp).
//
// If curves nearly coincide, splitting might never end. Limits on the rounds, on the pieces, and on
// how straight a piece to be split may be end it with CurvesTooClose (split_limits.hpp).
#include "creases/union_mesher.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/blocks.hpp"
#include "core/fixed_blocks.hpp"
#include "creases/arcs/split_limits.hpp"
#include "creases/patch/patch_mesher.hpp"
#include "creases/plane/flat_boundary.hpp"
#include "creases/share/device_patches.hpp"
#include "creases/share/mesh_assembly.hpp"
#include "creases/share/mesh_borders.hpp"

namespace vdwmesh {
namespace {

// There are three series of rounds. The first looks at boundaries alone, which is quick, the second
// makes triangles, and the third makes those patches anew that have an angle below its floor
// (angle_floors.hpp), with the patches beside what it splits. Meshes without such an angle have no
// third series, and do not depend on it.
//
// All count the rounds of one series. In the first kQualityRounds rounds, or kAngleRounds if the
// angles have a bound or floors, pieces are split for the quality of triangles as well, afterwards
// only for their validity. If there are still requests in round kMostRounds, the mesher gives up.
constexpr int kQualityRounds = 12, kAngleRounds = 30;
constexpr int kMostRounds = 60;

enum class RoundSeries : std::uint8_t { boundaries, patches, floors };

struct RoundDemands {
  PatchStage stage;
  Demand demand;
  bool raises_angles = false;  // above their floors
};

// `leaves_room`: whether no arc has so many pieces that splits for a bound on the angles must end.
RoundDemands demands_of(RoundSeries series, int round, const ExactMeshOptions& options,
                        bool leaves_room) {
  const bool raises = series == RoundSeries::floors && round <= kAngleRounds;
  const bool bounds = options.min_angle > 0 && leaves_room && round <= kAngleRounds;
  const bool has_quality = round <= kQualityRounds || bounds || raises;
  return {series == RoundSeries::boundaries ? PatchStage::boundary : PatchStage::triangles,
          has_quality ? Demand::quality : Demand::validity, raises};
}

std::uint64_t angles_below_floor(std::span<const PatchMesh> patches) {
  return sum_all(patches.size(),
                 [&](std::size_t i, std::uint64_t& count) { count += patches[i].below_floor; });
}

// One run of the mesher; run() lists the steps.
class UnionMesher {
 public:
  UnionMesher(const Arrangement& arrangement, BoundaryArcs&& boundary,
              const ExactMeshOptions& options, PatchDevice* device, MeshTeam& team,
              const OwnedPart* part, bool has_floors)
      : options_(options),
        has_floors_(has_floors),
        team_(team),
        t_(arrangement.balls),
        areas_(arrangement.boundary.areas),
        boundary_(std::move(boundary)),
        index_(t_, arrangement.boundary, boundary_),
        edge_lengths_(scaled_edge_lengths(t_, options)),
        sampling_(boundary_, edge_lengths_),
        limits_(t_.ids, boundary_, sampling_),
        progress_(t_.balls.size()),
        patches_(t_.balls.size()),
        has_coincident_points_(t_.balls.size(), 0) {
    if (part) {
      share_ = part->share;
      borders_.emplace(boundary_, *part, team_);
    }
    if (!device) return;
    device->forget();
    on_device_.emplace(
        *device, t_.balls.size(),
        [this](const PatchJob& job, std::span<PointSource> out) {
          point_sources(boundary_, sampling_, job.ball, job.progress->boundary, out);
        },
        options_.monitor);
  }

  // Whether run() has come to its last series of rounds, and the boundary that it was given.
  bool is_raising_angles() const { return is_raising_angles_; }
  BoundaryArcs boundary() && { return std::move(boundary_); }
  ExactMeshStats run() && {
    team_.together([&] {
      const PatchExtents extents{areas_, edge_lengths_};
      if (!borders_) share_ = own_share(team_, boundary_, extents);
      check_memory(share_, extents, own_pieces(), options_);
    });
    pieces_at_first_ = all_pieces();
    mesh_patches();
    if (options_.min_angle > 0) {
      count_small_angles();
    } else {
      stats_.below_floor = team_.sum(angles_below_floor(patches_));
    }
    UnnumberedPiece piece;
    team_.together([&] {
      sampling_.number_vertices();
      MeshPlacement placement(t_, boundary_, sampling_, index_, share_);
      piece = assemble(placement,
                       {t_, sampling_, patches_, on_device_ ? &*on_device_ : nullptr, progress_},
                       stays_on_device());
    });
    if (borders_) borders_->number_in_whole(sampling_, piece.elsewhere);
    team_.take(std::move(piece), boundary_.has_joined_corners ? boundary_.corners.size() : 0);
    ExactMeshStats stats = stats_;
    stats.exact_tests = team_.sum(stats.exact_tests);
    stats.arcs = whole_count(boundary_.arcs.size(), share_.arcs);
    stats.corners = whole_count(boundary_.corners.size(), share_.corners);
    stats.split = borders_ ? team_.sum(stats.split) : stats.split;
    stats.points = boundary_.points;
    stats.contacts = boundary_.contacts;
    stats.joins = boundary_.joins;
    stats.arc_size = boundary_.sizes.arc;
    stats.circle_size = boundary_.sizes.circle;
    stats.pieces = all_pieces();
    return stats;
  }

 private:
  // The pieces of all arcs here, or of those of the part.
  std::uint64_t count_pieces() const {
    if (!borders_) return sampling_.all_pieces();
    const auto first = sampling_.pieces().begin();
    return std::accumulate(first + share_.arcs.first, first + share_.arcs.second, std::uint64_t{0});
  }
  // How many pieces this process has, about.
  std::uint64_t own_pieces() const {
    return borders_ ? count_pieces() : count_pieces() / team_.count();
  }
  // How many all processes have, and how many elements there are in all, of which those in the run
  // are of this process. Collective.
  std::uint64_t all_pieces() const { return borders_ ? team_.sum(count_pieces()) : count_pieces(); }
  std::uint64_t whole_count(std::size_t here, const MeshShare::Run& run) const {
    return borders_ ? team_.sum(std::uint64_t{run.second - run.first}) : here;
  }

  // Whether the ball's sphere is exposed as a whole, but for points of contact. Without arcs its
  // exposed area is near 4 pi r² or near 0: half of the sphere's tells them apart despite rounding.
  bool is_whole(std::uint32_t ball) const {
    const double r = t_.balls[ball].radius;
    return index_.arcs(ball).empty() && areas_[ball] > 2 * std::numbers::pi * r * r;
  }

  void count_small_angles() {
    for (const PatchMesh& patch : patches_) {
      stats_.below_min_angle_at_corners += patch.below.at_corners;
      stats_.below_min_angle += patch.below.elsewhere;
    }
  }

  // The three series of rounds (RoundSeries).
  void mesh_patches() {
    std::vector<std::uint32_t> bounded, all;
    for (std::uint32_t b = share_.balls.first; b < share_.balls.second; ++b) {
      const bool has_arcs = !index_.arcs(b).empty();
      if (has_arcs) bounded.push_back(b);
      if (has_arcs || is_whole(b)) all.push_back(b);
    }
    run_rounds(std::move(bounded), RoundSeries::boundaries);
    run_rounds(all, RoundSeries::patches);
    const std::uint64_t below = has_floors_ ? team_.sum(angles_below_floor(patches_)) : 0;
    if (below == 0) return;
    is_raising_angles_ = true;
    std::erase_if(all, [&](std::uint32_t b) { return patches_[b].below_floor == 0; });
    run_rounds(std::move(all), RoundSeries::floors);
    if (team_.sum(angles_below_floor(patches_)) >= below) throw CurvesTooClose("for floors");
  }

  // One series of rounds: meshes the patches of `balls` in parallel, splits the pieces that they
  // ask for, and goes on with the balls on both sides of these pieces, until no process has
  // requests. All processes split the same pieces.
  void run_rounds(std::vector<std::uint32_t> balls, RoundSeries series) {
    for (int round = 1;; ++round) {
      const RoundDemands demands = demands_of(series, round, options_, leaves_room_);
      std::vector<PieceSplit> splits;
      std::uint32_t coincident = kNoIndex;
      team_.together([&] {
        mesh_balls(balls, series, demands);
        coincident = first_coincident(balls);
        splits = wanted_splits(balls);
      });
      // A part has numbers of its own for its balls, and refuses by itself.
      if (!borders_) coincident = team_.least(coincident);
      agree([&] {
        if (coincident != kNoIndex) limits_.refuse_coincident(coincident);
      });
      if (borders_) {
        borders_->merge(splits);
      } else {
        team_.merge(splits);
      }
      last_splits_ = std::move(splits);
      const std::uint64_t wanted = last_splits_.size();
      if ((borders_ ? team_.sum(wanted) : wanted) == 0) return;
      agree([&] {
        if (round == kMostRounds && wanted > 0)
          limits_.refuse_after(round, last_splits_.front().piece);
        limits_.check_straightness(last_splits_);
      });
      stats_.split += borders_ ? borders_->count_own(last_splits_) : wanted;
      bool fits = true;
      team_.together([&] {
        sampling_.split(last_splits_);
        fits = pieces_fit();
        std::vector<std::uint32_t> next = sides_of(boundary_, last_splits_);
        std::erase_if(next, [&](std::uint32_t b) { return !share_.has_patch_of(b); });
        if (on_device_) share_with_device(balls, next, demands.stage);
        balls = std::move(next);
      });
      const SplitLimits::Growth growth{pieces_at_first_, all_pieces(), team_.least(fits) != 0,
                                       options_.memory_limit};
      limits_.check_fit(growth);
      agree([&] { limits_.check_growth(last_splits_, growth); });
      if (options_.min_angle > 0) leaves_room_ = leaves_room_ && limits_.leave_room(last_splits_);
    }
  }

  // Does a check that may throw CurvesTooClose. If all processes have arranged all balls, it comes
  // to the same in all of them.
  template <class Check>
  void agree(const Check& check) const {
    borders_ ? borders_->agree(check) : check();
  }

  void mesh_balls(const std::vector<std::uint32_t>& balls, RoundSeries series,
                  const RoundDemands& demands) {
    if (balls.empty()) return;
    const bool is_boundary = series == RoundSeries::boundaries;
    begin_stage(options_.monitor, is_boundary ? "sample arcs" : "mesh patches", balls.size());
    const auto mesh_all = [&](const std::vector<std::uint32_t>& some) {
      tbb::parallel_for(std::size_t{0}, some.size(), [&](std::size_t i) {
        mesh_ball(some[i], demands);
        advance(options_.monitor, 1);
      });
    };
    const bool is_first = last_splits_.empty();
    if (!on_device_ || series == RoundSeries::floors) {
      mesh_all(balls);
    } else if (!is_boundary) {
      mesh_all(is_first ? mesh_beside_device(balls) : balls);
    } else if (is_first) {
      look_beside_device(balls);
    } else {
      // What was sent and is not beside a piece that was split stays as it is.
      on_device_->let_read([&] { mesh_all(balls); });
    }
    stats_.exact_tests += sum_all(balls.size(), [&](std::size_t i, std::uint64_t& sum) {
      sum += patches_[balls[i]].exact_tests;
    });
  }

  // Whether there is memory for this process's part of the pieces, with four triangles and two
  // vertices for each.
  bool pieces_fit() const {
    const std::uint64_t pieces = own_pieces();
    return indexed_mesh_bytes({2 * pieces, 4 * pieces}, kPatchArrays) <= options_.memory_limit;
  }

  // On the unit sphere: lengths and areas are fractions of the radius and of its square.
  PatchOptions patch_options(std::uint32_t ball) const {
    const double r = t_.balls[ball].radius;
    return {.edge_length = edge_lengths_[ball] / r,
            .monitor = options_.monitor,
            .min_angle = options_.min_angle * std::numbers::pi / 180,
            .splits_for_angles = leaves_room_,
            .area = areas_[ball] / (r * r)};
  }

  // Meshes the patch of one ball into patches_[ball], for several balls at the same time. An error
  // must not depend on which thread comes first: coincident points are noted (first_coincident()).
  void mesh_ball(std::uint32_t ball, const RoundDemands& demands) {
    PatchOptions options = patch_options(ball);
    if (is_whole(ball)) {
      patches_[ball] = mesh_sphere(options.edge_length);
      return;
    }
    options.demand = demands.demand;
    options.stage = demands.stage;
    const ArcsOfPatch arcs{boundary_, sampling_, limits_, ball, t_.balls[ball].radius};
    if (options_.min_angle == 0) options.arcs = &arcs;
    options.raises_angles = demands.raises_angles;
    PatchProgress& progress = up_to_date(ball);
    try {
      PatchMesh& patch = patches_[ball] = mesh_patch(progress, options, scratch_.local());
      if (!patch.triangles.empty()) finish(ball, patch);
    } catch (const CoincidentPoints&) {
      has_coincident_points_[ball] = 1;
    }
  }

  // The first round, if there is a device: it looks at boundaries, too.
  void look_beside_device(const std::vector<std::uint32_t>& balls) {
    const auto look = [this](std::uint32_t b) {
      mesh_ball(b, {PatchStage::boundary, Demand::quality});
    };
    const auto begin = [this](std::uint32_t b) {
      const PatchOptions options = patch_options(b);
      return LookJob{&up_to_date(b), options.edge_length, options.area};
    };
    const auto end = [this](std::uint32_t b, PatchVector<PieceSplit>&& splits) {
      (patches_[b] = {}).splits = std::move(splits);
    };
    on_device_->look(balls, options_.device_work, {look, begin, end}, stats_);
  }

  // After a round of `balls` in which pieces were split, and before that of the balls beside them,
  // `next`. What the device has of these is not wanted any more. In the first series it gets the
  // patches whose boundaries have come to rest, if they are many.
  void share_with_device(const std::vector<std::uint32_t>& balls,
                         const std::vector<std::uint32_t>& next, PatchStage stage) {
    for (const std::uint32_t b : next) {
      // The patch begins anew, as one that the host has finished.
      if (stage == PatchStage::triangles && on_device_->kept_job(b)) progress_[b].reset();
      on_device_->withdraw(b);
    }
    if (stage == PatchStage::triangles) return;
    on_device_->host_has_looked_at(balls.size());
    std::vector<std::uint32_t> quiet;
    std::ranges::set_difference(balls, next, std::back_inserter(quiet));
    // One that was withdrawn waits for the end.
    std::erase_if(quiet, [&](std::uint32_t b) { return on_device_->was_sent(b); });
    send_to_device(quiet, HostWork::rounds);
  }

  // Sends the device its part of `balls`, to be meshed as in the first round of the second series,
  // and takes it out of them. Precondition: the triangulations of the boundaries are up to date.
  void send_to_device(std::vector<std::uint32_t>& balls, HostWork meanwhile) {
    on_device_->send(balls, options_.device_work, meanwhile,
                     [this](std::uint32_t b) { return job_of(b); });
  }

  PatchJob job_of(std::uint32_t ball) const {
    const PatchOptions options = patch_options(ball);
    return {.ball = ball,
            .progress = progress_[ball].get(),
            .edge_length = options.edge_length,
            .area = options.area,
            .demand = Demand::quality};
  }

  // Lets the device mesh patches that have a boundary, and the host others meanwhile, and returns
  // the balls that are left. Both share what the device has not begun yet. Precondition: as
  // send_to_device(), for all balls.
  std::vector<std::uint32_t> mesh_beside_device(const std::vector<std::uint32_t>& balls) {
    if (options_.device_work != DeviceWork::all) on_device_->take_back();
    std::vector<std::uint32_t> of_host =
        collect<std::uint32_t>(balls.size(), [&](std::size_t i, std::vector<std::uint32_t>& found) {
          const PatchProgress* const progress = progress_[balls[i]].get();
          if (progress && progress->is_triangulated && !on_device_->job(balls[i])) {
            found.push_back(balls[i]);
          }
        });
    send_to_device(of_host, HostWork::patches);
    on_device_->finish([&] {
      tbb::parallel_for(std::size_t{0}, of_host.size(), [&](std::size_t i) {
        mesh_ball(of_host[i], {PatchStage::triangles, Demand::quality});
        advance(options_.monitor, 1);
      });
    });
    std::vector<std::uint32_t> left = on_device_->take_results(balls, of_host, patches_, stats_);
    // A patch that the device has returned begins anew if a piece is split after all, as one that
    // the host has finished, which has no progress any more.
    for_each_index(balls.size(), [&](std::size_t i) {
      if (!patches_[balls[i]].triangles.empty()) progress_[balls[i]].reset();
    });
    return left;
  }

  // The progress of a ball's patch, after the splits of the last round.
  PatchProgress& up_to_date(std::uint32_t ball) {
    std::unique_ptr<PatchProgress>& progress = progress_[ball];
    if (progress) {
      split_pieces(boundary_, sampling_, t_.balls[ball], ball, last_splits_, progress->boundary,
                   progress->chains);
    } else {
      progress = std::make_unique<PatchProgress>();
      gather_boundary(t_, boundary_, sampling_, index_, ball, progress->boundary);
    }
    return *progress;
  }

  // Notes which vertices the points of a finished patch will be, and frees what the rounds needed.
  // If a piece is split after all, the patch begins anew.
  void finish(std::uint32_t ball, PatchMesh& patch) {
    const PatchBoundary& points = progress_[ball]->boundary;
    patch.sources.resize(points.points.size());
    point_sources(boundary_, sampling_, ball, points, patch.sources);
    progress_[ball].reset();
  }

  // The first ball of the list that has coincident points; kNoIndex if none has.
  std::uint32_t first_coincident(const std::vector<std::uint32_t>& balls) const {
    const auto i = first_of_all(
        balls.size(), [&](std::size_t k) { return has_coincident_points_[balls[k]] != 0; });
    return i ? balls[*i] : kNoIndex;
  }

  // Sorted by piece, each piece once.
  std::vector<PieceSplit> wanted_splits(const std::vector<std::uint32_t>& balls) const {
    std::vector<PieceSplit> splits =
        collect<PieceSplit>(balls.size(), [&](std::size_t i, std::vector<PieceSplit>& found) {
          const PatchVector<PieceSplit>& of_patch = patches_[balls[i]].splits;
          found.insert(found.end(), of_patch.begin(), of_patch.end());
        });
    merge_splits(splits);
    return splits;
  }

  // Whether the mesh stays in the memory of a device that is to keep it. If features were reduced
  // to points, fans of triangles may have to be parted, and the topology is looked at: by the host.
  bool stays_on_device() const {
    return on_device_ && on_device_->keeps_mesh() &&
           boundary_.points + boundary_.contacts + boundary_.joins == 0;
  }

  ExactMeshOptions options_;
  bool has_floors_, is_raising_angles_ = false;  // the latter in the last series of rounds
  MeshTeam& team_;
  const PlacedBalls& t_;
  const std::vector<double>& areas_;  // by ball
  BoundaryArcs boundary_;
  PatchIndex index_;
  std::vector<double> edge_lengths_;  // by ball, scaled
  ArcSampling sampling_;
  SplitLimits limits_;
  std::uint64_t pieces_at_first_ = 0;  // of all processes, before any was split
  tbb::enumerable_thread_specific<PatchScratch> scratch_;
  std::vector<PieceSplit> last_splits_;  // between the last round and this one
  bool leaves_room_ = true;              // SplitLimits::leave_room() so far
  MeshShare share_;                      // of this process
  std::optional<MeshBorders> borders_;   // if each process has arranged its part
  // By ball; empty for balls that have not begun or have finished.
  std::vector<std::unique_ptr<PatchProgress>> progress_;
  std::vector<PatchMesh> patches_;  // by ball; empty for balls without a patch
  // By ball. The elements are bytes and not bits, because several threads set them.
  std::vector<std::uint8_t> has_coincident_points_;
  ExactMeshStats stats_;
  // Empty without a device. Last, since its threads, which end with it, read the others.
  std::optional<PatchDispatch> on_device_;
};

}  // namespace

// A bound on the angles, with excuses of its own, takes the place of the floors. If curves come too
// close only where pieces are split for floors, or no fewer angles are below them then, as between
// curves that all but coincide, the mesh is made without.
ExactMeshStats mesh_boundary(const Arrangement& arrangement, BoundaryArcs&& boundary,
                             const ExactMeshOptions& options, PatchDevice* device, MeshTeam& team,
                             const OwnedPart* part) {
  std::optional<UnionMesher> mesher;
  for (bool has_floors = options.min_angle == 0;; has_floors = false) {
    team.together([&] {
      mesher.emplace(arrangement, std::move(boundary), options, device, team, part, has_floors);
    });
    try {
      return std::move(*mesher).run();
    } catch (const CurvesTooClose&) {
      if (!mesher->is_raising_angles()) throw;
    }
    boundary = std::move(*mesher).boundary();
  }
}

}  // namespace vdwmesh
