// cell_boundary(): cuts the power cell of every ball, as arc_measures() does, and reads corners and
// arcs from it.
//
// An edge of the cell that leaves the ball has a corner there. On the circle of a face, arcs and
// the parts that other balls cover take turns. So the arc that begins at a corner is found by
// walking counter-clockwise along the edges of the face, which lie outside of the ball there, to
// the next edge with a corner. All of this is read from the links of the cell, without coordinates.
// Rounding only decides what the cell is, and where it might decide wrongly there is a doubt
// (doubts.hpp).
//
// A ball that BallCaps finds buried has no arcs and no corners, and raises no doubt itself.
// Rounding may have decided that wrongly, but then another ball has a doubt that leads to this one:
// 1. Ball i is found buried by ball j if the computed cosine of j's cap on i is at most -1. The
//    radii enter by the exact sign of their difference, so r_j > r_i. The cosine is a quotient of
//    d² + (r_i - r_j)(r_i + r_j), where |r_i - r_j| is nearly d, so its error is some ε (r_i + r_j)
//    / r_i, with ε = 1e-15. It follows that i sticks out of j by a few ε d at most.
// 2. Let j be buried by k, and so on. Radii rise, so the chain ends in a ball m that is not found
//    buried. Each ball sticks out of the next one by a few ε times their distance at most, and each
//    distance is about the difference of the radii. So all balls of the chain stick out of m by a
//    few ε (r_m - r) at most, with r their radius.
// 3. If m does cover i, then i is buried, and nothing was wrong. If not, the distance d of their
//    centres is more than r_m - r_i, so i sticks out of m by a few ε d at most. The cosine of i's
//    cap on m is then 1, but for a few ε, which is far less than kTouching: m is nearly tangent.
// 4. So m is in doubt, i touches it, and arrange() takes the rows of all balls that touch one in
//    doubt from a triangulation.
#include "measures/arcs/boundary_rows.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <optional>

#include "core/fixed_blocks.hpp"
#include "core/lanes/multiversion.hpp"
#include "measures/arcs/ball_caps.hpp"
#include "measures/arcs/cut_ball.hpp"

namespace vdwmesh {
namespace {

using arcs::BallMeasurer;
using arcs::CellView;
using arcs::EdgeEnd;

// One end of an arc on the circle of a plane.
struct CircleEnd {
  std::uint32_t plane;
  bool starts;
  EdgeEnd edge;  // as BallMeasurer lists it
  ExposedCorner corner;
};

// Reads the cell of one ball after another and keeps its memory.
class CellReader {
 public:
  // Appends what the ball of CutBall has, as the ball with this number; number_of(plane) is the
  // number of the ball behind a plane. Returns false if the cell makes no sense.
  template <class NumberOf>
  bool read(const arcs::CutBall& cut, std::uint32_t ball, const NumberOf& number_of,
            BoundaryRows& out) {
    const BallMeasurer& measurer = cut.measurer();
    ends_.clear();
    for (const BallMeasurer::PatchCorner& c : measurer.corners()) {
      const auto [from, to, a, b] = BallMeasurer::edge_of(cut.cell(), c.edge);
      if (std::min(a, b) < arcs::kWalls) return false;
      const ExposedCorner corner =
          exposed_corner({ball, number_of(a), number_of(b)}, c.direction > 0 ? 0 : 1);
      if (corner.balls[0] == ball) out.corners.push_back(corner);
      if (number_of(a) > ball) ends_.push_back({a, c.direction > 0, c.edge, corner});
      if (number_of(b) > ball) ends_.push_back({b, c.direction < 0, c.edge, corner});
    }
    for (const std::uint32_t plane : measurer.planes()) {
      const BallMeasurer::CellFace& face = measurer.face(plane);
      if (plane < arcs::kWalls || !face.meets_ball()) continue;
      out.neighbors.push_back(number_of(plane));
      if (face.whole && number_of(plane) > ball) {
        out.arcs.push_back({{ball, number_of(plane)}, true, {}, {}});
      }
    }
    return read_arcs(cut.cell(), ball, number_of, out);
  }

 private:
  // Joins the starts and ends on each circle to arcs.
  template <class NumberOf>
  bool read_arcs(const CellView& cell, std::uint32_t ball, const NumberOf& number_of,
                 BoundaryRows& out) {
    std::sort(ends_.begin(), ends_.end(), [](const CircleEnd& a, const CircleEnd& b) {
      return a.plane != b.plane ? a.plane < b.plane : a.starts > b.starts;
    });
    for (std::size_t begin = 0, end = 0; begin < ends_.size(); begin = end) {
      while (end < ends_.size() && ends_[end].plane == ends_[begin].plane) ++end;
      const std::span<const CircleEnd> circle(&ends_[begin], end - begin);
      const auto starts = static_cast<std::size_t>(
          std::ranges::count_if(circle, [](const CircleEnd& e) { return e.starts; }));
      if (2 * starts != circle.size()) return false;
      const auto stops = circle.subspan(starts);
      for (const CircleEnd& start : circle.first(starts)) {
        const CircleEnd* const stop = starts == 1 ? &stops[0] : next_end(cell, start, stops);
        if (stop == nullptr) return false;
        out.arcs.push_back({{ball, number_of(start.plane)}, false, start.corner, stop->corner});
      }
    }
    return true;
  }

  // The end of the arc that begins at `start`, or null if the links lead nowhere. Seen from the
  // vertex at which the walk leaves an edge, the next edge of the face leaves the other plane of
  // the edge before. The first edge is left at its end outside of the ball beyond the corner: at
  // the other end of the edge that BallMeasurer lists if an arc of its second plane starts there.
  static const CircleEnd* next_end(const CellView& cell, const CircleEnd& start,
                                   std::span<const CircleEnd> stops) {
    const auto [from, to, a, b] = BallMeasurer::edge_of(cell, start.edge);
    EdgeEnd at = start.plane == b ? cell.twin[start.edge] : start.edge;
    std::uint32_t other = start.plane == b ? a : b;
    for (std::uint32_t steps = 0; steps <= cell.vertex_count; ++steps) {
      const std::uint32_t vertex = arcs::vertex_of(at);
      std::uint32_t side = 1;
      while (side <= 3 && cell.plane_left[arcs::end_of(vertex, side)] != other) ++side;
      if (side > 3) return nullptr;
      const EdgeEnd next = arcs::end_of(vertex, side);
      const EdgeEnd listed = std::min(next, cell.twin[next]);
      const auto stop = std::ranges::find(stops, listed, &CircleEnd::edge);
      if (stop != stops.end()) return &*stop;
      other = cell.plane_left[at];
      at = cell.twin[next];
    }
    return nullptr;
  }

  std::vector<CircleEnd> ends_;
};

// Memory of one thread.
struct ReadingSpace {
  arcs::BallCaps caps;
  arcs::CutBall ball;
  CellReader reader;
};

// Reads the row of one ball and returns its exposed area, or nothing if there is a doubt.
std::optional<double> read_ball(const CellListView& list, ListPlace place, ReadingSpace& work,
                                BoundaryRows& out) {
  if (!work.caps.find(list, place, arcs::kMostNear))
    return 0.0;  // buried: without a doubt, as the head says
  if (work.caps.is_crowded()) return std::nullopt;
  const arcs::BallMeasures m = work.ball.measure(work.caps.caps());
  if (m.doubts != 0 || work.caps.is_nearly_tangent()) return std::nullopt;
  const auto number_of = [&](std::uint32_t plane) {
    return list.id[work.caps.neighbors()[work.ball.cap_of(plane)]];
  };
  if (work.ball.measurer().has_faces() &&
      !work.reader.read(work.ball, list.id[place], number_of, out)) {
    return std::nullopt;
  }
  const double r = list.spheres[place].radius;
  return m.area * r * r;
}

// The balls of one block.
VDWMESH_MULTIVERSION void read_balls(const CellListView& list, std::span<const ListPlace> places,
                                     std::size_t first, ReadingSpace& work, CellBoundary& out) {
  BoundaryRows& rows = out.rows[first / kBallsPerRows];
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::optional<double> area = read_ball(list, places[i], work, rows);
    if (!area) rows.drop_row();
    rows.end_row();
    out.areas[first + i] = area.value_or(0);
    out.is_doubtful[first + i] = !area;
  }
}

}  // namespace

void BoundaryRows::drop_row() {
  corners.resize(ends_.back()[0]);
  arcs.resize(ends_.back()[1]);
  neighbors.resize(ends_.back()[2]);
}

CellBoundary cell_boundary(const CellListView& list, Monitor* monitor) {
  const std::size_t count = list.size;
  Buffer<ListPlace> places(count);  // by ball
  for_each_index(count, [&](std::size_t i) {
    const auto place = static_cast<ListPlace>(i);
    places[list.id[place]] = place;
  });
  CellBoundary out{std::vector<BoundaryRows>(block_count(count, kBallsPerRows)),
                   std::vector<std::uint8_t>(count), std::vector<double>(count)};
  tbb::enumerable_thread_specific<ReadingSpace> spaces;
  for_each_block(count, kBallsPerRows, [&](std::size_t, std::size_t first, std::size_t end) {
    advance(monitor, 0);
    read_balls(list, std::span(places).subspan(first, end - first), first, spaces.local(), out);
  });
  return out;
}

}  // namespace vdwmesh
