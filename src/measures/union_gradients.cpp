// union_gradients(): sums over the faces that a ball shares with its neighbours. The formulas are
// those of arcs/face_rates.hpp.
#include "measures/union_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/workspace.hpp"
#include "measures/arcs/arcs.hpp"
#include "measures/arcs/ball_gradient.hpp"
#include "measures/complex_faces.hpp"
#include "measures/measures.hpp"
#include "measures/total_measures.hpp"
#include "spheres/kept_cell_lists.hpp"

namespace vdwmesh {
namespace {

double weight(std::span<const double> weights, SphereId id) {
  return weights.empty() ? 1 : weights[id];
}

// The derivatives of a ball's measures by a neighbour.
BallGradient by_other(const Sphere& ball, const SharedFace& f) {
  const double inverse = f.plane.inverse_distance, r = ball.radius;
  return {(inverse * r * f.angle * f.plane.other_height) * f.axis - (inverse * r) * f.arc,
          -inverse * r * f.angle * f.other_radius,
          (inverse * f.area * f.plane.other_height) * f.axis - inverse * f.moment,
          -inverse * f.area * f.other_radius};
}

// The derivatives of a ball's measures by its own radius.
BallGradient by_itself(const Sphere& ball, double area, std::span<const SharedFace> faces) {
  BallGradient own{};
  const double r = ball.radius;
  own.area_radius = 2 * (area / r);
  own.volume_radius = area;
  for (const SharedFace& f : faces) {
    own.area_radius += f.angle * (r * r * f.plane.inverse_distance - f.plane.height);
    own.volume_radius += f.area * r * f.plane.inverse_distance;
  }
  return own;
}

using JacobianRow = std::vector<std::pair<SphereId, BallGradient>>;

JacobianRow jacobian_row(SphereId id, const Sphere& ball, double area,
                         std::span<const SharedFace> faces) {
  BallGradient own = by_itself(ball, area, faces);
  JacobianRow row;
  row.reserve(faces.size() + 1);
  for (const SharedFace& f : faces) {
    row.emplace_back(f.other, by_other(ball, f));
    const BallGradient& g = row.back().second;
    own.area_center = own.area_center - g.area_center;
    own.volume_center = own.volume_center - g.volume_center;
  }
  row.emplace_back(id, own);
  std::ranges::sort(row, {}, &JacobianRow::value_type::first);
  return row;
}

// Throws InvalidInput unless there are no numbers or a finite one for each sphere. `what` they are,
// in the plural.
void check_numbers(std::span<const double> numbers, std::size_t spheres, const std::string& what) {
  if (numbers.empty()) return;
  if (numbers.size() != spheres) {
    throw InvalidInput(what + ": there are " + std::to_string(numbers.size()) + " for " +
                       std::to_string(spheres) + " spheres");
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (std::isfinite(numbers[i])) continue;
    throw InvalidInput(what + ": number " + std::to_string(i) + " is not finite");
  }
}

// Shows all balls to the visitor: those that the arcs can measure, then the others. Fills `arcs`
// with their measures.
void visit_faces(ArcMeasures& arcs, const SphereSet& spheres, FaceVisitor& visitor,
                 Monitor* monitor, Workspace& workspace) {
  const MeasuredSpheres all(spheres.size(), std::nullopt);
  arc_measures(arcs, spheres, {.measured = all, .monitor = monitor, .faces = &visitor}, workspace);
  if (arcs.suspect.empty()) return;
  visit_by_triangulation(arcs.suspect,
                         balls_near(ball_list(spheres, workspace), spheres, arcs.suspect),
                         arcs.per_sphere, visitor);
}

void visit_all(const SphereSet& spheres, FaceVisitor& visitor, Monitor* monitor) {
  ArcMeasures arcs;
  Workspace workspace;
  visit_faces(arcs, spheres, visitor, monitor, workspace);
}

UnionJacobian joined_rows(const std::vector<JacobianRow>& rows) {
  UnionJacobian out;
  out.first.reserve(rows.size() + 1);
  out.first.push_back(0);
  for (const JacobianRow& row : rows) out.first.push_back(out.first.back() + row.size());
  out.columns.resize(out.first.back());
  out.blocks.resize(out.first.back());
  for_each_index(rows.size(), [&](std::size_t i) {
    for (std::size_t k = 0; k < rows[i].size(); ++k) {
      std::tie(out.columns[out.first[i] + k], out.blocks[out.first[i] + k]) = rows[i][k];
    }
  });
  return out;
}

}  // namespace

void require_finite_derivatives(bool finite) {
  if (finite) return;
  throw InvalidInput(
      "the sizes of the spheres or the distances of their centres differ by too many powers of "
      "ten: derivatives of area and volume are not finite in double precision");
}

void check_weights(std::span<const double> areas, std::span<const double> volumes,
                   std::size_t spheres) {
  check_numbers(areas, spheres, "weights of areas");
  check_numbers(volumes, spheres, "weights of volumes");
}

void union_gradients_into(UnionGradients& result, const SphereSet& spheres,
                          const GradientOptions& options) {
  check_weights(options.area_weights, options.volume_weights, spheres.size());
  WorkspaceOfCall workspace(options.workspace);
  auto& arcs = workspace.get<ArcMeasures>();
  std::swap(arcs.per_sphere, result.per_sphere);
  result.gradients.assign(spheres.size(), {});
  const auto weights_of = [areas = options.area_weights,
                           volumes = options.volume_weights](SphereId id) -> arcs::BallWeights {
    return {weight(areas, id), weight(volumes, id)};
  };
  FaceVisitor visitor;
  visitor.visit = [&](SphereId id, const Sphere& ball, double area, auto faces) {
    result.gradients[id] = ball_gradient(ball, area, faces, weights_of(id), weights_of);
  };
  visit_faces(arcs, spheres, visitor, options.monitor, workspace);
  std::swap(arcs.per_sphere, result.per_sphere);
  const SphereMeasures total = total_measures(result.per_sphere);
  result.area = total.area;
  result.volume = total.volume;
  result.fallback_spheres = arcs.suspect.size();
  result.kink_spheres = visitor.kinks;
  require_finite({total});
  require_finite_derivatives(std::ranges::all_of(result.gradients, is_finite));
}

UnionGradients union_gradients(const SphereSet& spheres, const GradientOptions& options) {
  UnionGradients result{};
  union_gradients_into(result, spheres, options);
  return result;
}

std::vector<SphereMeasures> measure_rates(const SphereSet& spheres, std::span<const Vec3d> centers,
                                          std::span<const double> radii, Monitor* monitor) {
  if (!centers.empty() && centers.size() != spheres.size()) {
    throw InvalidInput("moves of centres: there are " + std::to_string(centers.size()) + " for " +
                       std::to_string(spheres.size()) + " spheres");
  }
  check_numbers(radii, spheres.size(), "growths of radii");
  const auto move = [&](SphereId id) { return centers.empty() ? Vec3d{} : centers[id]; };
  const auto growth = [&](SphereId id) { return radii.empty() ? 0 : radii[id]; };
  std::vector<SphereMeasures> rates(spheres.size());
  FaceVisitor visitor;
  visitor.visit = [&](SphereId id, const Sphere& ball, double area, auto faces) {
    const BallGradient own = by_itself(ball, area, faces);
    SphereMeasures rate{own.area_radius * growth(id), own.volume_radius * growth(id)};
    for (const SharedFace& f : faces) {
      const BallGradient g = by_other(ball, f);
      const Vec3d apart = move(f.other) - move(id);
      rate.area += dot(g.area_center, apart) + g.area_radius * growth(f.other);
      rate.volume += dot(g.volume_center, apart) + g.volume_radius * growth(f.other);
    }
    rates[id] = rate;
  };
  visit_all(spheres, visitor, monitor);
  require_finite_derivatives(std::ranges::all_of(rates, [](const SphereMeasures& m) {
    return std::isfinite(m.area) && std::isfinite(m.volume);
  }));
  return rates;
}

UnionJacobian union_jacobian(const SphereSet& spheres, Monitor* monitor) {
  std::vector<JacobianRow> rows(spheres.size());
  FaceVisitor visitor;
  visitor.visit = [&](SphereId id, const Sphere& ball, double area, auto faces) {
    rows[id] = jacobian_row(id, ball, area, faces);
  };
  visit_all(spheres, visitor, monitor);
  UnionJacobian result = joined_rows(rows);
  require_finite_derivatives(std::ranges::all_of(result.blocks, is_finite));
  return result;
}

}  // namespace vdwmesh
