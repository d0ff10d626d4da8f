// Meshes the boundary of a union of balls patch by patch and assembles the patches.
//
// A patch is the exposed part of one sphere; its boundary consists of arcs, which are sampled by
// points and so divided into pieces (arc_sampling.hpp).
//
// Steps: (1) Sample all arcs. (2) Mesh the patches in rounds. A round meshes its patches in
// parallel, each by itself. A patch may return requests to split pieces of its boundary. The pieces
// are split in the common sampling, and the patches on both sides of them are meshed again in the
// next round, until there are no requests. There are two series of rounds. The first only tests the
// boundaries, which is quick; the second makes triangles. (3) Number the vertices (corners, points
// of arcs, interior points ball by ball) and copy the patches into one mesh (mesh_assembly.hpp),
// which goes to the team.
//
// Several processes may do this together (mesh_team.hpp). Each meshes the patches of a run of
// balls; after each round all of them split the pieces that any of them wants split.
//
// If curves nearly coincide, splitting might never end. Three limits end it with CurvesTooClose: on
// the number of rounds, on the number of pieces, and on how straight a piece to be split may be.
#include "arrangement/mesher/union_mesher.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "arrangement/mesher/flat_boundary.hpp"
#include "arrangement/mesher/mesh_assembly.hpp"
#include "arrangement/mesher/patch_mesher.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

// Both count the rounds of one series. In the first kQualityRounds rounds, pieces are split for the
// quality of triangles as well, afterwards only for their validity. If there are still requests in
// round kMostRounds, the mesher gives up.
constexpr int kQualityRounds = 12;
constexpr int kMostRounds = 60;
// How many pieces there may be in all, besides 64 for each piece there was at first: kMostGrowth
// for the usual and finer feature sizes, kCoarserGrowth for coarser ones. Coarser sizes are tried
// only after curves were found too close for the usual sizes, and several of them in turn, so less
// is spent on each.
constexpr std::uint64_t kMostGrowth = std::uint64_t{1} << 16, kCoarserGrowth = kMostGrowth / 4;
// A piece counts as straight if its sagitta, the largest distance between chord and arc, is below
// this fraction of the size of its coordinates. Rounding moves a coordinate of size S by up to
// 2^-53 S, which is 32 times as far. So the midpoint of such a piece lies on its chord, as far as
// coordinates tell.
constexpr double kStraight = 0x1p-58;

double largest_coordinate(const Vec3d& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

// The edge length of each ball, scaled.
std::vector<double> scaled_edge_lengths(const PowerTriangulation& t,
                                        const ExactMeshOptions& options) {
  std::vector<double> lengths;
  lengths.reserve(t.balls.size());
  for (const SphereId id : t.ids) {
    const double length =
        options.edge_lengths.empty() ? options.edge_length : options.edge_lengths[id];
    lengths.push_back(std::ldexp(length, -t.scale_exponent));
  }
  return lengths;
}

// One run of the mesher; run() lists the steps.
class UnionMesher {
 public:
  UnionMesher(const Arrangement& arrangement, BoundaryArcs&& boundary,
              const ExactMeshOptions& options, PatchDevice* device, MeshTeam& team)
      : options_(options),
        device_(device),
        team_(team),
        t_(arrangement.triangulation),
        measures_(arrangement.measures),
        boundary_(std::move(boundary)),
        index_(t_, arrangement.complex, boundary_),
        edge_lengths_(scaled_edge_lengths(t_, options)),
        sampling_(boundary_, edge_lengths_),
        pieces_at_first_(count_pieces()),
        allowed_growth_(boundary_.sizes.arc > FeatureSizes{}.arc ? kCoarserGrowth : kMostGrowth),
        progress_(t_.balls.size()),
        patches_(t_.balls.size()),
        has_coincident_points_(t_.balls.size(), 0) {}

  ExactMeshStats run() && {
    MeshShare share;
    team_.together([&] {
      share = own_share();
      check_memory(share.balls);
    });
    mesh_patches(share.balls);
    MeshPiece piece;
    team_.together([&] {
      sampling_.number_vertices();
      share.arcs = even_run(boundary_.arcs.size());
      share.corners = even_run(boundary_.corners.size());
      piece = assemble({t_, boundary_, sampling_, index_, patches_}, share);
    });
    team_.take(std::move(piece), boundary_.has_joined_corners ? boundary_.corners.size() : 0);
    ExactMeshStats stats = stats_;
    stats.exact_tests = team_.sum(stats.exact_tests);
    stats.arcs = boundary_.arcs.size();
    stats.corners = boundary_.corners.size();
    stats.points = boundary_.points;
    stats.contacts = boundary_.contacts;
    stats.joins = boundary_.joins;
    stats.arc_size = boundary_.sizes.arc;
    stats.circle_size = boundary_.sizes.circle;
    stats.pieces = count_pieces();
    return stats;
  }

 private:
  std::uint64_t count_pieces() const {
    std::uint64_t pieces = 0;
    for (std::uint32_t a = 0; a < boundary_.arcs.size(); ++a) pieces += sampling_.pieces(a);
    return pieces;
  }

  // The equilateral triangles of its edge length that the area of a ball's patch holds.
  double ideal_triangles(std::size_t ball) const {
    const double length = edge_lengths_[ball];
    return measures_[ball].area / (std::sqrt(3.0) / 4) / (length * length);
  }

  // The run of this process of `count` elements that are shared out evenly.
  MeshShare::Run even_run(std::uint64_t count) const {
    const auto begin = [&](std::uint64_t number) {
      return static_cast<std::uint32_t>(count * number / team_.count());
    };
    return {begin(team_.number()), begin(team_.number() + 1)};
  }

  // The run of balls of this process: those whose middle triangle, of all in the order of the
  // balls, is in its part. kPatch is what a patch costs besides its triangles, in triangles.
  MeshShare own_share() const {
    constexpr double kPatch = 20;
    const std::size_t balls = t_.balls.size();
    if (team_.count() == 1) return {{0, static_cast<std::uint32_t>(balls)}, {}, {}};
    std::vector<double> middles;
    double before = 0;
    for (std::size_t b = 0; b < balls; ++b) {
      const double triangles = ideal_triangles(b), cost = triangles > 0 ? triangles + kPatch : 0;
      middles.push_back(before + cost / 2);
      before += cost;
    }
    const auto begin = [&](std::size_t number) {
      if (number == team_.count()) return static_cast<std::uint32_t>(balls);
      const double part = static_cast<double>(number) / static_cast<double>(team_.count());
      const auto first = std::ranges::lower_bound(middles, part * before);
      return static_cast<std::uint32_t>(number == 0 ? 0 : first - middles.begin());
    };
    return {{begin(team_.number()), begin(team_.number() + 1)}, {}, {}};
  }

  // Refuses a mesh that will not fit the memory limit, before its memory is taken. The number of
  // triangles is estimated from the area of the patches that this process meshes: the number of
  // equilateral triangles of the edge length, times kFill, plus four per piece for narrow parts of
  // patches, of which each process has its part. A closed mesh has about half as
  // many vertices as triangles. By how much edges must be longer follows from the count, which
  // falls with the square of the edge length, and 5 % are added for safety.
  void check_memory(const MeshShare::Run& balls) const {
    constexpr double kFill = 1.4;  // allowance over the ideal number of triangles
    // Bytes per triangle for the patches before they are joined.
    constexpr std::uint64_t kScratch = 40;
    const std::uint64_t pieces = count_pieces() / team_.count();
    double ideal = 0;
    for (std::uint32_t b = balls.first; b < balls.second; ++b) ideal += ideal_triangles(b);
    const double triangles = kFill * ideal + 4 * static_cast<double>(pieces);
    // Just below 2^64. A triangle takes less than 200 bytes, so with at most kMost / 200 triangles
    // the number of bytes fits 64 bits.
    constexpr double kMost = 1.8e19;
    const auto count = static_cast<std::uint64_t>(std::min(triangles, kMost / 200));
    const std::uint64_t vertices = count / 2;
    const std::uint64_t need =
        indexed_mesh_bytes({vertices, count}, kPatchArrays) + kScratch * count;
    if (need <= options_.memory_limit && vertices <= kMaxVertices) return;
    const double longer =
        1.05 *
        std::max(std::sqrt(static_cast<double>(need) / static_cast<double>(options_.memory_limit)),
                 std::sqrt(static_cast<double>(vertices) / static_cast<double>(kMaxVertices)));
    if (!options_.edge_lengths.empty()) {
      throw LimitExceeded(fmt::format(
          "these edge lengths need about {} triangles and {} bytes, {} are allowed: choose lengths "
          "{:.2g} times as long or a higher memory limit",
          count, need, options_.memory_limit, longer));
    }
    throw LimitExceeded(fmt::format(
        "an edge length of {} Å needs about {} triangles and {} bytes, {} are allowed: choose an "
        "edge length of at least {:.2g} Å or a higher memory limit",
        options_.edge_length, count, need, options_.memory_limit, options_.edge_length * longer));
  }

  // Whether the ball's sphere is exposed as a whole, except for points of contact. A sphere without
  // arcs is exposed entirely or not at all, except for such points. So its exposed area is near
  // 4 pi r² or near 0, and comparing with half of the sphere's area tells the two apart despite
  // rounding.
  bool is_whole(std::uint32_t ball) const {
    const double r = t_.balls[ball].radius;
    return index_.arcs(ball).empty() && measures_[ball].area > 2 * std::numbers::pi * r * r;
  }

  // The two series of rounds: first the boundaries of all patches that have one, then all patches.
  void mesh_patches(const MeshShare::Run& own) {
    own_ = own;
    std::vector<std::uint32_t> bounded, all;
    for (std::uint32_t b = own.first; b < own.second; ++b) {
      const bool has_arcs = !index_.arcs(b).empty();
      if (has_arcs) bounded.push_back(b);
      if (has_arcs || is_whole(b)) all.push_back(b);
    }
    run_rounds(std::move(bounded), PatchStage::boundary);
    run_rounds(std::move(all), PatchStage::triangles);
  }

  // One series of rounds: meshes the patches of `balls` in parallel, splits the pieces that they
  // ask for, and goes on with the balls on both sides of these pieces, until no process has
  // requests. All processes split the same pieces.
  void run_rounds(std::vector<std::uint32_t> balls, PatchStage stage) {
    for (int round = 1;; ++round) {
      const Demand demand = round <= kQualityRounds ? Demand::quality : Demand::validity;
      std::vector<PieceSplit> splits;
      std::uint32_t coincident = kNoIndex;
      team_.together([&] {
        mesh_balls(balls, demand, stage);
        coincident = first_coincident(balls);
        splits = wanted_splits(balls);
      });
      coincident = team_.least(coincident);
      if (coincident != kNoIndex) refuse_coincident(coincident);
      team_.merge(splits);
      last_splits_ = std::move(splits);
      if (last_splits_.empty()) return;
      if (round == kMostRounds) refuse(last_splits_.front().piece);
      check_straightness(last_splits_);
      stats_.split += last_splits_.size();
      bool fits = true;
      team_.together([&] {
        sampling_.split(last_splits_);
        fits = pieces_fit();
        balls = sides_of(boundary_, last_splits_);
        std::erase_if(balls, [&](std::uint32_t b) { return b < own_.first || b >= own_.second; });
      });
      check_growth(last_splits_, team_.least(fits) != 0);
    }
  }

  // One round.
  void mesh_balls(const std::vector<std::uint32_t>& balls, Demand demand, PatchStage stage) {
    if (balls.empty()) return;
    begin_stage(options_.monitor, stage == PatchStage::boundary ? "sample arcs" : "mesh patches",
                balls.size());
    const std::vector<std::uint32_t> for_host =
        device_ && stage == PatchStage::triangles && last_splits_.empty()
            ? mesh_on_device(balls, demand)
            : balls;
    tbb::parallel_for(std::size_t{0}, for_host.size(), [&](std::size_t i) {
      mesh_ball(for_host[i], demand, stage);
      advance(options_.monitor, 1);
    });
    for (const std::uint32_t b : balls) stats_.exact_tests += patches_[b].exact_tests;
  }

  // Gives up if a piece to be split is straight (kStraight). The split would not move any point off
  // the chord, so whatever crosses the piece or folds over it would do so with the halves as well.
  // The sagitta of an arc of radius r and angle a is r a² / 8 for small a.
  void check_straightness(const std::vector<PieceSplit>& splits) const {
    for (const PieceSplit& s : splits) {
      const BoundaryArc& arc = boundary_.arcs[s.piece.arc];
      const double angle = sampling_.piece_angle(s.piece);
      const double size = largest_coordinate(arc.center) + arc.radius;
      if (arc.radius * angle * angle / 8 < kStraight * size) refuse(s.piece);
    }
  }

  // Whether there is memory for this process's part of the pieces, with four triangles and two
  // vertices for each.
  bool pieces_fit() const {
    const std::uint64_t pieces = count_pieces() / team_.count();
    return indexed_mesh_bytes({2 * pieces, 4 * pieces}, kPatchArrays) <= options_.memory_limit;
  }

  // Gives up if there are too many pieces for the memory of any process, or more than
  // allowed_growth_ plus 64 for each piece there was at first. Curves that nearly coincide ask for
  // shorter and shorter pieces. The message names the two spheres of that arc, among those just
  // split, which has the most pieces.
  void check_growth(const std::vector<PieceSplit>& splits, bool fits) const {
    const std::uint64_t pieces = count_pieces();
    if (fits && pieces <= allowed_growth_ + 64 * pieces_at_first_) return;
    const auto& longest = *std::max_element(
        splits.begin(), splits.end(), [&](const PieceSplit& a, const PieceSplit& b) {
          return sampling_.pieces(a.piece.arc) < sampling_.pieces(b.piece.arc);
        });
    if (fits) refuse(longest.piece);
    const auto& balls = boundary_.arcs[longest.piece.arc].balls;
    throw CurvesTooClose(fmt::format(
        "where spheres {} and {} meet, {} points are not enough to tell curves apart: allow more "
        "memory than {} bytes, or leave out one of two spheres that all but coincide, or use "
        "marching cubes",
        t_.ids[balls[0]], t_.ids[balls[1]], pieces, options_.memory_limit));
  }

  // Gives up at a piece, naming the two spheres that meet there.
  [[noreturn]] void refuse(const ArcPiece& piece) const {
    const auto& balls = boundary_.arcs[piece.arc].balls;
    throw CurvesTooClose(fmt::format(
        "where spheres {} and {} meet, curves of the boundary are too close to be told apart in "
        "double precision: leave out one of two spheres that all but coincide, or use marching "
        "cubes",
        t_.ids[balls[0]], t_.ids[balls[1]]));
  }

  // Meshes the patch of one ball into patches_[ball]. Threads run this at the same time for
  // different balls. An error about coincident points must not depend on which thread comes first,
  // so such points are only noted here (first_coincident()).
  void mesh_ball(std::uint32_t ball, Demand demand, PatchStage stage) {
    // As a fraction of the radius, since patches are meshed on the unit sphere.
    const double edge_length = edge_lengths_[ball] / t_.balls[ball].radius;
    if (is_whole(ball)) {
      patches_[ball] = mesh_sphere(edge_length);
      return;
    }
    PatchProgress& progress = up_to_date(ball);
    try {
      PatchMesh& patch = patches_[ball] =
          mesh_patch(progress, {edge_length, demand, stage, options_.monitor}, scratch_.local());
      if (!patch.triangles.empty()) finish(ball, patch);
    } catch (const CoincidentPoints&) {
      has_coincident_points_[ball] = 1;
    }
  }

  // Lets the device mesh the patches that have a boundary, if there are so many that this is worth
  // its while, and returns the balls that it leaves to the host. Precondition: no piece was split
  // in the last round, so the triangulations of all boundaries are up to date.
  std::vector<std::uint32_t> mesh_on_device(const std::vector<std::uint32_t>& balls,
                                            Demand demand) {
    std::vector<std::uint32_t> of_job, left;
    std::vector<PatchJob> jobs;
    for (const std::uint32_t b : balls) {
      const PatchProgress* progress = progress_[b].get();
      if (!progress || !progress->is_triangulated) {
        left.push_back(b);
        continue;
      }
      const double r = t_.balls[b].radius;
      of_job.push_back(b);
      jobs.push_back(
          {progress, edge_lengths_[b] / r, measures_[b].area / (r * r), demand, &patches_[b]});
    }
    if (jobs.size() < device_->least_jobs()) return balls;
    device_->mesh(jobs, options_.monitor);
    tbb::parallel_for(std::size_t{0}, jobs.size(), [&](std::size_t i) {
      if (jobs[i].is_done && !jobs[i].mesh->triangles.empty()) finish(of_job[i], *jobs[i].mesh);
    });
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      if (!jobs[i].is_done) left.push_back(of_job[i]);
      (jobs[i].is_done ? stats_.device_patches : stats_.left_patches) += 1;
    }
    std::sort(left.begin(), left.end());
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

  // Gives the points of a finished patch the numbers that place_patch() expects, and frees what the
  // rounds needed. If a piece is split after all, the patch begins anew.
  void finish(std::uint32_t ball, PatchMesh& patch) {
    const std::vector<std::uint32_t> numbers =
        gathered_numbers(boundary_, sampling_, index_, ball, progress_[ball]->boundary);
    for (auto& triangle : patch.triangles) {
      for (std::uint32_t& v : triangle) {
        if (v < numbers.size()) v = numbers[v];
      }
    }
    progress_[ball].reset();
  }

  // The first ball of the list that has coincident points; kNoIndex if none has. It does not depend
  // on which thread or process came first.
  std::uint32_t first_coincident(const std::vector<std::uint32_t>& balls) const {
    const auto found = std::ranges::find_if(
        balls, [&](std::uint32_t b) { return has_coincident_points_[b] != 0; });
    return found == balls.end() ? kNoIndex : *found;
  }

  [[noreturn]] void refuse_coincident(std::uint32_t ball) const {
    throw CurvesTooClose(fmt::format(
        "two curves on sphere {} are closer than double precision can tell: leave out one of two "
        "spheres that all but coincide, or use marching cubes",
        t_.ids[ball]));
  }

  // The requests of all balls, sorted by piece, each piece once.
  std::vector<PieceSplit> wanted_splits(const std::vector<std::uint32_t>& balls) const {
    std::vector<PieceSplit> splits =
        collect<PieceSplit>(balls.size(), [&](std::size_t i, std::vector<PieceSplit>& found) {
          const std::vector<PieceSplit>& of_patch = patches_[balls[i]].splits;
          found.insert(found.end(), of_patch.begin(), of_patch.end());
        });
    merge_splits(splits);
    return splits;
  }

  ExactMeshOptions options_;
  PatchDevice* device_;  // or null
  MeshTeam& team_;
  const PowerTriangulation& t_;
  const std::vector<SphereMeasures>& measures_;
  BoundaryArcs boundary_;
  PatchIndex index_;
  std::vector<double> edge_lengths_;  // by ball, scaled
  ArcSampling sampling_;
  // The number of pieces before any was split; and the number that is allowed besides 64 for each
  // of these.
  std::uint64_t pieces_at_first_, allowed_growth_;
  tbb::enumerable_thread_specific<PatchScratch> scratch_;
  std::vector<PieceSplit> last_splits_;  // between the last round and this one
  MeshShare::Run own_{};                 // the balls of this process
  // By ball; empty for balls that have not begun or have finished.
  std::vector<std::unique_ptr<PatchProgress>> progress_;
  std::vector<PatchMesh> patches_;  // by ball; empty for balls without a patch
  // By ball. The elements are bytes and not bits, because several threads set them.
  std::vector<std::uint8_t> has_coincident_points_;
  ExactMeshStats stats_;
};

}  // namespace

ExactMeshStats mesh_boundary(const Arrangement& arrangement, BoundaryArcs&& boundary,
                             const ExactMeshOptions& options, PatchDevice* device, MeshTeam& team) {
  std::optional<UnionMesher> mesher;
  team.together([&] { mesher.emplace(arrangement, std::move(boundary), options, device, team); });
  return std::move(*mesher).run();
}

}  // namespace vdwmesh
