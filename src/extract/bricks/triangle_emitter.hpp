// The triangles of bricks on the CPU, from what their maps know.
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

// What emission reads and writes.
struct Emission {
  const BrickList& bricks;
  IndexedMesh& mesh;  // vertex_spheres and opposite may be empty: then they are left out
  // Numbers, in the whole mesh, of the vertex and the triangle that the arrays begin with.
  BrickSums first{0, 0};
};

// Triangles and half-edges, brick by brick.
class TriangleEmitter {
 public:
  explicit TriangleEmitter(const Emission& e)
      : e_(e), table_(case_table()), corners_(corner_places()), opposites_(opposite_places()) {}

  // Brick b, whose own vertices are on `edges`. Throws InternalError where the surface leaves it
  // through one of `faces`, or along one of its edges, and there is no brick in the list.
  void emit(std::size_t b, std::span<const BrickEdge> edges, const CrossedFaces& faces) {
    const ActiveBrick& brick = e_.bricks.bricks[b];
    const BrickSums& before = e_.bricks.before[b];
    Neighbourhood near(e_.bricks, b);
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
  static const CornerPlaces& corner_places() {
    static const CornerPlaces kPlaces = VertexMap::corner_places(case_table());
    return kPlaces;
  }
  static const OppositePlaces& opposite_places() {
    static const OppositePlaces kPlaces = CellMap::opposite_places(case_table());
    return kPlaces;
  }

  static constexpr std::uint32_t kMostWords = kBrickNodes * kCaseHalfEdges;

  // word(inside, h) for the half-edges h of a case, and of more triangles than it has as well: what
  // is written beyond them means nothing and is written over.
  template <class Word>
  std::uint32_t* write(std::uint32_t inside, std::uint32_t* words, Word&& word) const {
    constexpr std::uint32_t few = 9;  // of three triangles: what most cells have at most
    for (std::uint32_t h = 0; h < few; ++h) words[h] = word(h);
    if (table_.count(inside) > few / 3) {
      for (std::uint32_t h = few; h < kCaseHalfEdges; ++h) words[h] = word(h);
    }
    return words + std::size_t{3} * table_.count(inside);
  }

  // Almost always a vertex was borrowed from there and the brick is known; it is not where one
  // corner alone differs.
  static void find_beyond(const CrossedFaces& faces, Neighbourhood& near) {
    if ((faces.upper & 1u) != 0) near(neighbour_slot(1, 0, 0));
    if ((faces.upper & 2u) != 0) near(neighbour_slot(0, 1, 0));
    if ((faces.upper & 4u) != 0) near(neighbour_slot(0, 0, 1));
  }

  void write_corners() {
    std::uint32_t* words = words_.data();
    cases_.for_each_mixed([&](int x, int y, int z, std::uint32_t inside) {
      const std::uint32_t* const vertex = vertices_.from(VertexMap::place(x, y, z));
      const std::uint16_t* const place = corners_.of[inside];
      words = write(inside, words, [&](std::uint32_t h) { return vertex[place[h]]; });
    });
  }

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
  const CornerPlaces& corners_;
  const OppositePlaces& opposites_;
  // Of the brick at hand.
  BrickCases cases_;
  VertexMap vertices_;
  CellMap cells_;  // for half-edges
  std::array<std::uint32_t, kMostWords + kCaseHalfEdges> words_;
};

}  // namespace vdwmesh
