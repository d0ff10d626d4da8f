#include "support/plain_extractor.hpp"

#include "extract/blended/blended_brick.hpp"
#include "extract/bricks/brick_extraction.hpp"
#include "extract/field_kinds.hpp"
#include "extract/field_list.hpp"
#include "extract/union/union_brick.hpp"
#include "support/mesh_bricks.hpp"

namespace vdwmesh::testing {
namespace {

// Asks every node of a brick.
template <class IsInside>
BrickSigns signs_where(const BrickGeometry& geometry, const IsInside& is_inside) {
  BrickSigns signs{};
  for (int z = 0; z < kBrickReach; ++z) {
    for (int y = 0; y < kBrickReach; ++y) {
      std::uint32_t bits = 0;
      for (int x = 0; x < kBrickReach; ++x) bits |= (is_inside(x, y, z) ? 1u : 0u) << x;
      signs.row[z][y] = static_cast<std::uint16_t>(bits);
    }
  }
  clear_virtual_nodes(geometry, signs);
  return signs;
}

// The union of balls: each node and each edge asks every ball.
class PlainUnion {
 public:
  PlainUnion(const CellListView& list, const FieldModel& model) : list_(list), model_(model) {}

  void visit(const BrickIndex& brick) { geometry_ = brick_geometry(model_.grid, brick); }

  void signs(BrickSigns& signs) const {
    signs = signs_where(geometry_, [&](int x, int y, int z) { return is_inside(x, y, z); });
  }

  template <class Put>
  void vertices(const BrickEdges& edges, Put&& put) const {
    for (std::size_t i = 0; i < edges.all().size(); ++i) put(i, vertex(edges.all()[i].crossed()));
  }

 private:
  bool is_inside(int x, int y, int z) const {
    for (std::uint32_t k = 0; k < list_.size; ++k) {
      if (inside_ball(geometry_.node(x, y, z), list_.spheres[ListPlace{k}])) return true;
    }
    return false;
  }

  EdgeVertex vertex(const CrossedEdge& edge) const {
    const Vec3d node = geometry_.node(edge.inside[0], edge.inside[1], edge.inside[2]);
    const EdgePoint exit =
        first_exit(node, edge.axis, edge.direction, model_.grid.spacing, [&](auto&& visit) {
          for (std::uint32_t k = 0; k < list_.size; ++k)
            visit(list_.spheres[ListPlace{k}], list_.rank[ListPlace{k}], k);
        });
    const Vec3d p = point_on_edge(edge, node, exit.distance);
    return {p, unit_or(p - list_.spheres[ListPlace{exit.owner}].center, edge_direction(edge)),
            list_.id[ListPlace{exit.owner}], exit.clamped};
  }

  const CellListView& list_;
  const FieldModel& model_;
  BrickGeometry geometry_{};
};

// A blended field: each node and each vertex sums over every atom, in list order.
template <BlendedKind Kind>
class PlainField {
 public:
  PlainField(const CellListView& list, const FieldModel& model)
      : list_(list), model_(model), nodes_(Kind::node_shape(model)), atoms_(list.size) {}

  void visit(const BrickIndex& brick) {
    geometry_ = brick_geometry(model_.grid, brick);
    for (std::uint32_t k = 0; k < list_.size; ++k) {
      const Sphere& s = list_.spheres[ListPlace{k}];
      atoms_[k].scale = static_cast<float>(inverse_square_scale(model_, s.radius));
      for (int axis = 0; axis < 3; ++axis) {
        for (int node = 0; node < kBrickReach; ++node) {
          atoms_[k].term[axis][node] =
              brick_term<Kind>(model_, nodes_, geometry_, s, atoms_[k].scale, axis, node);
        }
      }
    }
  }

  void signs(BrickSigns& signs) const {
    const auto isovalue = static_cast<float>(model_.isovalue);
    signs = signs_where(geometry_, [&](int x, int y, int z) {
      const int node[3] = {x, y, z};
      return value(node) >= isovalue;
    });
  }

  template <class Put>
  void vertices(const BrickEdges& edges, Put&& put) const {
    for (std::size_t i = 0; i < edges.all().size(); ++i) put(i, vertex(edges.all()[i].crossed()));
  }

 private:
  struct Atom {
    float scale;
    AxisTerm term[3][kBrickReach];
  };

  float with_atom(const Atom& a, const int node[3], float sum) const {
    const RowTerm row = Kind::row_term(nodes_, a.term[1][node[1]], a.term[2][node[2]]);
    return Kind::add_atom(nodes_, row, a.term[0][node[0]], a.scale, sum);
  }
  float value(const int node[3]) const {
    float sum = 0;
    for (const Atom& a : atoms_) sum = with_atom(a, node, sum);
    return sum;
  }

  // Whether the inside node of the edge lies in the sub-grid of the sphere; always, without one.
  bool counts_at(const CrossedEdge& edge, const Sphere& s) const {
    if (model_.truncation != Truncation::subgrid) return true;
    const std::int32_t brick[3] = {geometry_.brick.x, geometry_.brick.y, geometry_.brick.z};
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t node = lattice_index(brick[axis], edge.inside[axis]) - 1;
      const std::int64_t away = node - subgrid_cell(model_.grid, axis, s.center[axis]);
      if (away < -model_.subgrid_cells || away > model_.subgrid_cells) return false;
    }
    return true;
  }

  EdgeVertex vertex(const CrossedEdge& edge) const {
    EdgeVertex v = vertex_between(value(edge.inside), value(edge.outside),
                                  static_cast<float>(model_.isovalue), model_.grid, edge,
                                  geometry_.node(edge.inside[0], edge.inside[1], edge.inside[2]));
    const ShapeParameters<float> shape = shape_parameters<float>(model_);
    const Vec3f local = cast<float>(v.position - geometry_.node(0, 0, 0));
    LocalGradient g;
    for (std::uint32_t k = 0; k < list_.size; ++k) {
      if (!counts_at(edge, list_.spheres[ListPlace{k}])) continue;
      const Vec3f center =
          cast<float>(list_.spheres[ListPlace{k}].center - geometry_.node(0, 0, 0));
      add_gradient<Kind>(shape, local - center, atoms_[k].scale, list_.rank[ListPlace{k}], k, g);
    }
    if (!(g.strongest.value > 0)) {
      for (std::uint32_t k = 0; k < list_.size; ++k)
        g.strongest.meet(with_atom(atoms_[k], edge.inside, 0.0f), list_.rank[ListPlace{k}], k);
    }
    v.normal = outward_normal(g, v);
    v.sphere = list_.id[ListPlace{g.strongest.atom}];
    return v;
  }

  const CellListView& list_;
  const FieldModel& model_;
  NodeShape nodes_;
  BrickGeometry geometry_{};
  std::vector<Atom> atoms_;
};

template <class Surface>
ExtractResult mesh_all(const CellList& list, const FieldModel& model,
                       const ExtractOptions& options) {
  const BrickLoops loops{[&](std::span<const std::uint64_t> keys, ActiveBrick* out) {
                           Surface surface(list.view(), model);
                           return count_bricks(surface, model.grid, keys, out);
                         },
                         [&](const Emission& e, std::size_t begin, std::size_t end) {
                           Surface surface(list.view(), model);
                           return emit_bricks(e, begin, end, surface);
                         }};
  return mesh_bricks(
      model.grid, [&] { return all_bricks(model.grid); }, loops, LabelWidth::one, options);
}

// With Union for vdw and Field<Kind> for a blended field.
template <class Union, template <class> class Field>
ExtractResult mesh_all(const SphereSet& spheres, const ExtractOptions& options) {
  const FieldModel model = make_field_model(options.field, make_grid(spheres, options.grid));
  const CellList list = make_field_list(spheres, model);
  if (model.kind == FieldKind::vdw) return mesh_all<Union>(list, model, options);
  return with_blended(
      model.kind, [&]<class Kind>(Kind) { return mesh_all<Field<Kind>>(list, model, options); });
}

}  // namespace

std::vector<std::uint64_t> all_bricks(const GridSpec& grid) {
  std::vector<std::uint64_t> keys;
  for (std::int32_t z = 0; z < brick_count(grid.cells.z); ++z) {
    for (std::int32_t y = 0; y < brick_count(grid.cells.y); ++y) {
      for (std::int32_t x = 0; x < brick_count(grid.cells.x); ++x)
        keys.push_back(brick_key({x, y, z}));
    }
  }
  return keys;
}

ExtractResult extract_all_bricks(const SphereSet& spheres, const ExtractOptions& options) {
  return mesh_all<UnionBrick, BlendedBrick>(spheres, options);
}

ExtractResult extract_plainly(const SphereSet& spheres, const ExtractOptions& options) {
  return mesh_all<PlainUnion, PlainField>(spheres, options);
}

}  // namespace vdwmesh::testing
