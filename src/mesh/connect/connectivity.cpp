// Builds OpenMesh's half-edge structure in bulk, from triangles and their opposite half-edges.
// add_face(), OpenMesh's own way, works on one thread and searches around vertices for each face.
// Here the steps are: number the edges by counting and a prefix sum; check that the triangles
// around each vertex are one fan; link faces and vertices in parallel; link the boundary on one
// thread, as boundaries are short. to_surface_mesh() calls connect().
#include "mesh/connect/connectivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <vector>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/large_pages.hpp"
#include "mesh/connect/edge_buckets.hpp"
#include "mesh/surface_handles.hpp"

namespace vdwmesh {
namespace {

using handles::face;
using handles::half_edge;
using handles::vertex;
constexpr std::uint32_t kNone = 0xffffffffu;  // in outgoing_: the vertex is on no triangle
constexpr std::size_t kVerticesPerBlock = std::size_t{1} << 14;

// Builds the connectivity of one mesh. A half-edge has two numbers. Its input number is 3t + k for
// corner k of triangle t, where it starts. Its handle is OpenMesh's number, 2e or 2e + 1 for edge
// e. The half-edge of smaller input number owns the edge and gets handle 2e. A half-edge on the
// boundary that belongs to no triangle has a handle only.
class Connector {
 public:
  Connector(SurfaceMesh& mesh, std::span<const Triangle> triangles,
            std::span<const std::uint32_t> opposite, std::size_t vertex_count)
      : mesh_(mesh),
        triangles_(triangles),
        corners_(reinterpret_cast<const std::uint32_t*>(triangles.data())),
        opposite_(opposite),
        vertex_count_(vertex_count) {}

  void run(Opposites origin) {
    if (origin == Opposites::given) check_opposite();
    number_edges();
    choose_outgoing();
    check_fans();
    mesh_.resize(vertex_count_, edge_count_, triangles_.size());
    link_faces();
    link_vertices();
    handle_of_ = Buffer<std::uint32_t>();  // frees the memory, as {} would not
    // opposite_ has one element per half-edge of a triangle. In a closed mesh there are two per
    // edge; on a boundary, the second half-edge belongs to no triangle.
    if (2 * edge_count_ != opposite_.size()) link_boundary();
  }

 private:
  // Whether half-edge h (an input number) owns its edge. kNoOpposite is the largest number, so a
  // half-edge without an opposite owns its edge.
  bool owns(std::uint32_t h) const { return h < opposite_[h]; }

  // Checks opposites that the caller gave. Afterwards all indices are in range, and opposite_ pairs
  // half-edges that run along the same edge in opposite directions. The walks of fan_size() rely on
  // this: they need no bounds checks, and they end. The loop in parallel only finds whether all is
  // well; a serial loop then finds the first bad triangle, for any number of threads.
  void check_opposite() const {
    std::atomic<bool> all_good = true;
    for_each_index(triangles_.size(), [&](std::size_t t) {
      const std::size_t h = 3 * t;
      if (!is_consistent(h, h + 1) || !is_consistent(h + 1, h + 2) || !is_consistent(h + 2, h))
        all_good = false;
    });
    if (all_good) return;
    for (std::uint32_t h = 0; h < opposite_.size(); ++h)
      if (!is_consistent(h, next_in_triangle(h))) throw_bad_triangle(h / 3);
  }

  // Whether half-edge h has two different ends, starts at a vertex that exists, and has an opposite
  // that names h in turn and starts where h ends. `after` is the next half-edge of the same
  // triangle, so corners_[after] is the end of h. The same test of the opposite finds whether h
  // starts where the opposite ends.
  bool is_consistent(std::size_t h, std::size_t after) const {
    const std::uint32_t o = opposite_[h], from = corners_[h], to = corners_[after];
    if (from >= vertex_count_ || from == to) return false;
    if (o == kNoOpposite) return true;
    return o < opposite_.size() && opposite_[o] == h && corners_[o] == to;
  }

  // Says what is wrong with triangle t, one of whose half-edges is not consistent.
  [[noreturn]] void throw_bad_triangle(std::uint32_t t) const {
    const auto [a, b, c] = triangles_[t];
    if (std::max({a, b, c}) >= vertex_count_ || a == b || b == c || c == a)
      throw InvalidInput(fmt::format("triangle {} names a vertex twice or none of the {}: {} {} {}",
                                     t, vertex_count_, a, b, c));
    throw InvalidInput(fmt::format(
        "a half-edge of triangle {} (vertices {} {} {}) has no consistent opposite", t, a, b, c));
  }

  // Numbers the edges in the order of their owners. Every handle is written by one thread alone,
  // the one that visits the owner.
  void number_edges() {
    resize_untouched(handle_of_, opposite_.size());
    const std::uint64_t edges = number_all(
        opposite_.size(), [&](std::size_t h) { return owns(static_cast<std::uint32_t>(h)); },
        [&](std::size_t h, std::uint32_t edge) {
          handle_of_[h] = 2 * edge;
          if (opposite_[h] != kNoOpposite) handle_of_[opposite_[h]] = 2 * edge + 1;
        });
    if (2 * edges > kMaxSurfaceHalfEdges)
      throw LimitExceeded(fmt::format("{} half-edges, where OpenMesh can hold {}", 2 * edges,
                                      kMaxSurfaceHalfEdges));
    edge_count_ = edges;
  }

  // Gives each half-edge of a triangle its end, its face and its successor. OpenMesh sets the
  // previous half-edge along with the successor.
  void link_faces() {
    for_each_index(triangles_.size(), [&](std::size_t t) {
      const std::uint32_t* h = handle_of_.data() + 3 * t;
      for (unsigned k = 0; k < 3; ++k) {
        const unsigned next = (k + 1) % 3;
        mesh_.set_vertex_handle(half_edge(h[k]), vertex(triangles_[t][next]));
        mesh_.set_face_handle(half_edge(h[k]), face(t));
        mesh_.set_next_halfedge_handle(half_edge(h[k]), half_edge(h[next]));
      }
      mesh_.set_halfedge_handle(face(t), half_edge(h[0]));
    });
  }

  // Gives each vertex a half-edge that leaves it. A vertex on no triangle keeps none.
  void link_vertices() {
    for_each_index(vertex_count_, [&](std::size_t v) {
      if (outgoing_[v] != kNone)
        mesh_.set_halfedge_handle(vertex(v), half_edge(handle_of_[outgoing_[v]]));
    });
  }

  // Links the half-edges on the boundary, which belong to no triangle and have odd handles. The
  // first loop makes each of them the outgoing half-edge of the vertex where it starts, as OpenMesh
  // demands. A vertex has one fan of triangles, so only one boundary half-edge starts there. The
  // second loop uses this: the successor of a boundary half-edge is the outgoing half-edge of the
  // vertex where it ends.
  void link_boundary() {
    std::vector<std::uint32_t> boundary;
    for (std::uint32_t e = 0; e < edge_count_; ++e)
      if (mesh_.is_boundary(half_edge(2 * e + 1))) boundary.push_back(2 * e + 1);
    for (const std::uint32_t h : boundary) {
      const auto inner = half_edge(h - 1);
      const auto from = mesh_.to_vertex_handle(inner);
      mesh_.set_vertex_handle(half_edge(h),
                              mesh_.to_vertex_handle(mesh_.prev_halfedge_handle(inner)));
      mesh_.set_halfedge_handle(from, half_edge(h));
    }
    for (const std::uint32_t h : boundary)
      mesh_.set_next_halfedge_handle(half_edge(h),
                                     mesh_.halfedge_handle(mesh_.to_vertex_handle(half_edge(h))));
  }

  // Picks an outgoing half-edge for each vertex: the last one, in input numbers, that starts there.
  void choose_outgoing() {
    outgoing_.assign(vertex_count_, kNone);
    for (std::uint32_t h = 0; h < opposite_.size(); ++h) outgoing_[corners_[h]] = h;
  }

  // Checks that the triangles around each vertex are one fan. A walk round a vertex meets the
  // triangles of one fan only, each once, so its length is at most the number of corners at the
  // vertex. Hence all vertices are right exactly if the lengths sum to the number of all corners.
  void check_fans() const {
    std::atomic<std::uint64_t> met{0};
    for_each_block(vertex_count_, kVerticesPerBlock,
                   [&](std::size_t, std::size_t v, std::size_t end) {
                     std::uint64_t corners = 0;
                     for (; v < end; ++v) corners += fan_size(v);
                     met += corners;
                   });
    if (met == opposite_.size()) return;
    // Some vertex has two fans. Only now are corners counted per vertex, to find the first of them.
    std::vector<std::uint32_t> corners(vertex_count_);
    for (const Triangle& triangle : triangles_)
      for (const std::uint32_t v : triangle) ++corners[v];
    for (std::size_t v = 0; v < vertex_count_; ++v)
      if (corners[v] != fan_size(v)) throw_two_fans(v);
  }

  // Number of triangles in the fan of v that holds its outgoing half-edge `first`. The walk turns
  // one way until it is back. If it meets the boundary instead, a second walk turns the other way
  // from `first`. Turning is injective, because opposites come in pairs, so the walk can only
  // return to where it began. In the first walk h ends at v, in the second walk h starts at v.
  std::uint32_t fan_size(std::size_t v) const {
    const std::uint32_t first = outgoing_[v];
    if (first == kNone) return 0;
    std::uint32_t size = 1, h = opposite_[first];
    for (; h != kNoOpposite && next_in_triangle(h) != first; h = opposite_[next_in_triangle(h)])
      ++size;
    if (h != kNoOpposite) return size;
    h = opposite_[previous_in_triangle(first)];
    for (; h != kNoOpposite; h = opposite_[previous_in_triangle(h)]) ++size;
    return size;
  }

  [[noreturn]] static void throw_two_fans(std::size_t v) {
    throw InvalidInput(fmt::format(
        "the triangles around vertex {} are more than one fan; a half-edge mesh takes one", v));
  }

  SurfaceMesh& mesh_;
  std::span<const Triangle> triangles_;
  // The triangles as a flat array, as std::array has no padding: the start of each half-edge.
  const std::uint32_t* corners_;
  std::span<const std::uint32_t> opposite_;
  std::size_t vertex_count_;
  std::size_t edge_count_ = 0;
  Buffer<std::uint32_t> handle_of_;  // input number -> handle
  Buffer<std::uint32_t> outgoing_;   // vertex -> input number of a half-edge from it, or kNone
};

}  // namespace

void connect(SurfaceMesh& mesh, std::span<const Triangle> triangles,
             std::span<const std::uint32_t> opposite, std::size_t vertex_count, Opposites origin) {
  Connector(mesh, triangles, opposite, vertex_count).run(origin);
}

}  // namespace vdwmesh
