// joined_cells(): divides space into blocks, triangulates each with what surrounds it, keeps the
// cells that no ball elsewhere can change, and triangulates the rest in one piece.
//
// A cell belongs to the regular triangulation exactly if no ball is in conflict with it. A ball of
// radius r is in conflict with a cell only if its centre is nearer than √(R² + r²) to the centre of
// the cell's orthogonal sphere of squared radius R². So:
// 1. divide() cuts space into blocks of equally many balls, as a k-d tree does.
// 2. triangulate_block() triangulates the balls in a block and those within a margin around it. A
//    cell is settled if all balls that might be in conflict with it are among these. The block
//    keeps the settled cells whose lowest vertex lies in it, so no cell is kept twice.
// 3. Facets that two blocks have in common are paired. The facets left over bound what is not
//    settled: open_balls() are the vertices of these facets, and balls without a settled cell. All
//    other balls have settled cells on all sides, so every cell of the triangulation that is not
//    settled has open balls as vertices alone. No ball is in conflict with it, so it is a cell of
//    the regular triangulation of the open balls too.
// 4. That triangulation has other cells as well, where the settled cells are. The flood from the
//    unsettled sides of the facets left over, which stops at these facets, reaches the cells that
//    are wanted and no others.
// Every facet must then have a cell on both sides, but for the four of the auxiliary points.
#include "complex/joined_cells.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "complex/power_triangulation.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "spheres/box.hpp"

namespace vdwmesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct SpaceBlock {
  Vec3d lower, upper;                // infinite where no other block follows
  std::vector<std::uint32_t> balls;  // indices, ascending
};

Box box_of_centers(const std::vector<std::uint32_t>& indices, const std::vector<Sphere>& balls) {
  Box box = empty_box();
  for (const std::uint32_t i : indices) include(box, balls[i].center);
  return box;
}

// Cuts the block in two of about first : second balls across its longest side. Of balls in the
// cutting plane some may go to either block.
std::pair<SpaceBlock, SpaceBlock> cut(SpaceBlock block, const std::vector<Sphere>& balls,
                                      std::size_t first, std::size_t second) {
  const Box box = box_of_centers(block.balls, balls);
  const Vec3d size = box.upper - box.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto middle = block.balls.begin() +
                      static_cast<std::ptrdiff_t>(block.balls.size() * first / (first + second));
  std::ranges::nth_element(block.balls, middle, {},
                           [&](std::uint32_t i) { return std::pair(balls[i].center[axis], i); });
  SpaceBlock low{block.lower, block.upper, {block.balls.begin(), middle}};
  SpaceBlock high{block.lower, block.upper, {middle, block.balls.end()}};
  low.upper[axis] = high.lower[axis] = balls[*middle].center[axis];
  return {std::move(low), std::move(high)};
}

void divide(SpaceBlock block, const std::vector<Sphere>& balls, std::size_t count,
            std::vector<SpaceBlock>& blocks) {
  if (count == 1) {
    std::ranges::sort(block.balls);
    blocks.push_back(std::move(block));
    return;
  }
  auto [low, high] = cut(std::move(block), balls, count / 2, count - count / 2);
  divide(std::move(low), balls, count / 2, blocks);
  divide(std::move(high), balls, count - count / 2, blocks);
}

// Whether the block with this margin around it has the centre of every ball that might be in
// conflict with the cell. `a` to `d` are its balls, of which none is an auxiliary point.
//
// With the vectors ab, ac, ad from the centre of a, and w_b = |ab|² + r_a² - r_b² and so on, the
// centre of the orthogonal sphere is a + n / (2 D) with D = det(ab, ac, ad) and n = w_b ac×ad + w_c
// ad×ab + w_d ab×ac. Rounding changes n by less than 64 ε N, N being the sum of |w_b| |ac| |ad| and
// so on, and D by less than 64 ε |ab| |ac| |ad|. If the latter is at most 10⁶ D, the centre is
// wrong by less than 10⁻⁷ N / (2 D), and its squared distance from a by less than 10⁻⁶ (N / (2
// D))². Flatter cells are not settled.
bool is_settled(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d,
                const SpaceBlock& block, double margin) {
  const Vec3d ab = b.center - a.center, ac = c.center - a.center, ad = d.center - a.center;
  const auto offset = [&](const Sphere& s, const Vec3d& to) {
    return squared_norm(to) + (a.radius - s.radius) * (a.radius + s.radius);
  };
  const double wb = offset(b, ab), wc = offset(c, ac), wd = offset(d, ad);
  const double lb = norm(ab), lc = norm(ac), ld = norm(ad);
  const Vec3d cd = cross(ac, ad);
  const double determinant = dot(ab, cd);
  if (!(1e6 * determinant > lb * lc * ld)) return false;
  const double scale = 1 / (2 * determinant);
  const Vec3d x = scale * (wb * cd + wc * cross(ad, ab) + wd * cross(ab, ac));
  const double size =
      scale * (std::abs(wb) * lc * ld + std::abs(wc) * ld * lb + std::abs(wd) * lb * lc);
  // R² + r² of the largest radius, which is below 1.
  const double squared = squared_norm(x) - a.radius * a.radius + 1 + 1e-6 * size * size;
  const double reach = std::sqrt(std::max(squared, 0.0)) + 1e-7 * size;
  for (int axis = 0; axis < 3; ++axis) {
    const double center = a.center[axis] + x[axis];
    const double slack = reach + 1e-12 * (std::abs(a.center[axis]) + std::abs(x[axis]));
    if (!(center - slack > block.lower[axis] - margin)) return false;
    if (!(center + slack < block.upper[axis] + margin)) return false;
  }
  return true;
}

// A margin of 1.8 times the mean distance of balls settles all but one ball in a hundred of a large
// molecule in two blocks, and all but six in a hundred in sixteen. Less would leave more to the
// triangulation of the rest, which runs on one core; more would have more balls triangulated twice.
// Small blocks have more surface, and a wider margin costs less than what it settles: of 4,558
// balls in eight blocks 1.8 leaves 1,050 to the rest, and 2.3 leaves 561. Where balls are crowded,
// the reach of a cell is that of the largest balls, which have radii of nearly 1.
double margin_of(const SpaceBlock& block, const std::vector<Sphere>& balls) {
  constexpr std::size_t kSmallBlock = 2500;
  const Box box = box_of_centers(block.balls, balls);
  const Vec3d size = box.upper - box.lower;
  const double spacing =
      std::cbrt(size.x * size.y * size.z / static_cast<double>(block.balls.size()));
  const double widening = block.balls.size() < kSmallBlock ? 2.3 : 1.8;
  return std::max(widening * spacing, 1.5);
}

bool is_within(const Vec3d& center, const SpaceBlock& block, double margin) {
  for (int axis = 0; axis < 3; ++axis) {
    if (center[axis] < block.lower[axis] - margin || center[axis] > block.upper[axis] + margin) {
      return false;
    }
  }
  return true;
}

// The balls in the block and those within the margin around it.
std::vector<std::uint32_t> list_near(const SpaceBlock& block, double margin,
                                     const std::vector<Sphere>& balls) {
  std::vector<std::uint32_t> near;
  for (std::uint32_t i = 0; i < balls.size(); ++i) {
    if (is_within(balls[i].center, block, margin)) near.push_back(i);
  }
  return near;
}

// Whether a block with its margin has nearly all balls, as it has if one ball is larger than all
// others together. Then blocks only repeat each other's work.
bool is_nearly_all(const SpaceBlock& block, const std::vector<Sphere>& balls) {
  return 4 * list_near(block, margin_of(block, balls), balls).size() > 3 * balls.size();
}

// The settled cells whose lowest vertex is a ball of the block.
RegularCells triangulate_block(const std::vector<Sphere>& balls,
                               const std::array<Vec3d, 4>& auxiliary, const SpaceBlock& block,
                               std::vector<std::uint8_t>& has_vertex, std::uint64_t memory_limit,
                               Monitor* monitor) {
  const double margin = margin_of(block, balls);
  const std::vector<std::uint32_t> near = list_near(block, margin, balls);
  std::vector<std::uint8_t> is_own(balls.size(), 0), appears(balls.size(), 0);
  for (const std::uint32_t i : block.balls) is_own[i] = 1;
  const TakesCell takes = [&](const CellVertices& v) {
    return v[2] < balls.size() && v[3] < balls.size() && is_own[v[0]] &&
           is_settled(balls[v[0]], balls[v[1]], balls[v[2]], balls[v[3]], block, margin);
  };
  RegularCells cells = regular_cells(balls, auxiliary, near, takes, appears, memory_limit, monitor);
  for (const std::uint32_t i : block.balls) has_vertex[i] = appears[i];
  return cells;
}

// A facet that has a cell on one side only, as yet.
struct OpenFacet {
  std::array<std::uint32_t, 3> vertices;  // ascending
  bool odd;                               // the permutation from kFacetVertices to this order
  std::uint32_t cell, slot;               // opposite to that vertex of that cell
};

OpenFacet facet_of(const CellVertices& cell, std::uint32_t number, std::uint32_t slot) {
  const auto& k = kFacetVertices[slot];
  OpenFacet f{{cell[k[0]], cell[k[1]], cell[k[2]]}, false, number, slot};
  f.odd = sort_is_odd(f.vertices);
  return f;
}

class Joiner {
 public:
  Joiner(const std::vector<Sphere>& balls, const std::array<Vec3d, 4>& auxiliary,
         std::uint64_t memory_limit, Monitor* monitor)
      : balls_(balls),
        auxiliary_(auxiliary),
        memory_limit_(memory_limit),
        monitor_(monitor),
        has_vertex_(balls.size(), 0) {}

  RegularCells run(std::vector<SpaceBlock> blocks) && {
    std::vector<RegularCells> parts(blocks.size());
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
      parts[i] =
          triangulate_block(balls_, auxiliary_, blocks[i], has_vertex_, memory_limit_, monitor_);
    });
    join(parts);
    pair_facets();
    add_rest();
    return std::move(out_);
  }

 private:
  // Puts the cells of all blocks one behind the other, with room for those that are not settled.
  void join(std::vector<RegularCells>& parts) {
    std::vector<std::size_t> first{0};
    for (const RegularCells& part : parts) first.push_back(first.back() + part.cells.size());
    if (first.back() >= kNoIndex) {
      throw LimitExceeded("the triangulation has more than 2^32 cells");
    }
    check_cells(first.back(), balls_.size(), memory_limit_);
    constexpr std::size_t kRest = 8;  // room for one cell in so many that is not settled
    out_.cells.reserve(first.back() + first.back() / kRest);
    out_.neighbors.reserve(first.back() + first.back() / kRest);
    out_.cells.resize(first.back());
    out_.neighbors.resize(first.back());
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
      append(std::exchange(parts[i], {}), static_cast<std::uint32_t>(first[i]));
    });
  }

  void append(const RegularCells& part, std::uint32_t first) {
    std::copy(part.cells.begin(), part.cells.end(), out_.cells.begin() + first);
    for (std::size_t c = 0; c < part.cells.size(); ++c) {
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint32_t n = part.neighbors[c][k];
        out_.neighbors[first + c][k] = n == kNoIndex ? n : first + n;
      }
    }
  }

  void link(const OpenFacet& a, const OpenFacet& b) {
    out_.neighbors[a.cell][a.slot] = b.cell;
    out_.neighbors[b.cell][b.slot] = a.cell;
  }

  void add_unpaired(std::uint32_t c, std::vector<OpenFacet>& facets) const {
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (out_.neighbors[c][k] == kNoIndex) facets.push_back(facet_of(out_.cells[c], c, k));
    }
  }

  // Fills open_ with the facets that have no cell on one side, sorted, after linking those that two
  // blocks have in common.
  void pair_facets() {
    std::vector<OpenFacet> all =
        collect<OpenFacet>(out_.cells.size(), [&](std::size_t c, std::vector<OpenFacet>& facets) {
          add_unpaired(static_cast<std::uint32_t>(c), facets);
        });
    tbb::parallel_sort(all.begin(), all.end(), [](const OpenFacet& a, const OpenFacet& b) {
      return std::tie(a.vertices, a.cell) < std::tie(b.vertices, b.cell);
    });
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i + 1 < all.size() && all[i].vertices == all[i + 1].vertices) {
        link(all[i], all[i + 1]);
        ++i;
      } else {
        open_.push_back(all[i]);
      }
    }
    first_open_.assign(balls_.size() + 1, 0);
    for (const OpenFacet& f : open_) ++first_open_[f.vertices[0] + 1];
    std::partial_sum(first_open_.begin(), first_open_.end(), first_open_.begin());
  }

  // The open facet with the same vertices, or null.
  const OpenFacet* open_facet(const OpenFacet& f) const {
    if (f.vertices[0] >= balls_.size()) return nullptr;
    const auto begin = open_.begin() + first_open_[f.vertices[0]],
               end = open_.begin() + first_open_[f.vertices[0] + 1];
    const auto found = std::ranges::lower_bound(begin, end, f.vertices, {}, &OpenFacet::vertices);
    return found != end && found->vertices == f.vertices ? &*found : nullptr;
  }

  std::vector<std::uint32_t> open_balls() const {
    std::vector<std::uint8_t> is_open = has_vertex_;
    for_each_index(out_.cells.size(), [&](std::size_t c) {
      for (const std::uint32_t v : out_.cells[c]) {
        std::atomic_ref(is_open[v]).store(0, std::memory_order_relaxed);
      }
    });
    for (const OpenFacet& f : open_) {
      for (const std::uint32_t v : f.vertices) is_open[v] = 1;
    }
    std::vector<std::uint32_t> balls;
    for (std::uint32_t i = 0; i < is_open.size(); ++i) {
      if (is_open[i]) balls.push_back(i);
    }
    return balls;
  }

  // Adds the cells that are not settled. They are numbered in the order of the flood.
  void add_rest() {
    std::vector<std::uint8_t> unused(balls_.size());
    const RegularCells rest = regular_cells(
        balls_, auxiliary_, open_balls(), [](const CellVertices&) { return true; }, unused,
        memory_limit_, monitor_);
    const auto first = static_cast<std::uint32_t>(out_.cells.size());
    std::vector<std::uint32_t> number(rest.cells.size(), kNoIndex), reached;
    const auto reach = [&](std::uint32_t c) {
      if (number[c] != kNoIndex) return;
      number[c] = first + static_cast<std::uint32_t>(reached.size());
      reached.push_back(c);
    };
    for (std::uint32_t c = 0; c < rest.cells.size(); ++c) {
      for (std::uint32_t k = 0; k < 4; ++k) {
        const OpenFacet f = facet_of(rest.cells[c], c, k);
        const OpenFacet* const open = open_facet(f);
        if (rest.neighbors[c][k] == kNoIndex || (open != nullptr && open->odd != f.odd)) reach(c);
      }
    }
    check_cells(out_.cells.size() + rest.cells.size(), balls_.size(), memory_limit_);
    std::size_t hull = 0, met = 0;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const std::uint32_t c = reached[i];
      out_.cells.push_back(rest.cells[c]);
      out_.neighbors.push_back({kNoIndex, kNoIndex, kNoIndex, kNoIndex});
      for (std::uint32_t k = 0; k < 4; ++k) {
        const OpenFacet f = facet_of(rest.cells[c], number[c], k);
        if (const OpenFacet* const open = open_facet(f)) {
          met += open->odd != f.odd;
          link(f, *open);
        } else if (rest.neighbors[c][k] == kNoIndex) {
          ++hull;
        } else {
          reach(rest.neighbors[c][k]);
          out_.neighbors.back()[k] = number[rest.neighbors[c][k]];
        }
      }
    }
    if (met != open_.size() || hull != 4) {
      throw InternalError("the blocks of a regular triangulation do not fit together");
    }
  }

  const std::vector<Sphere>& balls_;
  const std::array<Vec3d, 4>& auxiliary_;
  const std::uint64_t memory_limit_;
  Monitor* const monitor_;
  std::vector<std::uint8_t> has_vertex_;  // by ball: not hidden in the triangulation of its block
  RegularCells out_;
  std::vector<OpenFacet> open_;
  std::vector<std::uint32_t> first_open_;  // by lowest vertex: its first facet in open_
};

}  // namespace

RegularCells joined_cells(const std::vector<Sphere>& balls, const std::array<Vec3d, 4>& auxiliary,
                          std::size_t blocks, std::uint64_t memory_limit, Monitor* monitor) {
  std::vector<std::uint32_t> all(balls.size());
  std::iota(all.begin(), all.end(), std::uint32_t{0});
  const Vec3d everywhere{kInfinity, kInfinity, kInfinity};
  std::vector<SpaceBlock> divided;
  divide({-1.0 * everywhere, everywhere, all}, balls,
         std::max<std::size_t>(1, std::min(blocks, balls.size())), divided);
  const auto repeats = [&](const SpaceBlock& block) { return is_nearly_all(block, balls); };
  if (divided.size() == 1 || std::ranges::any_of(divided, repeats)) {
    std::vector<std::uint8_t> unused(balls.size());
    return regular_cells(
        balls, auxiliary, all, [](const CellVertices&) { return true; }, unused, memory_limit,
        monitor);
  }
  return Joiner(balls, auxiliary, memory_limit, monitor).run(std::move(divided));
}

}  // namespace vdwmesh
