#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>

#include "core/multiversion.hpp"
#include "extract/blended_brick.hpp"
#include "extract/brick_numbering.hpp"
#include "extract/brick_search.hpp"
#include "extract/case_table.hpp"
#include "extract/extractor.hpp"
#include "extract/field_sample.hpp"
#include "extract/limits.hpp"
#include "extract/union_brick.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kBricksPerTask = 32;

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
  BrickList bricks;
  IndexedMesh& mesh;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// ---- counting ----

void count_triangles(const BrickGeometry& geometry, const CaseTable& table, ActiveBrick& brick) {
  brick.triangles = 0;
  brick.clipped_cells = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      brick.row_triangles[z * kBrickSide + y] = static_cast<std::uint16_t>(brick.triangles);
      const std::uint32_t mixed = mixed_cells(brick.signs, y, z);
      for (std::uint32_t cells = mixed; cells != 0; cells &= cells - 1) {
        brick.triangles += table.count(cell_case(brick.signs, std::countr_zero(cells), y, z));
      }
      brick.clipped_cells +=
          static_cast<std::uint32_t>(count_bits(mixed & border_cells(geometry, y, z)));
    }
  }
}

void count_vertices(ActiveBrick& brick) {
  int vertices = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      brick.row_vertices[z * kBrickSide + y] = static_cast<std::uint16_t>(vertices);
      vertices += vertex_count(row_crossings(brick.signs, y, z));
    }
  }
  brick.vertices = static_cast<std::uint32_t>(vertices);
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
    count_triangles(brick_geometry(job.model.grid, index), table, brick);
    count_vertices(brick);
    if (brick.triangles != 0 || brick.vertices != 0) active.push_back(brick);
  }
}

// ---- emission ----

template <class Surface>
std::uint64_t emit_vertices(const Emission& e, std::size_t b, Surface& surface) {
  const ActiveBrick& brick = e.bricks.bricks[b];
  surface.visit(brick_of_key(brick.key));
  std::uint64_t next = e.bricks.vertices[b], clamped = 0;
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

// Places of the brick's neighbours, each found when first asked for.
class Neighbourhood {
 public:
  Neighbourhood(const BrickList& list, std::uint64_t brick)
      : list_(list), key_(list.bricks[brick].key) {
    found_.fill(kNotSought);
    found_[neighbour_slot(0, 0, 0)] = brick;
  }

  std::uint64_t operator()(int slot) {
    std::uint64_t& found = found_[static_cast<std::size_t>(slot)];
    if (found == kNotSought) found = find_neighbour(list_, key_, slot);
    return found;
  }

 private:
  static constexpr std::uint64_t kNotSought = ~std::uint64_t{0};
  const BrickList& list_;
  std::uint64_t key_;
  std::array<std::uint64_t, kNeighbours> found_;
};

void emit_cell(const Emission& e, Neighbourhood& near, std::uint64_t first, int x, int y, int z,
               std::uint32_t inside) {
  const CaseTable& table = case_table();
  for (std::uint32_t h = 0; h < 3 * table.count(inside); ++h) {
    const CellEdge edge = cell_edge(table.edges[inside][h]);
    const std::uint64_t half_edge = first + h;
    e.mesh.triangles[half_edge / 3][half_edge % 3] =
        vertex_number(e.bricks, locate(near, x + edge.x, y + edge.y, z + edge.z), edge.axis);
    if (e.mesh.opposite.empty()) continue;
    e.mesh.opposite[half_edge] =
        opposite_half_edge(e.bricks, table, near, first, x, y, z, inside, static_cast<int>(h));
  }
}

void emit_triangles(const Emission& e, std::size_t b) {
  const BrickSigns& signs = e.bricks.bricks[b].signs;
  Neighbourhood near(e.bricks, b);
  std::uint64_t next = 3 * e.bricks.triangles[b];
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      for (std::uint32_t cells = mixed_cells(signs, y, z); cells != 0; cells &= cells - 1) {
        const int x = std::countr_zero(cells);
        const std::uint32_t inside = cell_case(signs, x, y, z);
        emit_cell(e, near, next, x, y, z, inside);
        next += 3 * case_table().count(inside);
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

// ---- the loops in both processor versions ----

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
    check_mesh_limits({bases.vertices.back(), bases.triangles.back(), options.connectivity,
                       bricks.size() * (sizeof(ActiveBrick) + 16), result.grid.spacing},
                      options.memory_limit);
    result.stats.field_seconds = seconds_since(start);

    start = std::chrono::steady_clock::now();
    IndexedMesh& mesh = result.mesh;
    mesh.positions.resize(bases.vertices.back());
    mesh.normals.resize(bases.vertices.back());
    mesh.vertex_spheres.resize(bases.vertices.back());
    mesh.triangles.resize(bases.triangles.back());
    if (options.connectivity == Connectivity::half_edges) {
      mesh.opposite.resize(3 * bases.triangles.back());
    }
    const BrickList numbered{bricks.data(), bases.vertices.data(), bases.triangles.data(),
                             bricks.size()};
    const Emission emission{list.view(), model, numbered, mesh};
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
