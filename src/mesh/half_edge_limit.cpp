// check_triangle_count(): the refusal of what is too large for half-edges, with what would make it
// smaller.
#include "mesh/half_edge_limit.hpp"

#include <fmt/format.h>

#include "core/errors.hpp"

namespace vdwmesh {

void check_triangle_count(std::size_t triangles) {
  if (triangles <= kMaxSurfaceHalfEdges / 3) return;
  throw LimitExceeded(fmt::format(
      "{} triangles have more than the {} half-edges a mesh can hold; a coarser spacing "
      "makes fewer",
      triangles, kMaxSurfaceHalfEdges));
}

}  // namespace vdwmesh
