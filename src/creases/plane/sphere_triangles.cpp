// Meshes of whole spheres, and the points of such meshes (declared in patch_mesher.hpp): the
// geodesic subdivision of an icosahedron.
//
// Each of the 20 faces is divided into n² triangles by a lattice in barycentric coordinates, and
// the points are scaled to the unit sphere. Points on an edge are shared by the two faces beside
// it. mesh_sphere() serves spheres that are exposed as a whole. SpherePoints gives the points
// alone, with which patch_triangulator.hpp fills the inside of patches.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "core/lanes/multiversion.hpp"
#include "creases/patch/patch_mesher.hpp"

namespace vdwmesh {
namespace {

// Turns a point by 1 rad about the axis (2, 3, 6) / 7 by Rodrigues' formula. Balls of a lattice
// touch in the directions of coordinate axes and diagonals. The icosahedron would have points in
// such directions; after the turn it does not, so meshes have no vertices in the points of contact.
Vec3d turned(const Vec3d& p) {
  const Vec3d axis{2.0 / 7, 3.0 / 7, 6.0 / 7};
  const double c = std::cos(1.0), s = std::sin(1.0);
  const Vec3d out = c * p + s * cross(axis, p) + ((1 - c) * dot(axis, p)) * axis;
  return (1 / norm(out)) * out;
}

// The 12 vertices of an icosahedron on the unit sphere, turned: (0, ±1, ±φ), scaled, and its cyclic
// permutations, with φ the golden ratio.
std::vector<Vec3d> icosahedron_points() {
  const double golden = std::numbers::phi, scale = 1 / std::sqrt(1 + golden * golden);
  const double a = scale, b = golden * scale;
  std::vector<Vec3d> points{{-a, b, 0}, {a, b, 0}, {-a, -b, 0}, {a, -b, 0},
                            {0, -a, b}, {0, a, b}, {0, -a, -b}, {0, a, -b},
                            {b, 0, -a}, {b, 0, a}, {-b, 0, -a}, {-b, 0, a}};
  std::transform(points.begin(), points.end(), points.begin(), turned);
  return points;
}

// Counter-clockwise seen from outside; numbers of the points above.
constexpr std::array<std::array<std::uint32_t, 3>, 20> kFaces{
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

// How many parts each edge of the icosahedron is divided into, so that parts are no longer than
// `edge_length` (in radii) on average. The edge is seen from the centre under arctan 2 = 63.4°.
// Divided by the number of parts, this angle is the mean edge of the mesh to within 3 %.
std::uint32_t parts_of_edge(double edge_length) {
  return static_cast<std::uint32_t>(std::ceil(std::max(1.0, std::atan(2.0) / edge_length)));
}

// Divides faces into n² triangles each, appending points and triangles to `out`. The first 12
// points of `out` are the icosahedron's. The points of an edge are made once and kept in `edges_`.
class FaceDivider {
 public:
  FaceDivider(std::uint32_t n, PatchMesh& out) : n_(n), out_(out) {}

  // Divides a face, given by three of the first 12 points. Goes through it row by row, from its
  // corner 0 to the opposite edge. Row i has i + 1 points.
  void divide(const std::array<std::uint32_t, 3>& face) {
    std::vector<std::uint32_t> above, row;
    for (std::uint32_t i = 0; i <= n_; ++i) {
      row.clear();
      for (std::uint32_t j = 0; j <= i; ++j) row.push_back(point(face, i, j));
      for (std::uint32_t j = 0; j < i; ++j) {
        out_.triangles.push_back({above[j], row[j], row[j + 1]});
        if (j + 1 < i) out_.triangles.push_back({above[j], row[j + 1], above[j + 1]});
      }
      std::swap(above, row);
    }
  }

 private:
  // The number of the point with barycentric weights n - i, i - j and j at the corners of the face.
  std::uint32_t point(const std::array<std::uint32_t, 3>& face, std::uint32_t i, std::uint32_t j) {
    if (i == 0) return face[0];
    if (j == 0) return on_edge(face[0], face[1], i);
    if (j == i) return on_edge(face[0], face[2], i);
    if (i == n_) return on_edge(face[1], face[2], j);
    return add(static_cast<double>(n_ - i) * out_.interior[face[0]] +
               static_cast<double>(i - j) * out_.interior[face[1]] +
               static_cast<double>(j) * out_.interior[face[2]]);
  }

  // The number of point k, 0 <= k <= n, on the edge from corner a to corner b. The points of the
  // edge are stored once, from the corner of lower number on, so that both faces find the same
  // points.
  std::uint32_t on_edge(std::uint32_t a, std::uint32_t b, std::uint32_t k) {
    if (k == n_) return b;
    if (a > b) return on_edge(b, a, n_ - k);
    if (k == 0) return a;
    auto& points = edges_[{a, b}];
    if (points.empty()) {
      for (std::uint32_t i = 1; i < n_; ++i) {
        points.push_back(add(static_cast<double>(n_ - i) * out_.interior[a] +
                             static_cast<double>(i) * out_.interior[b]));
      }
    }
    return points[k - 1];
  }

  // Appends a point, scaled to the sphere, and returns its number.
  std::uint32_t add(const Vec3d& p) {
    out_.interior.push_back((1 / norm(p)) * p);
    return static_cast<std::uint32_t>(out_.interior.size() - 1);
  }

  std::uint32_t n_;
  PatchMesh& out_;
  // By corners (lower, higher): the points between them, from the lower corner on.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> edges_;
};

}  // namespace

PatchMesh mesh_sphere(double edge_length) {
  PatchMesh out;
  const std::vector<Vec3d> corners = icosahedron_points();
  out.interior.assign(corners.begin(), corners.end());
  FaceDivider divider(parts_of_edge(edge_length), out);
  for (const auto& face : kFaces) divider.divide(face);
  return out;
}

namespace {

// The points of a face, by row i and place j in it. The same rows as in FaceDivider; row i is
// parallel to the edge bc of the face. Each edge belongs to two faces, which run along it in
// opposite directions. Its points are made by the face that runs from the lower corner to the
// higher one. The corners, where two of ab, ac, bc hold, are made apart.
class FacePoints {
 public:
  FacePoints(const std::array<std::uint32_t, 3>& face, std::span<const Vec3d> corners,
             std::uint32_t n)
      : face_(face), corners_(corners), n_(n) {}

  bool has(std::uint32_t i, std::uint32_t j) const {
    const auto& [a, b, c] = face_;
    const bool ab = j == 0, ac = j == i, bc = i == n_;
    return ab + ac + bc <= 1 && !(ab && a > b) && !(ac && c > a) && !(bc && b > c);
  }
  Vec3d at(std::uint32_t i, std::uint32_t j) const {
    const Vec3d p = static_cast<double>(n_ - i) * corners_[face_[0]] +
                    static_cast<double>(i - j) * corners_[face_[1]] +
                    static_cast<double>(j) * corners_[face_[2]];
    return (1 / norm(p)) * p;
  }

 private:
  std::array<std::uint32_t, 3> face_;
  std::span<const Vec3d> corners_;
  std::uint32_t n_;
};

// The places of a face whose points may be clear of margins: halves blocks of rows and places until
// a cap covers a block, or it is small.
class ClearPlaces {
 public:
  using Place = std::pair<std::uint32_t, std::uint32_t>;  // i, j
  ClearPlaces(const FacePoints& points, const CapMargins<GrowingMemory>& margins)
      : points_(points), margins_(margins) {}

  std::vector<Place> of_face(std::uint32_t n) {
    std::vector<std::uint32_t> all(margins_.bounds().size());
    std::iota(all.begin(), all.end(), 0u);
    find({1, 0}, {n, n}, all);
    std::sort(places_.begin(), places_.end());
    return std::move(places_);
  }

 private:
  // All places from `low` to `high`, both with them. Rows have j <= i. Only the caps `some` may
  // meet the block, so a cap is looked at in the blocks near its circle alone.
  void find(Place low, Place high, std::span<const std::uint32_t> some) {
    low.first = std::max(low.first, low.second);
    high.second = std::min(high.second, high.first);
    if (low.first > high.first || low.second > high.second) return;
    std::vector<std::uint32_t> near;
    if (is_covered(low, high, some, near)) return;
    constexpr std::uint32_t kSmall = 4;
    const std::uint32_t rows = high.first - low.first, width = high.second - low.second;
    if (near.empty() || std::max(rows, width) < kSmall) return add(low, high);
    if (rows > width) {
      const std::uint32_t middle = low.first + rows / 2;
      find(low, {middle, high.second}, near);
      find({middle + 1, low.second}, high, near);
    } else {
      const std::uint32_t middle = low.second + width / 2;
      find(low, {high.first, middle}, near);
      find({low.first, middle + 1}, high, near);
    }
  }

  void add(const Place& low, const Place& high) {
    for (std::uint32_t i = low.first; i <= high.first; ++i) {
      for (std::uint32_t j = low.second; j <= std::min(i, high.second); ++j) {
        if (points_.has(i, j)) places_.emplace_back(i, j);
      }
    }
  }

  // On the sphere a block lies in every cap, less than half of the sphere, that has its corners.
  bool is_covered(const Place& low, const Place& high, std::span<const std::uint32_t> some,
                  std::vector<std::uint32_t>& near) const {
    const std::array<Vec3d, 5> corners{
        points_.at(low.first, low.second), points_.at(low.first, std::min(high.second, low.first)),
        points_.at(std::max(low.first, high.second), high.second),
        points_.at(high.first, high.second), points_.at(high.first, low.second)};
    Vec3d sum{0, 0, 0};
    for (const Vec3d& c : corners) sum = sum + c;
    const Vec3d center = (1 / norm(sum)) * sum;
    double farthest = 0;
    for (const Vec3d& c : corners) farthest = std::max(farthest, norm(c - center));
    return margins_.covers(center, 2 * std::asin(farthest / 2), some, near);
  }

  const FacePoints& points_;
  const CapMargins<GrowingMemory>& margins_;
  std::vector<Place> places_;
};

// The points of the icosahedron whose edges are divided into n parts.
VDWMESH_MULTIVERSION std::vector<Vec3d> divided_points(std::uint32_t n) {
  const std::vector<Vec3d> corners = icosahedron_points();
  std::vector<Vec3d> points = corners;
  points.reserve(10 * std::size_t{n} * n + 2);
  for (const auto& face : kFaces) {
    const FacePoints of_face(face, corners, n);
    for (std::uint32_t i = 1; i <= n; ++i) {
      for (std::uint32_t j = 0; j <= i; ++j) {
        if (of_face.has(i, j)) points.push_back(of_face.at(i, j));
      }
    }
  }
  return points;
}

}  // namespace

std::uint32_t SpherePoints::parts(double edge_length) { return parts_of_edge(edge_length); }

const std::vector<Vec3d>& SpherePoints::points(double edge_length) {
  const std::uint32_t parts = SpherePoints::parts(edge_length);
  auto& [kept, points] = kept_[parts % kept_.size()];
  if (kept != parts) {
    points = divided_points(parts);
    kept = parts;
  }
  return points;
}

const std::vector<Vec3d>& SpherePoints::points(double edge_length,
                                               const CapMargins<GrowingMemory>& margins) {
  const std::uint32_t n = SpherePoints::parts(edge_length);
  if (n <= kMostPartsOfWhole) return points(edge_length);
  const std::vector<Vec3d> corners = icosahedron_points();
  some_ = corners;
  for (const auto& face : kFaces) {
    const FacePoints of_face(face, corners, n);
    for (const auto& [i, j] : ClearPlaces(of_face, margins).of_face(n)) {
      some_.push_back(of_face.at(i, j));
    }
  }
  return some_;
}

}  // namespace vdwmesh
