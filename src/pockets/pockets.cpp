// pockets(): triangulation, dual complex, flow; then each pocket is measured tetrahedron by
// tetrahedron, and its mouths and its widest way out are found.
#include "pockets/pockets.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "complex/dual_complex.hpp"
#include "complex/simplex_shape.hpp"
#include "core/disjoint_sets.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"
#include "pockets/castp_sums.hpp"
#include "pockets/cell_remainder.hpp"
#include "pockets/clearance.hpp"
#include "pockets/escape.hpp"
#include "pockets/pocket_flow.hpp"

namespace vdwmesh {
namespace {

// What one tetrahedron adds to its pocket.
struct CellMeasures {
  CastpSums sums;
  CellRemainder exact;
};

// A face between a pocket and the outside, seen from the pocket's cell.
struct MouthFace {
  std::uint32_t cell, slot;
  double area, rim, area_sum, rim_sum;  // scaled
};

// What a pocket is made of, scaled.
struct PocketParts {
  WideSum volume, area, volume_sum, area_sum;
  std::map<std::uint32_t, WideSum> ball_area;
  std::vector<std::uint32_t> balls;  // of the complex, some repeatedly
  std::vector<MouthFace> mouth_faces;
  std::vector<Sphere> alpha_spheres;
  std::vector<std::array<SphereId, 4>> cells;
  std::uint64_t tetrahedra = 0, poked_faces = 0;
  std::vector<std::uint32_t> sinks;  // cells
  std::uint32_t deepest = kNoIndex;  // cell
  double depth_alpha = -std::numeric_limits<double>::infinity();
};

class PocketMeasurer {
 public:
  PocketMeasurer(const PowerTriangulation& t, const DualComplex& complex, const PocketFlow& flow,
                 const PocketOptions& options)
      : t_(t), complex_(complex), flow_(flow), options_(options), parts_(flow.pockets) {
    if (options.measures == PocketMeasures::exact) neighbors_ = ball_neighbors(t);
  }

  std::vector<Pocket> run() && {
    std::vector<CellMeasures> cells(flow_.cells.size());
    constexpr std::size_t kCellsPerBlock = 64;
    for_each_block(cells.size(), kCellsPerBlock,
                   [&](std::size_t, std::size_t first, std::size_t end) {
                     advance(options_.monitor, 0);
                     for (std::size_t i = first; i < end; ++i) cells[i] = measure(flow_.cells[i]);
                   });
    for (std::size_t i = 0; i < cells.size(); ++i) add_cell(flow_.cells[i], cells[i]);
    std::vector<std::uint32_t> deepest;
    for (const PocketParts& parts : parts_) deepest.push_back(parts.deepest);
    const WidestWays ways(t_, flow_.obtuse, deepest, options_.monitor);
    std::vector<Pocket> pockets;
    for (PocketParts& parts : parts_) {
      pockets.push_back(pocket_of(parts));
      pockets.back().bottleneck_alpha = unscaled(ways.alpha(parts.deepest), 2);
    }
    if (options_.measures == PocketMeasures::exact) add_clearances(pockets);
    sort(pockets);
    return pockets;
  }

 private:
  const Sphere& ball(std::uint32_t i) const { return t_.balls[i]; }
  // A length (dimension 1), area (2) or volume (3) in units of Å.
  double unscaled(double value, int dimension) const {
    return std::ldexp(value, dimension * t_.scale_exponent);
  }
  Vec3d unscaled(const Vec3d& v) const {
    return {unscaled(v.x, 1), unscaled(v.y, 1), unscaled(v.z, 1)};
  }

  CellMeasures measure(std::uint32_t c) const {
    CellMeasures out{castp_sums(t_, complex_, c), {}};
    if (options_.measures == PocketMeasures::exact) {
      out.exact = cell_remainder(t_, neighbors_, c);
    } else {
      out.exact.volume = out.sums.volume, out.exact.area = out.sums.area;
      out.exact.face_area = out.sums.face_area, out.exact.face_rim = out.sums.face_rim;
    }
    return out;
  }

  void add_cell(std::uint32_t c, const CellMeasures& m) {
    PocketParts& parts = parts_[flow_.pocket[c]];
    ++parts.tetrahedra;
    if (options_.measures == PocketMeasures::exact) {
      const auto& v = t_.cells[c];
      parts.alpha_spheres.push_back(alpha_sphere(c));
      parts.cells.push_back({t_.ids[v[0]], t_.ids[v[1]], t_.ids[v[2]], t_.ids[v[3]]});
    }
    parts.volume.add(m.exact.volume), parts.area.add(m.exact.area);
    parts.volume_sum.add(m.sums.volume), parts.area_sum.add(m.sums.area);
    for (const auto& [b, area] : m.exact.ball_area) parts.ball_area[b].add(area);
    for (const std::uint32_t v : t_.cells[c]) {
      if (complex_.in_complex[v]) parts.balls.push_back(v);
    }
    if (flow_.obtuse[c] == 0) add_sink(parts, c);
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t n = t_.neighbors[c][k];
      // A neighbour that is empty and in no pocket is outside, and so is infinity.
      if (complex_.cell_triangles[c][k] != kNoIndex || flow_.pocket[n] != kNoIndex) continue;
      parts.mouth_faces.push_back({.cell = c,
                                   .slot = k,
                                   .area = m.exact.face_area[k],
                                   .rim = m.exact.face_rim[k],
                                   .area_sum = m.sums.face_area[k],
                                   .rim_sum = m.sums.face_rim[k]});
      parts.poked_faces += flow_.obtuse[n] >> t_.slot_of_neighbor(n, c) & 1;
    }
  }

  // In Å.
  Sphere alpha_sphere(std::uint32_t c) const {
    const Vec3d center = center_of(c);
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::uint32_t v : t_.cells[c]) {
      nearest = std::min(nearest, norm(center - ball(v).center) - ball(v).radius);
    }
    return {unscaled(center), unscaled(nearest, 1)};
  }

  // Of sinks of one size, the lowest cell stays the deepest.
  void add_sink(PocketParts& parts, std::uint32_t c) const {
    parts.sinks.push_back(c);
    const double alpha = cell_alpha(t_, c);
    if (!(alpha > parts.depth_alpha)) return;
    parts.depth_alpha = alpha;
    parts.deepest = c;
  }

  Pocket pocket_of(PocketParts& parts) const {
    std::ranges::sort(parts.balls);
    const auto last = std::unique(parts.balls.begin(), parts.balls.end());
    Pocket pocket{};
    pocket.volume = unscaled(parts.volume.value(), 3),
    pocket.area = unscaled(parts.area.value(), 2);
    pocket.volume_sum = unscaled(parts.volume_sum.value(), 3);
    pocket.area_sum = unscaled(parts.area_sum.value(), 2);
    pocket.mouths = mouths_of(parts.mouth_faces);
    pocket.kind = pocket.mouths.empty()       ? PocketKind::enclosed
                  : pocket.mouths.size() == 1 ? PocketKind::pocket
                                              : PocketKind::channel;
    pocket.lining = lining_of(parts);
    pocket.alpha_spheres = std::move(parts.alpha_spheres);
    pocket.cells = std::move(parts.cells);
    for (auto b = parts.balls.begin(); b != last; ++b) pocket.corners.push_back(t_.ids[*b]);
    std::ranges::sort(pocket.corners);
    pocket.spheres = pocket.corners.size();
    pocket.tetrahedra = parts.tetrahedra, pocket.sinks = parts.sinks.size();
    pocket.poked_faces = parts.poked_faces;
    pocket.depth_center = pocket.clear_place = unscaled(center_of(parts.deepest));
    pocket.depth_alpha = unscaled(parts.depth_alpha, 2);
    return pocket;
  }

  // The orthogonal centre, scaled.
  Vec3d center_of(std::uint32_t c) const {
    const auto& v = t_.cells[c];
    return ball(v[0]).center + orthogonal_center({ball(v[0]), ball(v[1]), ball(v[2]), ball(v[3])});
  }

  // `pockets` stand in the order of parts_.
  void add_clearances(std::vector<Pocket>& pockets) const {
    std::vector<ClearPlace> places(pockets.size());
    for_each_block(pockets.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
      advance(options_.monitor, 0);
      places[i] = clear_place(i);
    });
    const auto widths = escape_clearances(t_, places, options_.monitor);
    for (std::size_t i = 0; i < pockets.size(); ++i) {
      pockets[i].clear_place = unscaled(places[i].place);
      pockets[i].clearance = unscaled(places[i].clearance, 1);
      if (widths[i]) pockets[i].bottleneck_clearance = unscaled(*widths[i], 1);
    }
  }

  // The highest summit of the clearance that is in the pocket. A way up that leaves it stays at the
  // sink.
  ClearPlace clear_place(std::size_t pocket) const {
    std::optional<ClearPlace> best;
    for (const std::uint32_t c : parts_[pocket].sinks) {
      const Vec3d sink = center_of(c);
      ClearPlace found{sink, clearance_at(t_.balls, sink)};
      const auto summit = climb_clearance(t_.balls, sink);
      if (summit && flow_.pocket[cell_at(t_, summit->place, c)] == pocket) found = *summit;
      if (!best || found.clearance > best->clearance) best = found;
    }
    return *best;
  }

  std::vector<LiningSphere> lining_of(const PocketParts& parts) const {
    // Cutting leaves areas of some 1e-16 of a sphere to balls without any.
    constexpr double kNoArea = 1e-13;
    std::vector<LiningSphere> lining;
    for (const auto& [b, sum] : parts.ball_area) {
      if (sum.value() > kNoArea) lining.push_back({t_.ids[b], unscaled(sum.value(), 2)});
    }
    std::ranges::sort(lining, {}, &LiningSphere::id);
    return lining;
  }

  // Joins faces that share an edge outside the complex.
  std::vector<Mouth> mouths_of(const std::vector<MouthFace>& faces) const {
    DisjointSets sets(faces.size());
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> face_at;  // by its balls
    for (std::uint32_t i = 0; i < faces.size(); ++i) {
      const auto v = vertices_of(faces[i]);
      for (std::size_t m = 0; m < 3; ++m) {
        const auto edge = std::minmax({v[m], v[(m + 1) % 3]});
        const auto [at, is_new] = face_at.try_emplace(edge, i);
        if (!is_new && dual_edge(complex_, edge.first, edge.second) == kNoIndex)
          sets.join(at->second, i);
      }
    }
    std::map<std::uint32_t, std::vector<MouthFace>> joined;
    for (std::uint32_t i = 0; i < faces.size(); ++i) joined[sets.find(i)].push_back(faces[i]);
    std::vector<Mouth> mouths;
    for (const auto& [root, members] : joined) mouths.push_back(mouth_of(members));
    std::ranges::stable_sort(mouths, std::greater<>(), &Mouth::area);
    return mouths;
  }

  std::array<std::uint32_t, 3> vertices_of(const MouthFace& face) const {
    const auto& f = kFacetVertices[face.slot];
    const auto& v = t_.cells[face.cell];
    return {v[f[0]], v[f[1]], v[f[2]]};
  }

  Mouth mouth_of(const std::vector<MouthFace>& faces) const {
    WideSum area, rim, area_sum, rim_sum;
    double weight = 0;
    Vec3d center{};
    std::vector<std::array<SphereId, 3>> triangles;
    for (const MouthFace& face : faces) {
      area.add(face.area), rim.add(face.rim);
      area_sum.add(face.area_sum), rim_sum.add(face.rim_sum);
      const auto v = vertices_of(face);
      const Vec3d a = ball(v[0]).center, b = ball(v[1]).center, c = ball(v[2]).center;
      const double triangle = norm(cross(b - a, c - a));
      center = center + triangle / 3 * (a + b + c);
      weight += triangle;
      // From inside the cell they are counter-clockwise.
      if (options_.measures == PocketMeasures::exact)
        triangles.push_back({t_.ids[v[0]], t_.ids[v[2]], t_.ids[v[1]]});
    }
    return {.area = unscaled(area.value(), 2),
            .rim = unscaled(rim.value(), 1),
            .area_sum = unscaled(area_sum.value(), 2),
            .rim_sum = unscaled(rim_sum.value(), 1),
            .center = unscaled(1 / weight * center),
            .faces = faces.size(),
            .triangles = std::move(triangles)};
  }

  // Pockets of one volume stand by the places of their sinks, which do not depend on ids.
  static void sort(std::vector<Pocket>& pockets) {
    std::ranges::sort(pockets, [](const Pocket& a, const Pocket& b) {
      const auto key = [](const Pocket& p) {
        return std::array{-p.volume, p.depth_center.x, p.depth_center.y, p.depth_center.z};
      };
      return key(a) < key(b);
    });
  }

  const PowerTriangulation& t_;
  const DualComplex& complex_;
  const PocketFlow& flow_;
  const PocketOptions& options_;
  BallNeighbors neighbors_;
  std::vector<PocketParts> parts_;
};

void check_finite(const std::vector<Pocket>& pockets) {
  for (const Pocket& p : pockets) {
    double sum = p.volume + p.area + p.volume_sum + p.area_sum + p.depth_alpha + p.bottleneck_alpha;
    for (const Mouth& m : p.mouths) sum += m.area + m.rim + m.area_sum + m.rim_sum;
    if (!std::isfinite(sum)) {
      throw InvalidInput(
          "the sizes of the spheres or the distances of their centres differ by too many powers of "
          "ten: figures of pockets are not finite in double precision");
    }
  }
}

}  // namespace

std::string_view kind_name(PocketKind kind) {
  if (kind == PocketKind::enclosed) return "void";
  return kind == PocketKind::pocket ? "pocket" : "channel";
}

std::optional<double> probe_margin(const Pocket& pocket) {
  if (!pocket.clearance) return std::nullopt;
  const double way = std::abs(pocket.bottleneck_clearance.value_or(*pocket.clearance));
  return std::min(way, std::abs(*pocket.clearance));
}

PocketTable pockets(const SphereSet& spheres, const PocketOptions& options) {
  const PowerTriangulation t =
      triangulate(spheres, options.monitor, std::nullopt, options.memory_limit);
  const DualComplex k = dual_complex(t, options.monitor);
  const PocketFlow flow = pocket_flow(t, k, options.monitor);
  PocketTable table{PocketMeasurer(t, k, flow, options).run(), flow.empty_cells, flow.face_ties,
                    flow.cell_ties};
  check_finite(table.pockets);
  return table;
}

}  // namespace vdwmesh
