// Marching cubes over bricks on the CPU, for anything that knows the node signs of a brick and the
// vertex on an edge: a Surface has visit(BrickIndex), signs(BrickSigns&) and vertex(CrossedEdge).
// Inlined whole into the loops that core/multiversion.hpp compiles twice.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "extract/brick_numbering.hpp"
#include "extract/case_table.hpp"
#include "extract/extractor.hpp"
#include "extract/surface_vertex.hpp"

namespace vdwmesh {

inline void count_triangles(const BrickGeometry& geometry, const CaseTable& table,
                            ActiveBrick& brick) {
  brick.triangles = 0;
  brick.clipped_cells = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      brick.row_triangles[z * kBrickSide + y] = static_cast<std::uint16_t>(brick.triangles);
      const std::uint32_t mixed = mixed_cells(brick.signs, y, z);
      for (std::uint32_t cells = mixed; cells != 0; cells &= cells - 1) {
        brick.triangles += table.count(cell_case(brick.signs, std::countr_zero(cells), y, z));
      }
      brick.clipped_cells +=
          static_cast<std::uint32_t>(count_bits(mixed & border_cells(geometry, y, z)));
    }
  }
}

inline void count_vertices(ActiveBrick& brick) {
  int vertices = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      brick.row_vertices[z * kBrickSide + y] = static_cast<std::uint16_t>(vertices);
      vertices += vertex_count(row_crossings(brick.signs, y, z));
    }
  }
  brick.vertices = static_cast<std::uint32_t>(vertices);
}

// Appends those of the bricks that hold surface.
template <class Surface>
void count_bricks(Surface& surface, const GridSpec& grid, std::span<const std::uint64_t> keys,
                  std::vector<ActiveBrick>& active) {
  const CaseTable& table = case_table();
  for (const std::uint64_t key : keys) {
    ActiveBrick brick;
    brick.key = key;
    const BrickIndex index = brick_of_key(key);
    surface.visit(index);
    surface.signs(brick.signs);
    count_triangles(brick_geometry(grid, index), table, brick);
    count_vertices(brick);
    if (brick.triangles != 0 || brick.vertices != 0) active.push_back(brick);
  }
}

// What emission reads and writes.
struct Emission {
  const BrickList& bricks;
  IndexedMesh& mesh;  // vertex_spheres and opposite may be empty: then they are left out
};

template <class Surface>
std::uint64_t emit_vertices(const Emission& e, std::size_t b, Surface& surface) {
  const ActiveBrick& brick = e.bricks.bricks[b];
  surface.visit(brick_of_key(brick.key));
  std::uint64_t next = e.bricks.before[b].vertices, clamped = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      const RowCrossings c = row_crossings(brick.signs, y, z);
      for (std::uint32_t nodes = c.nodes(); nodes; nodes &= nodes - 1) {
        const int x = std::countr_zero(nodes);
        const bool inside = (brick.signs.row[z][y] >> x & 1) != 0;
        for (int axis = 0; axis < 3; ++axis) {
          if (!c.has(x, axis)) continue;
          const SurfaceVertex v = surface.vertex(crossed_edge(inside, x, y, z, axis));
          e.mesh.positions[next] = v.position;
          e.mesh.normals[next] = v.normal;
          if (!e.mesh.vertex_spheres.empty()) e.mesh.vertex_spheres[next] = on_sphere(v.sphere);
          clamped += v.clamped ? 1 : 0;
          ++next;
        }
      }
    }
  }
  return clamped;
}

// Places of the brick's neighbours, each found when first asked for.
class Neighbourhood {
 public:
  Neighbourhood(const BrickList& list, std::uint64_t brick)
      : list_(list), key_(list.bricks[brick].key) {
    found_.fill(kNotSought);
    found_[neighbour_slot(0, 0, 0)] = brick;
  }

  std::uint64_t operator()(int slot) {
    std::uint64_t& found = found_[static_cast<std::size_t>(slot)];
    if (found == kNotSought) found = find_neighbour(list_, key_, slot);
    return found;
  }

 private:
  static constexpr std::uint64_t kNotSought = ~std::uint64_t{0};
  const BrickList& list_;
  std::uint64_t key_;
  std::array<std::uint64_t, kNeighbours> found_;
};

inline void emit_cell(const Emission& e, Neighbourhood& near, std::uint64_t first, int x, int y,
                      int z, std::uint32_t inside) {
  const CaseTable& table = case_table();
  for (std::uint32_t h = 0; h < 3 * table.count(inside); ++h) {
    const CellEdge edge = cell_edge(table.edges[inside][h]);
    const std::uint64_t half_edge = first + h;
    e.mesh.triangles[half_edge / 3][half_edge % 3] =
        vertex_number(e.bricks, locate(near, x + edge.x, y + edge.y, z + edge.z), edge.axis);
    if (e.mesh.opposite.empty()) continue;
    e.mesh.opposite[half_edge] =
        opposite_half_edge(e.bricks, table, near, first, x, y, z, inside, static_cast<int>(h));
  }
}

inline void emit_triangles(const Emission& e, std::size_t b) {
  const BrickSigns& signs = e.bricks.bricks[b].signs;
  Neighbourhood near(e.bricks, b);
  std::uint64_t next = 3 * e.bricks.before[b].triangles;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      for (std::uint32_t cells = mixed_cells(signs, y, z); cells != 0; cells &= cells - 1) {
        const int x = std::countr_zero(cells);
        const std::uint32_t inside = cell_case(signs, x, y, z);
        emit_cell(e, near, next, x, y, z, inside);
        next += 3 * case_table().count(inside);
      }
    }
  }
}

// Vertices and triangles of bricks [begin, end); returns how many vertices were clamped.
template <class Surface>
std::uint64_t emit_bricks(const Emission& e, std::size_t begin, std::size_t end, Surface& surface) {
  std::uint64_t clamped = 0;
  for (std::size_t b = begin; b < end; ++b) {
    clamped += emit_vertices(e, b, surface);
    emit_triangles(e, b);
  }
  return clamped;
}

// The loops over one kind of surface, called from many threads.
struct BrickLoops {
  std::function<void(std::span<const std::uint64_t> keys, std::vector<ActiveBrick>& active)> count;
  std::function<std::uint64_t(const Emission&, std::size_t begin, std::size_t end)> emit;
};

enum class Labels { none, spheres };

// Counts the candidates (keys, rising), numbers what they hold and emits it, on all cores; throws
// LimitExceeded before it takes memory for the mesh. `candidates` gives the keys and its memory up.
ExtractResult mesh_bricks(const GridSpec& grid,
                          const std::function<std::vector<std::uint64_t>()>& candidates,
                          const BrickLoops& loops, Labels labels, const ExtractOptions& options);

}  // namespace vdwmesh
