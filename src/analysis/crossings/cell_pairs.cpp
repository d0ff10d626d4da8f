// The tests of analysis/crossings/cell_pairs.hpp: first of the vertices, then of the triangles,
// cell by cell, and of the pairs within each cell. They take an eighth of the time of the tree:
// without them a report on a mesh that is not refined takes 1.4 times as long.
//
// A place on the lattice is one word: 20 bits for each lattice index, x lowest, and above each of
// them a bit that is free. The words of grid edges have the lower end there, and set the free bit
// of the axis along which they run.
#include "analysis/crossings/cell_pairs.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <mutex>

#include "analysis/crossings/facet_pair_exact.hpp"
#include "core/blocks.hpp"
#include "core/fixed_blocks.hpp"
#include "core/lanes/multiversion.hpp"
#include "extract/bricks/brick.hpp"
#include "extract/bricks/case_table.hpp"

namespace vdwmesh {
namespace {

using Word = std::uint64_t;

constexpr int kIndexBits = 20, kFieldBits = kIndexBits + 1;
constexpr Word kOnes = Word{1} | Word{1} << kFieldBits | Word{1} << 2 * kFieldBits;
constexpr Word kFree = kOnes << kIndexBits;
constexpr Word kLocal = kOnes * (kBrickSide - 1);  // the place within a brick
constexpr Word kNoEdge = ~Word{0};
constexpr double kMostIndex = (1 << kIndexBits) - 2;

// Whether a cell comes after another one in the order of marching cubes: by brick, and within it
// by place.
bool rises(Word before, Word after) {
  const Word brick_before = before & ~kLocal, brick_after = after & ~kLocal;
  return brick_before != brick_after ? brick_before < brick_after : before < after;
}

// The planes of the lattice.
class Planes {
 public:
  explicit Planes(const GridSpec& grid) : grid_(grid), inverse_(1 / grid.spacing) {}

  // The grid edge strictly within which a point lies, or kNoEdge. The index of a plane depends on
  // its coordinate alone; if rounding makes it another one, the point is found to have no edge.
  // Indices stay where a word has room for them and for the next one: beyond, and for what is not a
  // number, neither comparison holds. Index 0 is the plane of virtual nodes, where no vertex is.
  Word edge_of(const Vec3d& p) const {
    Word edge = 0;
    bool holds = true;
    for (int axis = 0; axis < 3; ++axis) {
      const double x = p[axis], nearest = std::nearbyint((x - grid_.origin[axis]) * inverse_) + 1;
      const auto index = static_cast<std::int64_t>(std::min(std::max(1.0, nearest), kMostIndex));
      const double plane = lattice_coordinate(grid_, axis, index);
      const Word between = x != plane;
      const std::int64_t lower = index - (x < plane ? 1 : 0);
      const double below = lattice_coordinate(grid_, axis, lower),
                   above = lattice_coordinate(grid_, axis, lower + 1);
      holds &= !between || (below < x && x < above);
      edge |= (static_cast<Word>(lower) | between << kIndexBits) << kFieldBits * axis;
    }
    return holds && std::has_single_bit(edge & kFree) ? edge : kNoEdge;
  }

 private:
  GridSpec grid_;
  double inverse_;
};

// The edges of a cell, numbered as in case_table.hpp. What is looked up of them is by the six bits
// that place_bits() makes of an edge's word.
constexpr std::uint32_t kCellEdges = 12, kAllEdges = (1u << kCellEdges) - 1;
constexpr std::uint8_t kNone = kCellEdges;  // stands for what is no edge of the cell

// Of each field of a word the lowest bit and the free one: for an edge, less the cell's word, the
// offset and whether the edge runs along this axis. Field f has bits 2 f and 2 f + 1.
std::uint32_t place_bits(Word edge) {
  const Word bits = (edge & kOnes) | (edge & kFree) >> (kIndexBits - 1);
  return static_cast<std::uint32_t>(bits | bits >> (kFieldBits - 2) |
                                    bits >> 2 * (kFieldBits - 2)) &
         63;
}

constexpr std::array<std::uint8_t, 64> kEdgeAt = [] {
  std::array<std::uint8_t, 64> all{};
  all.fill(kNone);
  for (int e = 0; e < static_cast<int>(kCellEdges); ++e) {
    const CellEdge c = cell_edge(e);
    all[static_cast<std::size_t>((c.x | c.y << 2 | c.z << 4) | 2 << 2 * c.axis)] =
        static_cast<std::uint8_t>(e);
  }
  return all;
}();

// For two opposite edges of a face, a mask of the other two.
constexpr std::array<std::array<std::uint16_t, kNone + 1>, kNone + 1> kAcross = [] {
  std::array<std::array<std::uint16_t, kNone + 1>, kNone + 1> all{};
  const auto in_face = [](std::uint32_t edge, int axis, int side) {
    const CellEdge e = cell_edge(static_cast<int>(edge));
    const int offset[3] = {e.x, e.y, e.z};
    return e.axis != axis && offset[axis] == side;
  };
  for (int face = 0; face < 6; ++face) {
    std::uint32_t of_face = 0;
    for (std::uint32_t e = 0; e < kCellEdges; ++e) {
      of_face |= in_face(e, face / 2, face % 2) ? 1u << e : 0u;
    }
    for (std::uint32_t a = 0; a < kCellEdges; ++a) {
      for (std::uint32_t b = 0; b < kCellEdges; ++b) {
        const bool opposite = a != b && a / 4 == b / 4 && (of_face >> a & of_face >> b & 1) != 0;
        if (opposite) all[a][b] = static_cast<std::uint16_t>(of_face & ~(1u << a | 1u << b));
      }
    }
  }
  return all;
}();

// The cell on whose edges three vertices lie, and which edges these are.
struct Placed {
  Word cell = 0;
  std::uint16_t edges = 0;   // a mask
  std::uint16_t across = 0;  // a mask of those that must have no vertex
  bool holds = false;
};

// The cell's indices are the least ones of the vertices. lower(u, v) takes 1 from each index of u
// that is above that of v; by more than 1 it must not be, as is seen from the offsets.
Placed place(Word a, Word b, Word c) {
  const Word a0 = a & ~kFree, b0 = b & ~kFree, c0 = c & ~kFree;
  const auto lower = [](Word u, Word v) { return u - (~((v | kFree) - u) >> kIndexBits & kOnes); };
  const Word cell = lower(lower(a0, b0), c0);
  const Word offsets = (a0 - cell) | (b0 - cell) | (c0 - cell);
  const auto edge = [&](Word v) { return kEdgeAt[place_bits(v - cell)]; };
  const std::uint8_t e[3] = {edge(a), edge(b), edge(c)};
  const std::uint32_t edges = (1u << e[0] | 1u << e[1] | 1u << e[2]) & kAllEdges;
  return {
      cell, static_cast<std::uint16_t>(edges),
      static_cast<std::uint16_t>(kAcross[e[0]][e[1]] | kAcross[e[1]][e[2]] | kAcross[e[2]][e[0]]),
      (offsets & ~kOnes) == 0 && std::popcount(edges) == 3};
}

// The mesh, and the grid edges of its vertices.
class PlacedMesh {
 public:
  explicit PlacedMesh(const IndexedMesh& mesh) : mesh_(mesh), edge_(mesh.vertex_count()) {}

  // Finds the edges of all vertices; returns whether there is one for each.
  bool place_vertices(const Planes& planes) {
    const std::size_t count = edge_.size();
    // Vertices that a subdivision has made come last.
    if (count == 0 || planes.edge_of(mesh_.positions[count - 1]) == kNoEdge) return false;
    return sum_all(count, [&](std::size_t v, std::uint64_t& failures) {
             edge_[v] = planes.edge_of(mesh_.positions[v]);
             failures += edge_[v] == kNoEdge ? 1 : 0;
           }) == 0;
  }

  Placed place_of(std::size_t triangle) const {
    const Triangle& v = mesh_.triangles[triangle];
    return place(edge_[v[0]], edge_[v[1]], edge_[v[2]]);
  }
  Facet facet(std::size_t triangle) const {
    const Triangle& v = mesh_.triangles[triangle];
    return make_facet(v, mesh_.positions[v[0]], mesh_.positions[v[1]], mesh_.positions[v[2]]);
  }
  std::size_t triangle_count() const { return mesh_.triangles.size(); }
  std::size_t vertex_count() const { return edge_.size(); }

 private:
  const IndexedMesh& mesh_;
  Buffer<Word> edge_;  // of each vertex
};

// What is found in some cells.
struct CellsFound {
  bool hold = true;
  std::uint64_t edges = 0;  // that have vertices, of each cell
  TrianglePairs pairs;
};

// Appends the pairs of the `count` triangles of a cell that intersect. None of them is flat.
void join_cell(const PlacedMesh& mesh, std::size_t first, std::size_t count, TrianglePairs& found) {
  std::array<Facet, kMaxCaseTriangles> facet;
  for (std::size_t i = 0; i < count; ++i) {
    facet[i] = mesh.facet(first + i);
    for (std::size_t j = 0; j < i; ++j) {
      if (!do_intersect(facet[j], facet[i])) continue;
      found.push_back(
          {static_cast<std::uint32_t>(first + j), static_cast<std::uint32_t>(first + i)});
    }
  }
}

// Looks at the cells whose first triangles are from `first` to `end`. Cells with more triangles
// than marching cubes makes do not hold.
VDWMESH_MULTIVERSION CellsFound search_cells(const PlacedMesh& mesh, std::size_t first,
                                             std::size_t end) {
  CellsFound found;
  Placed next = mesh.place_of(first);
  if (first > 0) {
    const Placed before = mesh.place_of(first - 1);
    while (next.cell == before.cell && ++first < end) next = mesh.place_of(first);
  }
  while (first < end && found.hold) {
    const Word cell = next.cell;
    std::uint32_t edges = 0, across = 0;
    std::size_t count = 0;
    do {
      found.hold &= next.holds && count < kMaxCaseTriangles;
      edges |= next.edges;
      across |= next.across;
      ++count;
      if (first + count == mesh.triangle_count()) break;
      next = mesh.place_of(first + count);
    } while (next.cell == cell && found.hold);
    found.hold &= (edges & across) == 0;
    found.hold &= first + count == mesh.triangle_count() || rises(cell, next.cell);
    found.edges += static_cast<std::uint64_t>(std::popcount(edges));
    if (found.hold && count > 1) join_cell(mesh, first, count, found.pairs);
    first += count;
  }
  return found;
}

}  // namespace

std::optional<TrianglePairs> pairs_within_cells(const IndexedMesh& mesh, const GridSpec& grid,
                                                Monitor* monitor) {
  const Planes planes(grid);
  if (mesh.triangles.empty()) return std::nullopt;
  PlacedMesh placed(mesh);
  if (!placed.place_vertices(planes)) return std::nullopt;
  CellsFound all;
  std::mutex guard;
  const std::size_t count = placed.triangle_count();
  begin_stage(monitor, "self-intersections", block_count(count, kIndicesPerBlock));
  for_each_block(
      count, kIndicesPerBlock,
      [&](std::size_t, std::size_t first, std::size_t end) {
        const CellsFound found = search_cells(placed, first, end);
        const std::lock_guard lock(guard);
        all.hold &= found.hold;
        all.edges += found.edges;
        all.pairs.insert(all.pairs.end(), found.pairs.begin(), found.pairs.end());
      },
      monitor);
  if (!all.hold || all.edges != 4 * placed.vertex_count()) return std::nullopt;
  return std::move(all.pairs);
}

}  // namespace vdwmesh
