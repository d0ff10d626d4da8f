// The rows of all balls of some sets, by whoever executes the steps: a CUDA device, or the host.
// For the library's own use.
//
// 1. Circles of two exposed balls that no single ball covers; their exposed arcs.
// 2. Corners, each made by the arc of its two lowest balls and found by its other two arcs.
// 3. Shapes of arcs. Low probes, and those that overlap each of them; their patches.
// 4. What each ball gets of its arcs and corners, sorted by ball and summed.
//
// Circles and patches that double leaves undecided are made on the host, one by one. A set fails if
// one of its elements cannot be decided there either, or if two elements that name a third one do
// not agree about it.
//
// An Executor has arrays (make, zeros, upload, download, download_to, put), run(name, count, step),
// scan(counts), the exclusive prefix sum in place that returns the total, select(flags), the
// indices of those that are set, sort(keys, values, count), stable, and overlaps(probes, sets,
// reach).
#pragma once

#include <tbb/parallel_for.h>

#include <span>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "excluded/elements/arc_steps.hpp"
#include "excluded/elements/corner_steps.hpp"
#include "excluded/elements/local_surface.hpp"
#include "excluded/elements/row_steps.hpp"

namespace vdwmesh::excluded::elements {

// The lists of overlapping balls, with the owner of each entry.
template <class Executor>
struct OverlapLists {
  typename Executor::template Array<std::uint64_t> first;  // by ball, and the end
  typename Executor::template Array<std::uint32_t> other, owner;
  std::uint64_t entries = 0;

  Overlaps view() const { return {first.data(), other.data()}; }
};

// Sums over the rows, which are in the order of the batch: set i has the chunks from first_chunk[i]
// to first_chunk[i + 1].
struct ElementSums {
  std::vector<ChunkSum> chunks;
  std::vector<std::size_t> first_chunk;
  std::vector<std::uint8_t> failed;  // by set
  std::uint64_t host_circles = 0, host_corners = 0;
  std::vector<std::uint64_t> host_patches;  // by set
};

template <class Executor>
class ElementPipeline {
  template <class T>
  using Array = typename Executor::template Array<T>;

 public:
  // `balls` and `near` belong to the executor. Set i has the rows offsets[i] up to offsets[i + 1],
  // and `home` has a point near each.
  ElementPipeline(Executor& executor, const Balls& balls, const OverlapLists<Executor>& near,
                  const std::vector<std::size_t>& offsets, const std::vector<Vec3d>& home)
      : x_(executor),
        balls_(balls),
        near_(near),
        offsets_(offsets),
        home_(x_.upload(home)),
        failed_(x_.template zeros<std::uint8_t>(home.size())) {
    result_.host_patches.resize(home.size());
  }

  // Writes a row for each ball to `rows`.
  ElementSums run(BallRow* rows) {
    find_arcs();
    find_corners();
    shapes_ = x_.template make<ArcShape>(arc_count_);
    x_.run("shape_arcs", arc_count_,
           ShapeArcs{balls_, arcs_.data(), corners_.data(), shapes_.data(), failed()});
    find_patches();
    return sum(rows);
  }

 private:
  FailedSets failed() { return {balls_.set, failed_.data()}; }

  // Brings the balls around some places to the host.
  std::vector<HostBall> balls_around(const Array<Around>& around) {
    Array<std::uint8_t> marked = x_.template make<std::uint8_t>(balls_.size);
    x_.run("mark_around", balls_.size,
           MarkAround{balls_, around.data(), around.size(), marked.data()});
    const Array<std::uint32_t> place = x_.select(marked, balls_.size);
    Array<HostBall> taken = x_.template make<HostBall>(place.size());
    x_.run("take_balls", place.size(), TakeBalls{balls_, place.data(), taken.data()});
    return x_.download(taken.data(), taken.size());
  }
  std::vector<HostBall> balls_around_corners(const Array<ProbeCorner>& corners) {
    Array<Around> around = x_.template make<Around>(corners.size());
    x_.run("around_corners", corners.size(), AroundCorners{balls_, corners.data(), around.data()});
    return balls_around(around);
  }
  void fail(const HostBalls& host, std::uint32_t ball) {
    const std::uint8_t yes = 1;
    x_.put(failed_, host.at(ball).set, yes);
  }

  // Elements and entries of lists are named by 32 bits.
  static void check_count(std::uint64_t count, const char* what) {
    constexpr std::uint64_t kMost = std::uint32_t(-1);
    if (count <= kMost) return;
    throw DeviceMemoryExceeded(std::to_string(count) + " " + what +
                               " of excluded surfaces have more than 32 bits: measure fewer sets "
                               "at once");
  }

  void find_arcs() {
    check_count(near_.entries, "pairs of overlapping balls");
    Array<std::uint8_t> flag = x_.template make<std::uint8_t>(near_.entries);
    x_.run("find_circles", near_.entries,
           FindCircles{balls_, near_.view(), near_.owner.data(), flag.data()});
    const Array<std::uint32_t> entry = x_.select(flag, near_.entries);
    const std::uint64_t circles = entry.size();
    const Circles view{balls_, near_.view(), near_.owner.data(), entry.data()};
    Array<std::uint64_t> first = x_.template zeros<std::uint64_t>(circles + 1);
    Array<std::uint8_t> doubtful = x_.template make<std::uint8_t>(circles);
    Array<KeptArcs> kept = x_.template make<KeptArcs>(circles);
    x_.run("count_arcs", circles, CountArcs{view, first.data(), doubtful.data(), kept.data()});
    const std::vector<HostArc> made = decide_circles(view, doubtful, first);
    arc_count_ = x_.scan(first);
    arcs_ = x_.template make<Arc>(arc_count_);
    x_.run("emit_arcs", circles,
           EmitArcs{view, first.data(), doubtful.data(), kept.data(), arcs_.data()});
    const Array<HostArc> uploaded = x_.upload(made);
    x_.run("put_arcs", made.size(), PutHostArcs{uploaded.data(), first.data(), arcs_.data()});
  }

  // Decides doubtful circles on the host, and replaces their counts.
  std::vector<HostArc> decide_circles(const Circles& circles, const Array<std::uint8_t>& doubtful,
                                      Array<std::uint64_t>& count) {
    const Array<std::uint32_t> listed = x_.select(doubtful, doubtful.size());
    result_.host_circles = listed.size();
    if (listed.size() == 0) return {};
    const std::vector<std::uint32_t> index = x_.download(listed.data(), listed.size());
    Array<std::uint32_t> pairs = x_.template make<std::uint32_t>(2 * index.size());
    x_.run("name_circles", index.size(), NameCircles{circles, listed.data(), pairs.data()});
    const std::vector<std::uint32_t> ball = x_.download(pairs.data(), pairs.size());
    Array<Around> around = x_.template make<Around>(index.size());
    x_.run("around_circles", index.size(), AroundCircles{balls_, pairs.data(), around.data()});
    const std::vector<HostBall> near = balls_around(around);
    const HostBalls balls{near, balls_.probe};
    std::vector<std::optional<std::vector<ExactArc>>> arcs(index.size());
    tbb::parallel_for(std::size_t{0}, index.size(), [&](std::size_t i) {
      arcs[i] = exact_circle(balls, ball[2 * i], ball[2 * i + 1]);
    });
    std::vector<HostArc> made;
    std::vector<std::uint64_t> counts;
    for (std::size_t i = 0; i < index.size(); ++i) {
      counts.push_back(arcs[i] ? arcs[i]->size() : 0);
      if (!arcs[i]) fail(balls, ball[2 * i]);
      for (std::size_t k = 0; k < counts.back(); ++k) {
        const ExactArc& arc = (*arcs[i])[k];
        made.push_back({.circle = index[i],
                        .place = static_cast<std::uint32_t>(k),
                        .ball = {ball[2 * i], ball[2 * i + 1]},
                        .third = {arc.third[0], arc.third[1]},
                        .turns = arc.turns});
      }
    }
    const Array<std::uint64_t> by = x_.upload(counts);
    x_.run("replace_counts", index.size(), ReplaceCounts{listed.data(), by.data(), count.data()});
    return made;
  }

  void find_corners() {
    Array<std::uint64_t> first = x_.template zeros<std::uint64_t>(arc_count_ + 1);
    x_.run("count_corners", arc_count_, CountCorners{arcs_.data(), first.data()});
    corner_count_ = x_.scan(first);
    corners_ = x_.template make<ProbeCorner>(corner_count_);
    x_.run("emit_corners", arc_count_,
           EmitCorners{balls_, arcs_.data(), first.data(), corners_.data()});
    place_corners();
    Array<std::uint8_t> wrong = x_.template make<std::uint8_t>(arc_count_);
    x_.run("link_corners", arc_count_,
           LinkCorners{arcs_.data(), arc_count_, first.data(), corners_.data(), wrong.data()});
    x_.run("check_links", arc_count_, CheckLinks{arcs_.data(), wrong.data(), failed()});
    x_.run("check_corners", corner_count_, CheckCorners{corners_.data(), failed()});
  }

  // Places corners in more digits on the host where double is not enough.
  void place_corners() {
    Array<std::uint8_t> wide = x_.template make<std::uint8_t>(corner_count_);
    x_.run("mark_corners", corner_count_, MarkCorners{corners_.data(), failed(), wide.data()});
    const Array<std::uint32_t> listed = x_.select(wide, corner_count_);
    result_.host_corners = listed.size();
    if (listed.size() == 0) return;
    Array<ProbeCorner> chosen = x_.template make<ProbeCorner>(listed.size());
    x_.run("take_corners", listed.size(),
           TakeCorners{listed.data(), corners_.data(), chosen.data()});
    std::vector<ProbeCorner> corners = x_.download(chosen.data(), chosen.size());
    const std::vector<HostBall> near = balls_around_corners(chosen);
    for (ProbeCorner& c : corners) place_exactly({near, balls_.probe}, c);
    const Array<ProbeCorner> placed = x_.upload(corners);
    x_.run("put_corners", listed.size(), PutCorners{listed.data(), placed.data(), corners_.data()});
  }

  void find_patches() {
    Array<std::uint8_t> flag = x_.template make<std::uint8_t>(corner_count_);
    x_.run("mark_low", corner_count_, MarkLow{corners_.data(), failed(), flag.data()});
    const Array<std::uint32_t> low = x_.select(flag, corner_count_);
    const std::uint64_t count = low.size();
    patches_ = x_.template make<PatchMeasures>(count);
    low_of_ = x_.template make<std::uint32_t>(corner_count_);
    if (count == 0) return;
    Array<Sphere> probes = x_.template make<Sphere>(count);
    Array<std::uint32_t> set = x_.template make<std::uint32_t>(count);
    x_.run(
        "place_low", count,
        PlaceLow{balls_, corners_.data(), low.data(), probes.data(), set.data(), low_of_.data()});
    const OverlapLists<Executor> near = x_.overlaps(probes, set, failed_.size());
    check_count(near.entries, "pairs of overlapping probes");
    Array<std::uint8_t> doubtful = x_.template make<std::uint8_t>(count);
    x_.run("measure_low", count,
           MeasureLow{balls_,
                      arcs_.data(),
                      shapes_.data(),
                      corners_.data(),
                      {low.data(), near.first.data(), near.other.data(),
                       static_cast<std::uint32_t>(count)},
                      patches_.data(),
                      doubtful.data()});
    decide_patches(low, doubtful);
  }

  void decide_patches(const Array<std::uint32_t>& low, const Array<std::uint8_t>& doubtful) {
    const Array<std::uint32_t> listed = x_.select(doubtful, doubtful.size());
    if (listed.size() == 0) return;
    Array<ProbeCorner> chosen = x_.template make<ProbeCorner>(listed.size());
    x_.run("take_patches", listed.size(),
           TakePatches{listed.data(), low.data(), corners_.data(), chosen.data()});
    const std::vector<ProbeCorner> corners = x_.download(chosen.data(), chosen.size());
    const std::vector<HostBall> near = balls_around_corners(chosen);
    const HostBalls balls{near, balls_.probe};
    std::vector<std::optional<PatchMeasures>> patches(corners.size());
    tbb::parallel_for(std::size_t{0}, corners.size(),
                      [&](std::size_t i) { patches[i] = exact_patch(balls, corners[i]); });
    std::vector<PatchMeasures> made;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      ++result_.host_patches[balls.at(corners[i].name.ball[0]).set];
      if (!patches[i]) fail(balls, corners[i].name.ball[0]);
      made.push_back(patches[i].value_or(PatchMeasures{}));
    }
    const Array<PatchMeasures> uploaded = x_.upload(made);
    x_.run("put_patches", made.size(), PutPatches{listed.data(), uploaded.data(), patches_.data()});
  }

  // The chunks of the sets; they do not depend on who executes the steps.
  std::vector<Chunk> make_chunks() {
    constexpr std::size_t kRows = 256;
    std::vector<Chunk> chunks;
    for (std::size_t set = 0; set + 1 < offsets_.size(); ++set) {
      result_.first_chunk.push_back(chunks.size());
      for (std::size_t begin = offsets_[set]; begin < offsets_[set + 1]; begin += kRows) {
        chunks.push_back({begin, std::min(begin + kRows, offsets_[set + 1])});
      }
    }
    result_.first_chunk.push_back(chunks.size());
    return chunks;
  }

  ElementSums sum(BallRow* out) {
    const std::uint64_t entries = 2 * arc_count_ + 3 * corner_count_;
    check_count(entries, "parts");
    Array<ElementShare> terms = x_.template make<ElementShare>(entries);
    Array<std::uint32_t> key = x_.template make<std::uint32_t>(entries),
                         entry = x_.template make<std::uint32_t>(entries);
    x_.run("arc_terms", arc_count_,
           ArcTerms{balls_, arcs_.data(), shapes_.data(), failed(), home_.data(), terms.data(),
                    key.data(), entry.data()});
    x_.run("corner_terms", corner_count_,
           CornerTerms{balls_, arcs_.data(), shapes_.data(), corners_.data(), patches_.data(),
                       low_of_.data(), failed(), home_.data(), 2 * arc_count_, terms.data(),
                       key.data(), entry.data()});
    x_.sort(key, entry, balls_.size);
    Array<BallRow> rows = x_.template make<BallRow>(balls_.size);
    Array<CheckRow> checks = x_.template make<CheckRow>(balls_.size);
    x_.run("sum_rows", balls_.size,
           SumRows{balls_, key.data(), entry.data(), entries, 2 * arc_count_, terms.data(),
                   home_.data(), failed(), rows.data(), checks.data()});
    const std::vector<Chunk> chunks = make_chunks();
    const Array<Chunk> uploaded = x_.upload(chunks);
    Array<ChunkSum> sums = x_.template make<ChunkSum>(chunks.size());
    x_.run("sum_chunks", chunks.size(),
           SumChunks{uploaded.data(), rows.data(), checks.data(), sums.data()});
    result_.chunks = x_.download(sums.data(), sums.size());
    x_.download_to(out, rows.data(), rows.size());
    result_.failed = x_.download(failed_.data(), failed_.size());
    return std::move(result_);
  }

  Executor& x_;
  const Balls balls_;
  const OverlapLists<Executor>& near_;
  const std::vector<std::size_t>& offsets_;
  Array<Vec3d> home_;
  Array<std::uint8_t> failed_;
  std::uint64_t arc_count_ = 0, corner_count_ = 0;
  Array<Arc> arcs_;
  Array<ProbeCorner> corners_;
  Array<ArcShape> shapes_;
  Array<PatchMeasures> patches_;
  Array<std::uint32_t> low_of_;
  ElementSums result_;
};

}  // namespace vdwmesh::excluded::elements
