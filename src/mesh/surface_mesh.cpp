#include "mesh/surface_mesh.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "mesh/edge_buckets.hpp"

namespace vdwmesh {
namespace {

using Range = tbb::blocked_range<std::size_t>;
constexpr std::size_t kItemsPerBlock = 1 << 14;
constexpr std::size_t kFewFaces = 1 << 10;
constexpr std::uint32_t kNone = 0xffffffffu;
const SurfaceMesh::Color kPlainColor{176, 176, 176};

template <class Body>
void for_each_index(std::size_t count, Body&& body) {
  tbb::parallel_for(Range(0, count, kItemsPerBlock), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
  });
}

OpenMesh::HalfedgeHandle half_edge(std::uint32_t i) {
  return OpenMesh::HalfedgeHandle(static_cast<int>(i));
}
OpenMesh::VertexHandle vertex(std::size_t i) { return OpenMesh::VertexHandle(static_cast<int>(i)); }
OpenMesh::FaceHandle face(std::size_t i) { return OpenMesh::FaceHandle(static_cast<int>(i)); }

void check_limits(std::size_t vertices, std::size_t triangles) {
  constexpr auto kMaxHandle = static_cast<std::size_t>(std::numeric_limits<int>::max());
  if (vertices > kMaxHandle || triangles > kMaxSurfaceHalfEdges / 3)
    throw LimitExceeded(
        fmt::format("{} vertices and {} triangles are more than OpenMesh's {} half-edges can "
                    "hold; a coarser spacing makes fewer",
                    vertices, triangles, kMaxSurfaceHalfEdges));
}

void check_sizes(const IndexedMesh& mesh) {
  const auto check = [&](std::size_t size, std::size_t wanted, const char* what) {
    if (size != 0 && size != wanted)
      throw InvalidInput(fmt::format("{} {}, where {} are needed", size, what, wanted));
  };
  check(mesh.normals.size(), mesh.vertex_count(), "vertex normals");
  check(mesh.vertex_spheres.size(), mesh.vertex_count(), "vertex labels");
  check(mesh.triangle_spheres.size(), mesh.triangle_count(), "triangle labels");
  check(mesh.opposite.size(), 3 * mesh.triangle_count(), "opposite half-edges");
}

enum class Opposites { given, computed };

// Builds the connectivity of one mesh. Half-edges of the input are 3t + k; "handles" are those of
// OpenMesh, 2 per edge. An edge is owned by the first of its half-edges.
class Builder {
 public:
  Builder(SurfaceMesh& mesh, std::span<const Triangle> triangles,
          std::span<const std::uint32_t> opposite, std::size_t vertex_count)
      : mesh_(mesh), triangles_(triangles), opposite_(opposite), vertex_count_(vertex_count) {}

  void build(Opposites origin) {
    if (origin == Opposites::given) check_opposite();
    number_edges();
    resize_mesh();
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

  // Most of the time of resize() is the kernel's, handing out pages: that can cost less, but must
  // be asked for between reserve() and the first touch.
  void resize_mesh() {
    const std::size_t edges = edge_count_, faces = triangles_.size();
    if (faces > kFewFaces) {
      mesh_.resize(1, 1, 1);
      mesh_.reserve(vertex_count_, edges, faces);
      expect_writing(&mesh_.edge(OpenMesh::EdgeHandle(0)), edges);
      expect_writing(&mesh_.face(face(0)), faces);
      expect_writing(&mesh_.vertex(vertex(0)), vertex_count_);
      expect_writing(mesh_.points(), vertex_count_);
      expect_writing(mesh_.vertex_normals(), vertex_count_);
      expect_writing(mesh_.vertex_colors(), vertex_count_);
      expect_writing(&mesh_.status(vertex(0)), vertex_count_);
      expect_writing(&mesh_.status(half_edge(0)), 2 * edges);
      expect_writing(&mesh_.status(OpenMesh::EdgeHandle(0)), edges);
      expect_writing(&mesh_.status(face(0)), faces);
      expect_writing(&mesh_.property(vertex_spheres(mesh_), vertex(0)), vertex_count_);
    }
    mesh_.resize(vertex_count_, edges, faces);
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

SurfaceMesh::Normal unit(const Vec3d& a) {
  const double length = norm(a);
  if (!(length > 0)) return {0, 0, 0};
  return {static_cast<float>(a.x / length), static_cast<float>(a.y / length),
          static_cast<float>(a.z / length)};
}

// Without a field's gradient: the sum of the area vectors of the triangles around each vertex.
void set_normals_of_triangles(SurfaceMesh& mesh, const IndexedMesh& source) {
  Buffer<Vec3d> sums(source.vertex_count());
  std::fill(sums.begin(), sums.end(), Vec3d{0, 0, 0});
  for (const auto& [a, b, c] : source.triangles) {
    const Vec3d area =
        cross(source.positions[b] - source.positions[a], source.positions[c] - source.positions[a]);
    for (const std::uint32_t v : {a, b, c}) sums[v] = sums[v] + area;
  }
  for_each_index(sums.size(), [&](std::size_t v) { mesh.set_normal(vertex(v), unit(sums[v])); });
}

void set_vertex_data(SurfaceMesh& mesh, const IndexedMesh& source, VertexSpheresProperty spheres) {
  for_each_index(source.vertex_count(), [&](std::size_t v) {
    const Vec3d& p = source.positions[v];
    mesh.set_point(vertex(v), {p.x, p.y, p.z});
    mesh.set_color(vertex(v), kPlainColor);
    if (!source.normals.empty()) {
      const Vec3f& n = source.normals[v];
      mesh.set_normal(vertex(v), {n.x, n.y, n.z});
    }
    mesh.property(spheres, vertex(v)) =
        source.vertex_spheres.empty() ? on_sphere(kNoSphere) : source.vertex_spheres[v];
  });
  if (source.normals.empty()) set_normals_of_triangles(mesh, source);
}

void set_face_data(SurfaceMesh& mesh, const IndexedMesh& source) {
  if (source.triangle_labels() == TriangleLabels::none) return;
  FaceSphereProperty spheres;
  mesh.add_property(spheres, kFaceSphereName);
  for_each_index(source.triangle_count(), [&](std::size_t t) {
    mesh.property(spheres, face(t)) = source.triangle_spheres[t];
  });
}

}  // namespace

VertexSpheresProperty vertex_spheres(const SurfaceMesh& mesh) {
  VertexSpheresProperty property;
  if (!mesh.get_property_handle(property, kVertexSpheresName))
    throw InvalidInput(fmt::format("the mesh has no vertex property {}", kVertexSpheresName));
  return property;
}

std::optional<FaceSphereProperty> face_spheres(const SurfaceMesh& mesh) {
  FaceSphereProperty property;
  if (!mesh.get_property_handle(property, kFaceSphereName)) return {};
  return property;
}

SurfaceMesh to_surface_mesh(const IndexedMesh& source) {
  check_limits(source.vertex_count(), source.triangle_count());
  check_sizes(source);
  Buffer<std::uint32_t> computed;
  if (source.opposite.empty())
    computed = opposite_half_edges(source.triangles, source.vertex_count());
  const std::span<const std::uint32_t> opposite = source.opposite.empty()
                                                      ? std::span<const std::uint32_t>(computed)
                                                      : std::span(source.opposite);
  SurfaceMesh mesh;
  VertexSpheresProperty spheres;
  mesh.add_property(spheres, kVertexSpheresName);
  Builder(mesh, source.triangles, opposite, source.vertex_count())
      .build(source.opposite.empty() ? Opposites::computed : Opposites::given);
  set_vertex_data(mesh, source, spheres);
  set_face_data(mesh, source);
  return mesh;
}

IndexedMesh to_indexed_mesh(const SurfaceMesh& mesh) {
  IndexedMesh result;
  const std::size_t vertices = mesh.n_vertices(), triangles = mesh.n_faces();
  const VertexSpheresProperty spheres = vertex_spheres(mesh);
  result.positions.resize(vertices);
  result.normals.resize(vertices);
  result.vertex_spheres.resize(vertices);
  for_each_index(vertices, [&](std::size_t v) {
    const auto& p = mesh.point(vertex(v));
    const auto& n = mesh.normal(vertex(v));
    result.positions[v] = {p[0], p[1], p[2]};
    result.normals[v] = {n[0], n[1], n[2]};
    result.vertex_spheres[v] = mesh.property(spheres, vertex(v));
  });
  Buffer<std::uint32_t> index_of(mesh.n_halfedges());
  std::fill(index_of.begin(), index_of.end(), kNoOpposite);
  result.triangles.resize(triangles);
  for_each_index(triangles, [&](std::size_t t) {
    auto h = mesh.halfedge_handle(face(t));
    for (unsigned k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h)) {
      index_of[static_cast<std::size_t>(h.idx())] = static_cast<std::uint32_t>(3 * t + k);
      result.triangles[t][k] = static_cast<std::uint32_t>(mesh.from_vertex_handle(h).idx());
    }
  });
  if (const std::optional<FaceSphereProperty> spheres_of_faces = face_spheres(mesh)) {
    result.triangle_spheres.resize(triangles);
    for_each_index(triangles, [&](std::size_t t) {
      result.triangle_spheres[t] = mesh.property(*spheres_of_faces, face(t));
    });
  }
  result.opposite.resize(3 * triangles);
  for_each_index(triangles, [&](std::size_t t) {
    auto h = mesh.halfedge_handle(face(t));
    for (unsigned k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
      result.opposite[3 * t + k] =
          index_of[static_cast<std::size_t>(mesh.opposite_halfedge_handle(h).idx())];
  });
  return result;
}

}  // namespace vdwmesh
