// CrossingGuard: keeps triangles of a changing mesh from crossing each other, within some zones.
// For the library's own use.
//
// The other tests of an operation leave next to no crossings: some one operation in a hundred
// thousand makes one. So the mesh is searched when it is finished, and where triangles cross, it is
// made again with a zone there, in which every new triangle is tested against those near it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "remesh/dynamic_mesh.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh::remesh {

// A triangle that an operation would make.
struct NewTriangle {
  Triangle vertex;
  std::array<Vec3d, 3> corner;  // Å
};

class CrossingGuard {
 public:
  // Both must outlive this. `cell` in Å, about an edge length.
  CrossingGuard(const DynamicMesh& mesh, const std::vector<Vec3d>& positions,
                std::span<const Box> zones, double cell);

  // Whether no new triangle crosses another one, or one of the mesh that stays, in a zone.
  bool allows(std::span<const NewTriangle> made, std::span<const std::uint32_t> removed) const;
  // Must be called for each triangle that was made or moved.
  void note(std::uint32_t triangle);

 private:
  using CellKey = std::array<std::int32_t, 3>;
  struct KeyHash {
    std::size_t operator()(const CellKey& key) const;
  };
  template <class Visit>
  void visit_keys(const Box& box, const Visit& visit) const;

  const DynamicMesh& mesh_;
  const std::vector<Vec3d>& positions_;
  double cell_;
  // By cell of a zone: triangles that were there at some time.
  std::unordered_map<CellKey, std::vector<std::uint32_t>, KeyHash> cells_;
};

}  // namespace vdwmesh::remesh
