// Marching cubes over bricks on the CPU, for anything that knows the node signs of a brick and the
// vertex on an edge: a Surface has visit(BrickIndex), signs(BrickSigns&) and vertex(CrossedEdge).
// Inlined whole into the loops that core/multiversion.hpp compiles twice.
#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "extract/brick_numbering.hpp"
#include "extract/case_table.hpp"
#include "extract/extractor.hpp"
#include "extract/surface_vertex.hpp"
#include "extract/triangle_emitter.hpp"

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

template <class Surface>
std::uint64_t emit_vertices(const Emission& e, std::size_t b, Surface& surface, VertexMap& map) {
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
          map.set(x, y, z, axis, static_cast<std::uint32_t>(next));
          ++next;
        }
      }
    }
  }
  return clamped;
}

// Vertices and triangles of bricks [begin, end); returns how many vertices were clamped.
template <class Surface>
std::uint64_t emit_bricks(const Emission& e, std::size_t begin, std::size_t end, Surface& surface) {
  std::uint64_t clamped = 0;
  VertexMap vertices;
  for (std::size_t b = begin; b < end; ++b) {
    vertices.clear();
    clamped += emit_vertices(e, b, surface, vertices);
    TriangleEmitter(e, b, vertices).emit();
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
