// Writes the triangles of the bricks, and on request their opposite half-edges, on the CPU. For
// each brick it fills two tables: VertexMap from grid edges to vertex numbers, and, for half-edges,
// CellMap from cells to first half-edges and cases. Then it visits the mixed cells, which the
// surface crosses, in order. A triangle corner is one element of the first table; an opposite
// half-edge follows from one element of the second. The numbers of a brick are collected in a
// buffer and copied to the mesh at once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "extract/bricks/brick_cases.hpp"
#include "extract/bricks/brick_map.hpp"
#include "extract/bricks/case_table.hpp"
#include "extract/bricks/cell_map.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Input and output of the emission of vertices and triangles.
struct Emission {
  const BrickList& bricks;
  IndexedMesh& mesh;  // if normals, vertex_spheres or opposite are empty, they are not written
  // Numbers, in the whole mesh, of the vertex positions[0] and the triangle triangles[0]; above 0
  // if `mesh` has a part of a mesh only.
  BrickSums first{0, 0};
};

// One emitter works for one thread, brick after brick, and reuses its tables.
class TriangleEmitter {
 public:
  explicit TriangleEmitter(const Emission& e)
      : e_(e), table_(case_table()), corners_(corner_places()), opposites_(opposite_places()) {}

  // Writes the triangles of brick b to their elements of the mesh. `edges` are the crossed edges of
  // the brick, `faces` its crossed faces. Throws InternalError if the surface continues through
  // an upper face, or along an upper edge of the brick, into a brick that is not in the list.
  void emit(std::size_t b, std::span<const BrickEdge> edges, const CrossedFaces& faces) {
    const ActiveBrick& brick = e_.bricks.bricks[b];
    const BrickSums& before = e_.bricks.before[b];
    NeighbourCache near(e_.bricks, b);
    cases_.set(brick.signs);
    vertices_.set(edges, before.vertices);
    vertices_.set_neighbours(e_.bricks, brick.signs, near);
    find_beyond(faces, near);
    write_corners();
    const std::uint64_t to = before.triangles - e_.first.triangles;
    std::memcpy(e_.mesh.triangles.data() + to, words_.data(), brick.triangles * sizeof(Triangle));
    if (e_.mesh.opposite.empty()) return;
    cells_.fill(e_.bricks, b, cases_, table_, near);
    write_opposites();
    std::memcpy(e_.mesh.opposite.data() + 3 * to, words_.data(),
                brick.triangles * sizeof(Triangle));
  }

 private:
  static const CornerTable& corner_places() {
    static const CornerTable kPlaces = VertexMap::corner_places(case_table());
    return kPlaces;
  }
  static const OppositeTable& opposite_places() {
    static const OppositeTable kPlaces = CellMap::opposite_places(case_table());
    return kPlaces;
  }

  static constexpr std::uint32_t kMostWords = kBrickNodes * kCaseHalfEdges;

  // Writes word(h) for the half-edges h of a cell with case `inside` from `words` on, and returns
  // the end. It writes 9 words, or 15 if the case has more than three triangles, so that the loops
  // have constant length. Words behind the returned end are meaningless; the next cell overwrites
  // them, and emit() does not copy those of the last cell.
  template <class Word>
  std::uint32_t* write(std::uint32_t inside, std::uint32_t* words, Word&& word) const {
    constexpr std::uint32_t few = 9;  // three triangles; most cells have no more
    for (std::uint32_t h = 0; h < few; ++h) words[h] = word(h);
    if (table_.count(inside) > few / 3) {
      for (std::uint32_t h = few; h < kCaseHalfEdges; ++h) words[h] = word(h);
    }
    return words + std::size_t{3} * table_.count(inside);
  }

  // Looks up the neighbours beyond the crossed upper faces only to have `near` throw if one is
  // missing. Usually set_neighbours() has looked them up already, because they own vertices of this
  // brick's cells. It has not if, of the face's nodes, (8, 8, 8) alone differs in sign: the crossed
  // edges at this node belong to bricks across an edge or a corner of this brick. The brick beyond
  // the face holds surface all the same.
  static void find_beyond(const CrossedFaces& faces, NeighbourCache& near) {
    if ((faces.upper & 1u) != 0) near(neighbour_slot(1, 0, 0));
    if ((faces.upper & 2u) != 0) near(neighbour_slot(0, 1, 0));
    if ((faces.upper & 4u) != 0) near(neighbour_slot(0, 0, 1));
  }

  // Collects the vertices of all triangles of the brick in words_.
  void write_corners() {
    std::uint32_t* words = words_.data();
    cases_.for_each_mixed([&](int x, int y, int z, std::uint32_t inside) {
      const std::uint32_t* const vertex = vertices_.from(VertexMap::place(x, y, z));
      const std::uint16_t* const place = corners_.of[inside];
      words = write(inside, words, [&](std::uint32_t h) { return vertex[place[h]]; });
    });
  }

  // Collects the opposites of all half-edges of the brick in words_.
  void write_opposites() {
    std::uint32_t* words = words_.data();
    cases_.for_each_mixed([&](int x, int y, int z, std::uint32_t inside) {
      const CellMap::Cell* const cell = cells_.from(CellMap::place(x, y, z));
      const std::uint8_t* const codes = opposites_.code[inside];
      words = write(inside, words, [&](std::uint32_t h) {
        const std::uint8_t code = codes[h];
        const CellMap::Cell& beyond = cell[opposites_.step[code]];
        return beyond.first_half_edge + opposites_.half_edge[beyond.inside][code];
      });
    });
  }

  const Emission& e_;
  const CaseTable& table_;
  const CornerTable& corners_;
  const OppositeTable& opposites_;
  // Tables of the brick that is being written.
  BrickCases cases_;
  VertexMap vertices_;
  CellMap cells_;  // used only if opposite half-edges are written
  // Room for the words of a full brick, and for what write() puts beyond the last cell's own.
  std::array<std::uint32_t, kMostWords + kCaseHalfEdges> words_;
};

}  // namespace vdwmesh
