// excluded_grid(): an octree over the distance to accessible places. Points are counted in its
// small cells, crossings on lines through its larger ones.
#include "reference/excluded_grid.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <numbers>
#include <utility>

#include "support/dice.hpp"

namespace vdwmesh::reference {
namespace {

using std::size_t;
using Candidates = AccessibleDistance::Candidates;

struct Cell {
  Point lower;
  double edge;

  Point middle() const { return lower + (edge / 2) * Point{{1, 1, 1}}; }
  double reach() const { return edge / 2 * std::numbers::sqrt3; }
  Cell octant(int number) const {
    const double half = edge / 2;
    return {
        lower + half * Point{{double(number & 1), double(number >> 1 & 1), double(number >> 2)}},
        half};
  }
};

// Adds the mean of two independent values times `weight`, and the variance of that mean.
void add_pair(double a, double b, double weight, Estimate& sum) {
  sum.value += weight * (a + b) / 2;
  sum.variance += weight * weight * (a - b) * (a - b) / 4;
}

// A line along an axis, with the sums of |n_k| over its crossings with the surface, by what the
// nearest accessible point lies on.
struct Line {
  size_t axis;
  Point through;
  double contact = 0, saddle = 0, concave = 0;
  std::vector<std::pair<std::uint32_t, double>> shares;  // atom and |n_k| of every crossing

  double all() const { return contact + saddle + concave; }
  Point at(double along) const {
    Point p = through;
    p[axis] = along;
    return p;
  }
};

class Grid {
 public:
  Grid(const std::vector<Ball>& atoms, double probe, const ExcludedGridOptions& options)
      : distance_(atoms, probe), probe_(probe), options_(options), dice_(options.seed) {
    sums_.atom_area.resize(atoms.size());
  }

  ExcludedEstimates run() {
    const Cell whole = root();
    place_lines();
    visit(whole, distance_.all(), 0);
    add_lines();
    return sums_;
  }

 private:
  // A cube of whole line cells around all balls, at a random place, so that nothing is aligned.
  Cell root() {
    Point lower = distance_.grown_balls().front().center, upper = lower;
    for (const Ball& ball : distance_.grown_balls()) {
      for (size_t k = 0; k < 3; ++k) {
        lower[k] = std::min(lower[k], ball.center[k] - ball.radius);
        upper[k] = std::max(upper[k], ball.center[k] + ball.radius);
      }
    }
    const Point size = upper - lower;
    double edge = options_.line_cell;
    while (edge < *std::max_element(size.at.begin(), size.at.end()) + options_.line_cell) {
      edge *= 2;
      ++line_depth_;
      columns_ *= 2;
    }
    for (double& x : lower.at) x -= dice_.real(0, options_.line_cell);
    lower_ = lower;
    return {lower, edge};
  }

  // Two random lines in every column of cells, along every axis.
  void place_lines() {
    for (size_t axis = 0; axis < 3; ++axis) {
      for (size_t column = 0; column < columns_ * columns_; ++column) {
        for (int twice = 0; twice < 2; ++twice) {
          Line line{axis, lower_, 0, 0, 0, {}};
          line.through[(axis + 1) % 3] +=
              options_.line_cell * (static_cast<double>(column % columns_) + dice_.real(0, 1));
          line.through[(axis + 2) % 3] +=
              options_.line_cell * (static_cast<double>(column / columns_) + dice_.real(0, 1));
          lines_.push_back(line);
        }
      }
    }
  }

  // The first of the two lines along `axis` through the cell.
  size_t first_line(const Cell& cell, size_t axis) const {
    const auto place = [&](size_t k) {
      return static_cast<size_t>(std::lround((cell.lower[k] - lower_[k]) / options_.line_cell));
    };
    const size_t column = place((axis + 1) % 3) + columns_ * place((axis + 2) % 3);
    return 2 * (axis * columns_ * columns_ + column);
  }

  void add_lines() {
    const double weight = options_.line_cell * options_.line_cell;
    for (size_t k = 0; k < lines_.size(); k += 2) {
      const Line &a = lines_[k], &b = lines_[k + 1];
      add_pair(a.contact, b.contact, weight, sums_.contact);
      add_pair(a.saddle, b.saddle, weight, sums_.saddle);
      add_pair(a.concave, b.concave, weight, sums_.concave);
      add_pair(a.all(), b.all(), weight, sums_.area);
      add_shares(a, b, weight);
    }
  }

  void add_shares(const Line& a, const Line& b, double weight) {
    std::map<std::uint32_t, std::pair<double, double>> by_atom;
    for (const auto& [atom, slope] : a.shares) by_atom[atom].first += slope;
    for (const auto& [atom, slope] : b.shares) by_atom[atom].second += slope;
    for (const auto& [atom, sums] : by_atom) {
      add_pair(sums.first, sums.second, weight, sums_.atom_area[atom]);
    }
  }

  void visit(const Cell& cell, const Candidates& among, size_t depth) {
    if (kept_.size() <= depth) kept_.emplace_back();
    Candidates& kept = kept_[depth];
    const double reach = cell.reach();
    const double above = distance_.narrow(among, cell.middle(), reach, kept) - probe_;
    if (std::abs(above) > reach) {
      if (above > 0) sums_.volume.value += cell.edge * cell.edge * cell.edge;
      return;
    }
    if (depth == line_depth_) follow_lines(cell, kept);
    const bool is_last = depth + 1 == line_depth_ + static_cast<size_t>(options_.halvings);
    for (int k = 0; k < 8; ++k) {
      if (is_last) {
        count_points(cell.octant(k), kept);
      } else {
        visit(cell.octant(k), kept, depth + 1);
      }
    }
  }

  double above(const Point& at, const Candidates& among) const {
    return distance_.nearest(at, among).distance - probe_;
  }

  double random_along(const Cell& cell) { return dice_.real(0, cell.edge); }

  void count_points(const Cell& cell, const Candidates& among) {
    std::array<double, 2> inside{};
    for (double& one : inside) {
      const double x = random_along(cell), y = random_along(cell), z = random_along(cell);
      const Point at = cell.lower + Point{{x, y, z}};
      one = distance_.nearest(at, among, probe_).distance >= probe_ ? 1 : 0;
    }
    add_pair(inside[0], inside[1], cell.edge * cell.edge * cell.edge, sums_.volume);
  }

  void follow_lines(const Cell& cell, const Candidates& among) {
    for (size_t axis = 0; axis < 3; ++axis) {
      for (size_t twice = 0; twice < 2; ++twice) {
        Line& line = lines_[first_line(cell, axis) + twice];
        const auto place = [&](double along) { return Place{along, above(line.at(along), among)}; };
        search(line, place(cell.lower[axis]), place(cell.lower[axis] + cell.edge), among);
      }
    }
  }

  struct Place {
    double along, above;  // Å: coordinate on the line; distance less probe there
  };

  // The distance changes by no more than the place moves, so two ends of like sign that are far
  // enough from the surface have none between them.
  void search(Line& line, const Place& a, const Place& b, const Candidates& among) const {
    const double step = b.along - a.along, half = a.along + step / 2;
    const bool crosses = (a.above >= 0) != (b.above >= 0);
    if (!crosses && std::abs(a.above) + std::abs(b.above) >= step) return;
    if (step < kShortestStep * options_.line_cell) {
      if (crosses) add_crossing(line, half, among);
      return;
    }
    const Place middle{half, above(line.at(half), among)};
    search(line, a, middle, among);
    search(line, middle, b, among);
  }

  void add_crossing(Line& line, double along, const Candidates& among) const {
    const Point at = line.at(along);
    const NearestAccess nearest = distance_.nearest(at, among);
    const double slope = std::abs(nearest.point[line.axis] - at[line.axis]) / nearest.distance;
    double& sum = nearest.on == NearestOn::sphere ? line.contact
                  : nearest.on == NearestOn::arc  ? line.saddle
                                                  : line.concave;
    sum += slope;
    line.shares.emplace_back(owner(at, nearest, among), slope);
  }

  std::uint32_t owner(const Point& at, const NearestAccess& nearest,
                      const Candidates& among) const {
    const std::vector<std::uint32_t> touched = distance_.touched(nearest.point, among);
    const auto measure = [&](std::uint32_t k) {
      const Ball& ball = distance_.grown_balls()[k];
      const double far = distance(at, ball.center);
      if (touched.size() < 3) return far * far - ball.radius * ball.radius;
      const double share = probe_ / ball.radius;
      return distance(at, nearest.point + share * (ball.center - nearest.point));
    };
    return distance_.atoms()[*std::min_element(
        touched.begin(), touched.end(),
        [&](std::uint32_t a, std::uint32_t b) { return measure(a) < measure(b); })];
  }

  // Of a cell's edge. Two crossings that are nearer to each other are missed, and a crossing is
  // placed so exactly. What that changes is some 1e-5 of the area.
  static constexpr double kShortestStep = 1.0 / 512;

  AccessibleDistance distance_;
  double probe_;
  ExcludedGridOptions options_;
  testing::Dice dice_;
  Point lower_;
  size_t line_depth_ = 0, columns_ = 1;
  std::vector<Line> lines_;
  std::deque<Candidates> kept_;  // by depth
  ExcludedEstimates sums_;
};

}  // namespace

ExcludedEstimates excluded_grid(const std::vector<Ball>& atoms, double probe,
                                const ExcludedGridOptions& options) {
  return Grid(atoms, probe, options).run();
}

}  // namespace vdwmesh::reference
