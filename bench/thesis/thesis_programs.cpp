// The two CPU programs of Dias's thesis, in single precision, on one thread and on a dense grid.
//
//  1. thesis_grid(): the grid around the atom centres.
//  2. thesis_field(): every atom adds its function to the nodes of its sub-grid.
//  3. thesis_marching_cubes(): marching cubes over all voxels, with linear interpolation along the
//     edges and normals from the analytic gradient, summed over all atoms.
//
// The programs are a baseline for timings and are deliberately simple. From the extractor they use
// only the case table: case_table() has the triangles of each of the 256 sign patterns of a voxel's
// corners, as triples of edge numbers, and cell_edge() the lower end and the axis of each edge.
// docs/thesis.md says how the parameters were recovered. In the comments below d2 is a squared
// distance in Å², h the spacing in Å, and b the parameter `blob`. A voxel is a cell of the grid,
// and is named by the node at its lower corner.
#include "thesis/thesis_programs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "extract/bricks/case_table.hpp"

namespace vdwmesh {
namespace {

using PointF = Vec3f;
using Voxel = Vec3i;

// Returns the value of one atom's function f at squared distance d2, in units of its amplitude (a
// for Blinn and the soft object, C for inverse squared).
//   Blinn:            f = exp(-b d2)
//   inverse squared:  f = 1 / d2; d2 is kept above (h / 1000)², so that f is finite at the centre
//   soft object:      f = 1 - 22/9 q + 17/9 q² - 4/9 q³ with q = d2 / b², and 0 for q > 1 (Wyvill)
float contribution(const ThesisParameters& p, float d2) {
  const float b = static_cast<float>(p.blob);
  if (p.function == ThesisFunction::blinn) return std::exp(-b * d2);
  if (p.function == ThesisFunction::inverse_squared) {
    const float smallest = 1e-3f * static_cast<float>(p.spacing);
    return 1.0f / std::max(d2, smallest * smallest);
  }
  const float q = d2 / (b * b);
  if (q > 1.0f) return 0.0f;
  return 1.0f + q * (-22.0f / 9.0f + q * (17.0f / 9.0f - q * (4.0f / 9.0f)));
}

// Returns the derivative of f by d2. The gradient of f at a point x is twice this times (x - c) for
// an atom at c. The inverse square has no lower bound of d2 here, unlike contribution(): the slope
// is evaluated at vertices of the surface only, not at atom centres.
float slope(const ThesisParameters& p, float d2) {
  const float b = static_cast<float>(p.blob);
  if (p.function == ThesisFunction::blinn) return -b * std::exp(-b * d2);
  if (p.function == ThesisFunction::inverse_squared) return -1.0f / (d2 * d2);
  const float q = d2 / (b * b);
  if (q > 1.0f) return 0.0f;
  return (-22.0f / 9.0f + q * (34.0f / 9.0f - q * (12.0f / 9.0f))) / (b * b);
}

// Returns the atom's position relative to the grid's origin, in single precision. Relative
// coordinates are at most as large as the grid, so they keep more digits than absolute ones.
PointF relative(const Vec3d& atom, const ThesisGrid& grid) {
  return cast<float>(atom - grid.origin);
}

// The number of nodes along each axis, one more than voxels, and the index of a node in the field's
// array (x fastest).
struct Nodes {
  std::int64_t nx, ny, nz;
  explicit Nodes(const ThesisGrid& g)
      : nx(g.voxels[0] + 1), ny(g.voxels[1] + 1), nz(g.voxels[2] + 1) {}
  std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>((z * ny + y) * nx + x);
  }
};

// Adds the function of an atom at c to the nodes of its sub-grid (the enumeration SubGrid in the
// header says which nodes), clipped to the grid. c is relative to the origin of the grid.
void add_atom(const PointF& c, const ThesisGrid& grid, const ThesisParameters& p,
              std::vector<float>& field) {
  const Nodes nodes(grid);
  const float h = static_cast<float>(p.spacing);
  Voxel first, last;
  for (int a = 0; a < 3; ++a) {
    const auto v = static_cast<std::int64_t>(std::floor(c[a] / h));
    const std::int64_t high = v + p.half_width + (p.sub_grid == SubGrid::voxels ? 1 : 0);
    first[a] = std::max<std::int64_t>(0, v - p.half_width);
    last[a] = std::min(grid.voxels[a], high);
  }
  for (std::int64_t z = first[2]; z <= last[2]; ++z) {
    const float dz = static_cast<float>(z) * h - c[2];
    for (std::int64_t y = first[1]; y <= last[1]; ++y) {
      const float dy = static_cast<float>(y) * h - c[1];
      for (std::int64_t x = first[0]; x <= last[0]; ++x) {
        const float dx = static_cast<float>(x) * h - c[0];
        field[nodes.index(x, y, z)] += contribution(p, dx * dx + dy * dy + dz * dz);
      }
    }
  }
}

// Returns the case of voxel v: bit c is set if the value at corner c is at least the threshold t,
// that is, if the corner is inside. The lowest bit of the number c is the offset of the corner
// along x, the next one along y, and the highest one along z.
unsigned voxel_flag(const std::vector<float>& field, const Nodes& nodes, const Voxel& v, float t) {
  unsigned flag = 0;
  for (int c = 0; c < 8; ++c) {
    const float value = field[nodes.index(v[0] + (c & 1), v[1] + (c >> 1 & 1), v[2] + (c >> 2))];
    if (value >= t) flag |= 1u << c;
  }
  return flag;
}

// Calls visit(voxel) for all voxels, x fastest.
template <class Visit>
void for_each_voxel(const ThesisGrid& grid, Visit&& visit) {
  for (std::int64_t z = 0; z < grid.voxels[2]; ++z) {
    for (std::int64_t y = 0; y < grid.voxels[1]; ++y) {
      for (std::int64_t x = 0; x < grid.voxels[0]; ++x) visit(Voxel{x, y, z});
    }
  }
}

// Marching cubes over a sampled field.
class MarchingCubes {
 public:
  MarchingCubes(std::span<const Vec3d> atoms, const std::vector<float>& field,
                const ThesisGrid& grid, const ThesisParameters& parameters, SharedVertices shared)
      : field_(field), nodes_(grid), grid_(grid), p_(parameters), shared_(shared) {
    for (const Vec3d& atom : atoms) atoms_.push_back(relative(atom, grid));
  }

  ThesisMesh run() {
    const float t = static_cast<float>(p_.threshold);
    for_each_voxel(grid_, [&](const Voxel& v) { march(v, voxel_flag(field_, nodes_, v, t)); });
    return std::move(mesh_);
  }

 private:
  // Appends the triangles of one voxel. `ids` are the vertices on its twelve edges; the largest
  // number means that no triangle has needed the vertex yet. In the cases 0 and 255 all corners are
  // on one side.
  void march(const Voxel& v, unsigned flag) {
    if (flag == 0 || flag == 255) return;
    std::array<std::uint32_t, 12> ids;
    ids.fill(std::numeric_limits<std::uint32_t>::max());
    const CaseTable& table = case_table();
    for (std::uint32_t t = 0; t < table.count(flag); ++t) {
      Triangle corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const int edge = table.edges[flag][std::size_t{3} * t + k];
        std::uint32_t& id = ids[static_cast<std::size_t>(edge)];
        if (id == std::numeric_limits<std::uint32_t>::max()) id = vertex(v, edge);
        corners[k] = id;
      }
      mesh_.triangles.push_back(corners);
    }
  }

  // Returns the vertex on an edge of voxel v. With SharedVertices::recomputed every voxel makes its
  // own copy. Otherwise a hash table finds the vertex if another voxel has made it; the key
  // 3 · node + axis identifies the grid edge that leaves `node` along `axis`.
  std::uint32_t vertex(const Voxel& v, int edge) {
    const CellEdge e = cell_edge(edge);
    const Voxel a{v.x + e.x, v.y + e.y, v.z + e.z};
    Voxel b = a;
    ++b[e.axis];
    const std::size_t node = nodes_.index(a[0], a[1], a[2]);
    if (shared_ == SharedVertices::recomputed) return new_vertex(a, b, node);
    const std::size_t key = 3 * node + e.axis;
    const auto found = table_.find(key);
    if (found != table_.end()) return found->second;
    const std::uint32_t id = new_vertex(a, b, node);
    table_.emplace(key, id);
    return id;
  }

  // Makes the vertex between the nodes a and b = a + 1 along one axis, by linear interpolation to
  // the threshold (equation 2.3 of the thesis).
  std::uint32_t new_vertex(const Voxel& a, const Voxel& b, std::size_t node_a) {
    const float fa = field_[node_a], fb = field_[nodes_.index(b[0], b[1], b[2])];
    const float s = (static_cast<float>(p_.threshold) - fa) / (fb - fa);
    const float h = static_cast<float>(p_.spacing);
    PointF position;
    for (int k = 0; k < 3; ++k) {
      position[k] = h * (static_cast<float>(a[k]) + s * static_cast<float>(b[k] - a[k]));
    }
    mesh_.positions.push_back(position);
    mesh_.normals.push_back(normal(position));
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }

  // Returns the unit normal at a point: the direction of the negative gradient. The sum runs over
  // all atoms, not only over the atoms whose sub-grid contains the point; the timings in the thesis
  // show that its programs do the same. The factor 2 of the gradient is left out, because the
  // normal is divided by its length.
  PointF normal(const PointF& at) const {
    PointF sum{0, 0, 0};
    for (const PointF& c : atoms_) {
      const float dx = at[0] - c[0], dy = at[1] - c[1], dz = at[2] - c[2];
      const float g = slope(p_, dx * dx + dy * dy + dz * dz);
      sum[0] -= g * dx;
      sum[1] -= g * dy;
      sum[2] -= g * dz;
    }
    const float n = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    return {sum[0] / n, sum[1] / n, sum[2] / n};
  }

  const std::vector<float>& field_;
  Nodes nodes_;
  const ThesisGrid& grid_;
  ThesisParameters p_;
  SharedVertices shared_;
  std::vector<PointF> atoms_;
  std::unordered_map<std::size_t, std::uint32_t> table_;  // grid edge (3 · node + axis) -> vertex
  ThesisMesh mesh_;
};

}  // namespace

ThesisParameters thesis_parameters(ThesisFunction function) {
  ThesisParameters p;
  p.function = function;
  if (function == ThesisFunction::soft_object) p.blob = 1.6, p.threshold = 0.63;
  if (function == ThesisFunction::blinn) p.blob = 0.8, p.threshold = 0.70;
  return p;
}

ThesisParameters thesis_vdw_parameters() {
  ThesisParameters p;
  p.padding = 1.2;
  p.threshold = 4.6;
  p.half_width = 4;
  return p;
}

ThesisGrid thesis_grid(std::span<const Vec3d> atoms, const ThesisParameters& p) {
  Vec3d low = atoms.front(), high = atoms.front();
  for (const Vec3d& c : atoms) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], c[a]);
      high[a] = std::max(high[a], c[a]);
    }
  }
  ThesisGrid grid{};
  for (int a = 0; a < 3; ++a) {
    grid.origin[a] = low[a] - p.padding;
    grid.voxels[a] =
        static_cast<std::int64_t>(std::floor((high[a] - low[a] + 2 * p.padding) / p.spacing));
  }
  return grid;
}

std::vector<float> thesis_field(std::span<const Vec3d> atoms, const ThesisGrid& grid,
                                const ThesisParameters& parameters) {
  const Nodes nodes(grid);
  std::vector<float> field(static_cast<std::size_t>(nodes.nx * nodes.ny * nodes.nz), 0.0f);
  for (const Vec3d& atom : atoms) add_atom(relative(atom, grid), grid, parameters, field);
  return field;
}

std::int64_t count_triangles(const std::vector<float>& field, const ThesisGrid& grid,
                             double threshold) {
  const Nodes nodes(grid);
  const float t = static_cast<float>(threshold);
  std::size_t count = 0;
  for_each_voxel(
      grid, [&](const Voxel& v) { count += case_table().count(voxel_flag(field, nodes, v, t)); });
  return static_cast<std::int64_t>(count);
}

ThesisMesh thesis_marching_cubes(std::span<const Vec3d> atoms, const std::vector<float>& field,
                                 const ThesisGrid& grid, const ThesisParameters& parameters,
                                 SharedVertices shared) {
  return MarchingCubes(atoms, field, grid, parameters, shared).run();
}

}  // namespace vdwmesh
