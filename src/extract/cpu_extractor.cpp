#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <iterator>

#include "core/multiversion.hpp"
#include "extract/blended_brick.hpp"
#include "extract/brick_search.hpp"
#include "extract/case_table.hpp"
#include "extract/extractor.hpp"
#include "extract/field_sample.hpp"
#include "extract/union_brick.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kBricksPerTask = 32;

// A brick that the surface crosses, after counting.
struct ActiveBrick {
  std::uint64_t key;
  std::uint32_t vertices, triangles, clipped_cells;
  std::uint16_t row_start[kBrickSide * kBrickSide];  // vertices before each row
  BrickSigns signs;
};

struct Job {
  const CellListView& list;
  const FieldModel& model;
  const std::vector<std::uint64_t>& candidates;
};

struct Bases {
  std::vector<std::uint64_t> vertices, triangles;  // before each active brick, and in all
};

// What emission reads and writes.
struct Emission {
  const CellListView& list;
  const FieldModel& model;
  const std::vector<ActiveBrick>& bricks;
  const Bases& bases;
  IndexedMesh& mesh;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// ---- counting ----------------------------------------------------------------------------------

std::uint32_t count_triangles(const BrickSigns& signs, const BrickGeometry& geometry,
                              const CaseTable& table, std::uint32_t& clipped_cells) {
  std::uint32_t triangles = 0;
  const std::uint32_t virtual_x = ~(geometry.real[0] & geometry.real[0] >> 1);
  for (int z = 0; z < kBrickSide; ++z) {
    const bool virtual_z = (geometry.real[2] >> z & 3) != 3;
    for (int y = 0; y < kBrickSide; ++y) {
      const bool virtual_yz = virtual_z || (geometry.real[1] >> y & 3) != 3;
      for (std::uint32_t cells = mixed_cells(signs, y, z); cells != 0; cells &= cells - 1) {
        const int x = std::countr_zero(cells);
        triangles += table.triangle_count[cell_case(signs, x, y, z)];
        clipped_cells += virtual_yz || (virtual_x >> x & 1) != 0 ? 1u : 0u;
      }
    }
  }
  return triangles;
}

std::uint32_t count_vertices(const BrickSigns& signs,
                             std::uint16_t (&row_start)[kBrickSide * kBrickSide]) {
  int vertices = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      row_start[z * kBrickSide + y] = static_cast<std::uint16_t>(vertices);
      vertices += vertex_count(row_crossings(signs, y, z));
    }
  }
  return static_cast<std::uint32_t>(vertices);
}

template <class Surface>
void count_bricks(const Job& job, std::size_t begin, std::size_t end,
                  std::vector<ActiveBrick>& active) {
  Surface surface(job.list, job.model);
  const CaseTable& table = case_table();
  for (std::size_t i = begin; i < end; ++i) {
    ActiveBrick brick;
    brick.key = job.candidates[i];
    const BrickIndex index = brick_of_key(brick.key);
    surface.visit(index);
    surface.signs(brick.signs);
    brick.clipped_cells = 0;
    brick.triangles = count_triangles(brick.signs, brick_geometry(job.model.grid, index), table,
                                      brick.clipped_cells);
    // A crossed edge always belongs to a crossed cell of its own brick or of an earlier one.
    brick.vertices = count_vertices(brick.signs, brick.row_start);
    if (brick.triangles != 0 || brick.vertices != 0) active.push_back(brick);
  }
}

// ---- emission ----------------------------------------------------------------------------------

template <class Surface>
std::uint64_t emit_vertices(const Emission& e, std::size_t b, Surface& surface) {
  const ActiveBrick& brick = e.bricks[b];
  surface.visit(brick_of_key(brick.key));
  std::uint64_t next = e.bases.vertices[b], clamped = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      const RowCrossings c = row_crossings(brick.signs, y, z);
      for (std::uint32_t nodes = c.along[0] | c.along[1] | c.along[2]; nodes; nodes &= nodes - 1) {
        const int x = std::countr_zero(nodes);
        const bool inside = (brick.signs.row[z][y] >> x & 1) != 0;
        for (int axis = 0; axis < 3; ++axis) {
          if ((c.along[axis] >> x & 1) == 0) continue;
          const SurfaceVertex v = surface.vertex(crossed_edge(inside, x, y, z, axis));
          e.mesh.positions[next] = v.position;
          e.mesh.normals[next] = v.normal;
          e.mesh.vertex_spheres[next] = on_sphere(v.sphere);
          clamped += v.clamped ? 1 : 0;
          ++next;
        }
      }
    }
  }
  return clamped;
}

// Numbers of the vertices on the edges of a brick's cells: its own and those of the bricks behind
// its upper faces, found when first asked for.
class VertexNumbers {
 public:
  VertexNumbers(const Emission& e, std::size_t brick) : e_(e), brick_(brick) {
    found_.fill(kNotSought);
    found_[0] = brick;
  }

  std::uint32_t operator()(int x, int y, int z, int axis) {
    const int next = x >> 3 | (y >> 3) << 1 | (z >> 3) << 2;
    const std::size_t b = find(next);
    const ActiveBrick& owner = e_.bricks[b];
    x &= kBrickSide - 1;
    y &= kBrickSide - 1;
    z &= kBrickSide - 1;
    const int place = owner.row_start[z * kBrickSide + y] +
                      place_in_row(row_crossings(owner.signs, y, z), x, axis);
    return static_cast<std::uint32_t>(e_.bases.vertices[b] + static_cast<std::uint64_t>(place));
  }

 private:
  static constexpr std::size_t kNotSought = ~std::size_t{0};

  std::size_t find(int next) {
    std::size_t& found = found_[static_cast<std::size_t>(next)];
    if (found == kNotSought) {
      BrickIndex index = brick_of_key(e_.bricks[brick_].key);
      index.x += next & 1;
      index.y += next >> 1 & 1;
      index.z += next >> 2;
      // Bounds are conservative: a brick that owns a vertex is in the list.
      const std::uint64_t key = brick_key(index);
      const auto behind = e_.bricks.begin() + static_cast<std::ptrdiff_t>(brick_);
      const auto place =
          std::lower_bound(behind, e_.bricks.end(), key,
                           [](const ActiveBrick& brick, std::uint64_t k) { return brick.key < k; });
      found = static_cast<std::size_t>(place - e_.bricks.begin());
    }
    return found;
  }

  const Emission& e_;
  std::size_t brick_;
  std::array<std::size_t, 8> found_;
};

void emit_triangles(const Emission& e, std::size_t b) {
  const BrickSigns& signs = e.bricks[b].signs;
  const CaseTable& table = case_table();
  VertexNumbers number(e, b);
  std::uint64_t next = e.bases.triangles[b];
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      for (std::uint32_t cells = mixed_cells(signs, y, z); cells != 0; cells &= cells - 1) {
        const int x = std::countr_zero(cells);
        const std::uint32_t inside = cell_case(signs, x, y, z);
        for (int t = 0; t < table.triangle_count[inside]; ++t) {
          Triangle& triangle = e.mesh.triangles[next++];
          for (int k = 0; k < 3; ++k) {
            const CellEdge edge =
                cell_edge(table.edges[inside][static_cast<std::size_t>(3 * t + k)]);
            triangle[static_cast<std::size_t>(k)] =
                number(x + edge.x, y + edge.y, z + edge.z, edge.axis);
          }
        }
      }
    }
  }
}

template <class Surface>
std::uint64_t emit_bricks(const Emission& e, std::size_t begin, std::size_t end) {
  Surface surface(e.list, e.model);
  std::uint64_t clamped = 0;
  for (std::size_t b = begin; b < end; ++b) {
    clamped += emit_vertices(e, b, surface);
    emit_triangles(e, b);
  }
  return clamped;
}

// ---- the loops in both processor versions
// --------------------------------------------------------

using Active = std::vector<ActiveBrick>;
using Blinn = BlendedBrick<FieldKind::blinn>;
using SoftObject = BlendedBrick<FieldKind::soft_object>;
using InverseSquared = BlendedBrick<FieldKind::inverse_squared>;

VDWMESH_MULTIVERSION void count_vdw(const Job& j, std::size_t a, std::size_t b, Active& out) {
  count_bricks<UnionBrick>(j, a, b, out);
}
VDWMESH_MULTIVERSION void count_blinn(const Job& j, std::size_t a, std::size_t b, Active& out) {
  count_bricks<Blinn>(j, a, b, out);
}
VDWMESH_MULTIVERSION void count_soft(const Job& j, std::size_t a, std::size_t b, Active& out) {
  count_bricks<SoftObject>(j, a, b, out);
}
VDWMESH_MULTIVERSION void count_inverse(const Job& j, std::size_t a, std::size_t b, Active& out) {
  count_bricks<InverseSquared>(j, a, b, out);
}
VDWMESH_MULTIVERSION std::uint64_t emit_vdw(const Emission& e, std::size_t a, std::size_t b) {
  return emit_bricks<UnionBrick>(e, a, b);
}
VDWMESH_MULTIVERSION std::uint64_t emit_blinn(const Emission& e, std::size_t a, std::size_t b) {
  return emit_bricks<Blinn>(e, a, b);
}
VDWMESH_MULTIVERSION std::uint64_t emit_soft(const Emission& e, std::size_t a, std::size_t b) {
  return emit_bricks<SoftObject>(e, a, b);
}
VDWMESH_MULTIVERSION std::uint64_t emit_inverse(const Emission& e, std::size_t a, std::size_t b) {
  return emit_bricks<InverseSquared>(e, a, b);
}

struct Kernels {
  void (*count)(const Job&, std::size_t, std::size_t, Active&);
  std::uint64_t (*emit)(const Emission&, std::size_t, std::size_t);
};

Kernels kernels_of(FieldKind kind) {
  switch (kind) {
    case FieldKind::vdw:
      return {count_vdw, emit_vdw};
    case FieldKind::blinn:
      return {count_blinn, emit_blinn};
    case FieldKind::soft_object:
      return {count_soft, emit_soft};
    default:
      return {count_inverse, emit_inverse};
  }
}

// Calls body(task, begin, end) for consecutive pieces of [0, count) on all cores.
template <class Body>
void for_tasks(std::size_t count, Monitor* monitor, Body body) {
  const std::size_t tasks = (count + kBricksPerTask - 1) / kBricksPerTask;
  tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
    const std::size_t begin = task * kBricksPerTask;
    const std::size_t end = std::min(count, begin + kBricksPerTask);
    body(task, begin, end);
    advance(monitor, end - begin);
  });
}

std::size_t task_count(std::size_t count) { return (count + kBricksPerTask - 1) / kBricksPerTask; }

Active count_all(const Job& job, const Kernels& kernels, Monitor* monitor) {
  std::vector<Active> parts(task_count(job.candidates.size()));
  begin_stage(monitor, "field", job.candidates.size());
  for_tasks(job.candidates.size(), monitor, [&](std::size_t task, std::size_t a, std::size_t b) {
    kernels.count(job, a, b, parts[task]);
  });
  std::size_t total = 0;
  for (const Active& part : parts) total += part.size();
  Active all;
  all.reserve(total);
  for (Active& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
    Active().swap(part);
  }
  return all;
}

Bases sum_up(const Active& bricks) {
  Bases bases;
  bases.vertices.resize(bricks.size() + 1);
  bases.triangles.resize(bricks.size() + 1);
  for (std::size_t b = 0; b < bricks.size(); ++b) {
    bases.vertices[b + 1] = bases.vertices[b] + bricks[b].vertices;
    bases.triangles[b + 1] = bases.triangles[b] + bricks[b].triangles;
  }
  return bases;
}

void check_limits(const Active& bricks, std::uint64_t vertices, std::uint64_t triangles,
                  const ExtractOptions& options) {
  if (vertices > kMaxVertices) {
    throw LimitExceeded(fmt::format(
        "{} vertices; a mesh holds at most {}: choose a spacing of at least {:.3g} Å", vertices,
        kMaxVertices,
        options.grid.spacing * std::sqrt(static_cast<double>(vertices) / kMaxVertices) * 1.01));
  }
  const std::uint64_t need =
      indexed_mesh_bytes(vertices, triangles) + bricks.size() * (sizeof(ActiveBrick) + 16);
  if (need > options.memory_limit) {
    throw LimitExceeded(fmt::format(
        "{} vertices and {} triangles need {} bytes, {} are allowed: choose a spacing of at least "
        "{:.3g} Å or a higher memory limit",
        vertices, triangles, need, options.memory_limit,
        options.grid.spacing *
            std::sqrt(static_cast<double>(need) / static_cast<double>(options.memory_limit)) *
            1.02));
  }
}

class CpuExtractor final : public Extractor {
 public:
  ExtractResult extract(const SphereSet& spheres, const ExtractOptions& options) const override {
    auto start = std::chrono::steady_clock::now();
    ExtractResult result;
    result.grid = make_grid(spheres, options.grid);
    const FieldModel model = make_field_model(options.field, result.grid);
    const CellList list = make_field_list(spheres, model);
    const Kernels kernels = kernels_of(model.kind);
    const Active bricks = [&] {
      const std::vector<std::uint64_t> candidates = candidate_bricks(
          list.view(), model, options.memory_limit / sizeof(ActiveBrick), options.monitor);
      return count_all({list.view(), model, candidates}, kernels, options.monitor);
    }();
    const Bases bases = sum_up(bricks);
    result.stats.surface_bricks = bricks.size();
    for (const ActiveBrick& brick : bricks) result.stats.grid_clipped += brick.clipped_cells;
    check_limits(bricks, bases.vertices.back(), bases.triangles.back(), options);
    result.stats.field_seconds = seconds_since(start);

    start = std::chrono::steady_clock::now();
    IndexedMesh& mesh = result.mesh;
    mesh.positions.resize(bases.vertices.back());
    mesh.normals.resize(bases.vertices.back());
    mesh.vertex_spheres.resize(bases.vertices.back());
    mesh.triangles.resize(bases.triangles.back());
    const Emission emission{list.view(), model, bricks, bases, mesh};
    std::vector<std::uint64_t> clamped(task_count(bricks.size()));
    begin_stage(options.monitor, "extract", bricks.size());
    for_tasks(bricks.size(), options.monitor, [&](std::size_t task, std::size_t a, std::size_t b) {
      clamped[task] = kernels.emit(emission, a, b);
    });
    for (const std::uint64_t c : clamped) result.stats.clamped_vertices += c;
    result.stats.extract_seconds = seconds_since(start);
    return result;
  }
};

}  // namespace

std::unique_ptr<Extractor> make_cpu_extractor() { return std::make_unique<CpuExtractor>(); }

}  // namespace vdwmesh
