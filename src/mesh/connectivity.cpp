#include "mesh/connectivity.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "mesh/edge_buckets.hpp"
#include "mesh/surface_handles.hpp"
#include "mesh/surface_room.hpp"

namespace vdwmesh {
namespace {

using handles::face;
using handles::for_each_index;
using handles::half_edge;
using handles::kItemsPerBlock;
using handles::vertex;
using Range = tbb::blocked_range<std::size_t>;
constexpr std::uint32_t kNone = 0xffffffffu;

// Builds the connectivity of one mesh. Half-edges of the input are 3t + k; "handles" are those of
// OpenMesh, 2 per edge. An edge is owned by the first of its half-edges.
class Connector {
 public:
  Connector(SurfaceMesh& mesh, std::span<const Triangle> triangles,
            std::span<const std::uint32_t> opposite, std::size_t vertex_count)
      : mesh_(mesh), triangles_(triangles), opposite_(opposite), vertex_count_(vertex_count) {}

  void run(Opposites origin) {
    if (origin == Opposites::given) check_opposite();
    number_edges();
    make_room(mesh_, {vertex_count_, edge_count_, triangles_.size()});
    link_faces();
    handle_of_ = {};
    if (2 * edge_count_ != opposite_.size()) link_boundary();
    check_fans();
  }

 private:
  bool owns(std::uint32_t h) const { return h < opposite_[h]; }  // kNoOpposite is the largest

  // What a producer hands over is believed only as far as it is consistent.
  void check_opposite() const {
    const auto half_edges = static_cast<std::uint32_t>(opposite_.size());
    std::atomic<std::uint32_t> first_bad{kNone};
    for_each_index(triangles_.size(), [&](std::size_t t) {
      const Triangle& triangle = triangles_[t];
      bool good = true;
      for (unsigned k = 0; k < 3; ++k)
        good &= is_consistent(static_cast<std::uint32_t>(3 * t + k), triangle[k],
                              triangle[(k + 1) % 3], half_edges);
      if (!good) keep_smallest(first_bad, static_cast<std::uint32_t>(t));
    });
    if (first_bad != kNone) throw_bad_triangle(first_bad);
  }

  bool is_consistent(std::uint32_t h, std::uint32_t from, std::uint32_t to,
                     std::uint32_t half_edges) const {
    const std::uint32_t o = opposite_[h];
    if (from >= vertex_count_ || from == to) return false;
    if (o == kNoOpposite) return true;
    return o < half_edges && opposite_[o] == h && triangles_[o / 3][o % 3] == to;
  }

  [[noreturn]] void throw_bad_triangle(std::uint32_t t) const {
    const auto [a, b, c] = triangles_[t];
    if (std::max({a, b, c}) >= vertex_count_ || a == b || b == c || c == a)
      throw InvalidInput(fmt::format("triangle {} names a vertex twice or none of the {}: {} {} {}",
                                     t, vertex_count_, a, b, c));
    throw InvalidInput(fmt::format(
        "a half-edge of triangle {} (vertices {} {} {}) has no consistent opposite", t, a, b, c));
  }

  static void keep_smallest(std::atomic<std::uint32_t>& smallest, std::uint32_t value) {
    std::uint32_t seen = smallest.load();
    while (value < seen && !smallest.compare_exchange_weak(seen, value)) {
    }
  }

  // Edges are numbered by their owners in order: count by block, scan, number.
  void number_edges() {
    const std::size_t half_edges = opposite_.size();
    const std::size_t blocks = (half_edges + kItemsPerBlock - 1) / kItemsPerBlock;
    const auto block_end = [&](std::size_t b) {
      return std::min((b + 1) * kItemsPerBlock, half_edges);
    };
    Buffer<std::uint32_t> first_edge(blocks);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
      std::uint32_t owners = 0;
      for (std::size_t h = b * kItemsPerBlock; h < block_end(b); ++h)
        owners += owns(static_cast<std::uint32_t>(h));
      first_edge[b] = owners;
    });
    std::uint32_t edges = 0;
    for (std::uint32_t& first : first_edge) first = std::exchange(edges, edges + first);
    if (2 * std::uint64_t{edges} > kMaxSurfaceHalfEdges)
      throw LimitExceeded(fmt::format("{} half-edges, where OpenMesh can hold {}",
                                      2 * std::uint64_t{edges}, kMaxSurfaceHalfEdges));
    edge_count_ = edges;
    resize_untouched(handle_of_, half_edges);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
      std::uint32_t edge = first_edge[b];
      for (std::size_t h = b * kItemsPerBlock; h < block_end(b); ++h) {
        if (!owns(static_cast<std::uint32_t>(h))) continue;
        handle_of_[h] = 2 * edge;
        if (opposite_[h] != kNoOpposite) handle_of_[opposite_[h]] = 2 * edge + 1;
        ++edge;
      }
    });
  }

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
    for (std::size_t t = 0; t < triangles_.size(); ++t)  // in order: the last one stays
      for (unsigned k = 0; k < 3; ++k)
        mesh_.set_halfedge_handle(vertex(triangles_[t][k]), half_edge(handle_of_[3 * t + k]));
  }

  // A boundary half-edge is the second of its edge. Its start becomes the outgoing half-edge of
  // its vertex, as OpenMesh demands, and from there the next one along the boundary is found.
  void link_boundary() {
    std::vector<std::uint32_t> boundary;
    for (std::uint32_t e = 0; e < edge_count_; ++e)
      if (mesh_.is_boundary(half_edge(2 * e + 1))) boundary.push_back(2 * e + 1);
    for (const std::uint32_t h : boundary) {
      const auto inner = half_edge(h - 1);
      const auto from = mesh_.to_vertex_handle(inner);
      mesh_.set_vertex_handle(half_edge(h), start_of(inner));
      if (mesh_.is_boundary(mesh_.halfedge_handle(from))) throw_two_fans(from);
      mesh_.set_halfedge_handle(from, half_edge(h));
    }
    for (const std::uint32_t h : boundary)
      mesh_.set_next_halfedge_handle(half_edge(h),
                                     mesh_.halfedge_handle(mesh_.to_vertex_handle(half_edge(h))));
  }

  OpenMesh::VertexHandle start_of(OpenMesh::HalfedgeHandle inner) const {
    return mesh_.to_vertex_handle(mesh_.prev_halfedge_handle(inner));
  }

  // Every corner must be met by going round the vertices from their outgoing half-edges.
  void check_fans() const {
    std::atomic<std::uint64_t> met{0};
    tbb::parallel_for(Range(0, vertex_count_, kItemsPerBlock), [&](const Range& range) {
      std::uint64_t corners = 0;
      for (std::size_t v = range.begin(); v < range.end(); ++v) corners += fan_size(vertex(v));
      met += corners;
    });
    if (met == 3 * static_cast<std::uint64_t>(triangles_.size())) return;
    std::vector<std::uint32_t> corners(vertex_count_);
    for (const Triangle& triangle : triangles_)
      for (const std::uint32_t v : triangle) ++corners[v];
    for (std::size_t v = 0; v < vertex_count_; ++v)
      if (corners[v] != fan_size(vertex(v))) throw_two_fans(vertex(v));
  }

  std::uint32_t fan_size(OpenMesh::VertexHandle v) const {
    const auto first = mesh_.halfedge_handle(v);
    if (!first.is_valid()) return 0;
    std::uint32_t size = 0;
    auto h = first;
    do {
      size += !mesh_.is_boundary(h);
      h = mesh_.cw_rotated_halfedge_handle(h);
    } while (h != first);
    return size;
  }

  [[noreturn]] static void throw_two_fans(OpenMesh::VertexHandle v) {
    throw InvalidInput(fmt::format(
        "the triangles around vertex {} are more than one fan; a half-edge mesh takes one",
        v.idx()));
  }

  SurfaceMesh& mesh_;
  std::span<const Triangle> triangles_;
  std::span<const std::uint32_t> opposite_;
  std::size_t vertex_count_;
  std::size_t edge_count_ = 0;
  Buffer<std::uint32_t> handle_of_;  // of each input half-edge
};

}  // namespace

void connect(SurfaceMesh& mesh, std::span<const Triangle> triangles,
             std::span<const std::uint32_t> opposite, std::size_t vertex_count, Opposites origin) {
  Connector(mesh, triangles, opposite, vertex_count).run(origin);
}

}  // namespace vdwmesh
