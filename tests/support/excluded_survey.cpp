#include "support/excluded_survey.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "support/reference_mesh.hpp"
#include "support/worst.hpp"

namespace vdwmesh::testing {
namespace {

Vec3d scaled_to_unit(const Vec3d& v) { return (1 / norm(v)) * v; }

// Where a point is with respect to a patch: its distance from the sphere or torus, and the outward
// normal there; no normal (0) on the axis of a torus.
struct Footing {
  double distance;
  Vec3d normal;
};

// A ball that the atoms i and j grown by the probe meet in: the circle of the probe's centres.
struct RollingCircle {
  Vec3d center, axis;
  double radius;

  RollingCircle(const Sphere& i, const Sphere& j, double probe) {
    const Vec3d apart = j.center - i.center;
    const double d = norm(apart), a = i.radius + probe, b = j.radius + probe;
    const double t = (d * d + (a - b) * (a + b)) / (2 * d);
    axis = (1 / d) * apart;
    center = i.center + t * axis;
    radius = std::sqrt((a - t) * (a + t));
  }
};

Footing on_ball(const Vec3d& q, const Sphere& s) {
  return {norm(q - s.center) - s.radius, scaled_to_unit(q - s.center)};
}

Footing on_torus(const Vec3d& q, const RollingCircle& circle, double probe) {
  const Vec3d arm = q - circle.center;
  const double height = dot(arm, circle.axis);
  const Vec3d flat = arm - height * circle.axis;
  const double distance = std::hypot(circle.radius - norm(flat), height) - probe;
  if (norm(flat) < 1e-9) return {distance, {0, 0, 0}};
  const Vec3d center = circle.center + (circle.radius / norm(flat)) * flat;
  return {distance, scaled_to_unit(center - q)};
}

// The probe that touches three atoms on one side of their plane, +1 or -1.
Vec3d probe_at(const std::array<Sphere, 3>& s, double probe, double side) {
  const RollingCircle circle(s[0], s[1], probe);
  const Vec3d to_third = s[2].center - circle.center;
  const double along = dot(to_third, circle.axis);
  const Vec3d flat = to_third - along * circle.axis;
  const double w = norm(flat), r = s[2].radius + probe;
  // On the circle at (x, y) in the directions of `flat` and across: x² + y² = ρ² and (x - w)² + y²
  // + along² = r².
  const double x = (w * w + along * along + circle.radius * circle.radius - r * r) / (2 * w);
  const double y = std::sqrt(std::max(0.0, (circle.radius - x) * (circle.radius + x)));
  const Vec3d e = (1 / w) * flat;
  return circle.center + x * e + (side * y) * cross(circle.axis, e);
}

Footing on_probe(const Vec3d& q, const Vec3d& center, double probe) {
  return {norm(q - center) - probe, scaled_to_unit(center - q)};
}

class Surveyor {
 public:
  Surveyor(const SphereSet& atoms, double probe, const PatchedMesh& mesh)
      : atoms_(atoms), probe_(probe), mesh_(mesh) {}

  ExcludedSurvey run() && {
    out_.facts = reference::inspect(to_reference(mesh_.mesh));
    corners_.resize(mesh_.mesh.vertex_count());
    find_sides();
    for (std::size_t t = 0; t < mesh_.mesh.triangle_count(); ++t) look_at(t);
    check_normals();
    return std::move(out_);
  }

 private:
  void look_at(std::size_t t) {
    const std::uint32_t index = mesh_.triangle_patch[t];
    if (index >= mesh_.patches.size() || !has_atoms(mesh_.patches[index])) {
      ++out_.bad_labels;
      return;
    }
    const SurfacePatch& patch = mesh_.patches[index];
    const Triangle& v = mesh_.mesh.triangles[t];
    std::array<Vec3d, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh_.mesh.positions[v[k]];
    const Vec3d normal = cross(p[1] - p[0], p[2] - p[0]);
    out_.area_by_kind[static_cast<std::size_t>(patch.kind)] += norm(normal) / 2;
    const double side = sides_[index];
    bool inward = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Footing f = footing(patch, p[k], side);
      out_.off_patch = worst(out_.off_patch, std::abs(f.distance));
      if (norm(f.normal) > 0) inward = inward || !(dot(f.normal, normal) > 0);
      if (norm(f.normal) > 0) compare_normal(v[k], f.normal);
    }
    out_.inward += inward;
  }

  // Patches meet smoothly in a vertex if they have the same normal there. Then the vertex has it.
  void compare_normal(std::uint32_t vertex, const Vec3d& normal) {
    Corner& c = corners_[vertex];
    if (norm(c.normal) > 0 && norm(normal - c.normal) > 1e-6) c.sharp = true;
    c.normal = normal;
  }

  void check_normals() {
    for (std::size_t v = 0; v < corners_.size(); ++v) {
      const Vec3d n = cast<double>(mesh_.mesh.normals[v]);
      const bool same = norm(n - corners_[v].normal) < 1e-5 || norm(corners_[v].normal) == 0;
      out_.bad_normals += !(std::abs(norm(n) - 1) < 1e-5 && (corners_[v].sharp || same));
    }
  }

  bool has_atoms(const SurfacePatch& patch) const {
    const std::size_t wanted = static_cast<std::size_t>(patch.kind) + 1;
    for (std::size_t k = 0; k < 3; ++k) {
      if ((patch.atoms[k] < atoms_.size()) != (k < wanted)) return false;
      if (k > 0 && k < wanted && patch.atoms[k] <= patch.atoms[k - 1]) return false;
    }
    return true;
  }

  std::array<Sphere, 3> spheres_of(const SurfacePatch& patch) const {
    return {atoms_[patch.atoms[0]], atoms_[patch.atoms[1]], atoms_[patch.atoms[2]]};
  }

  // Of the two probes at three atoms the one whose sphere the patch is nearer to. Of a single
  // triangle the vertices may lie on both.
  void find_sides() {
    sides_.assign(mesh_.patches.size(), 0);
    for (std::size_t t = 0; t < mesh_.mesh.triangle_count(); ++t) {
      const std::uint32_t index = mesh_.triangle_patch[t];
      if (index >= mesh_.patches.size() || !has_atoms(mesh_.patches[index])) continue;
      const SurfacePatch& patch = mesh_.patches[index];
      if (patch.kind != PatchKind::concave) continue;
      for (const std::uint32_t v : mesh_.mesh.triangles[t]) {
        const Vec3d& q = mesh_.mesh.positions[v];
        const auto off = [&](double side) {
          return std::abs(norm(q - probe_at(spheres_of(patch), probe_, side)) - probe_);
        };
        sides_[index] += off(-1) - off(1);
      }
    }
    for (double& side : sides_) side = side >= 0 ? 1 : -1;
  }

  Footing footing(const SurfacePatch& patch, const Vec3d& q, double side) const {
    if (patch.kind == PatchKind::contact) return on_ball(q, atoms_[patch.atoms[0]]);
    if (patch.kind == PatchKind::concave) {
      return on_probe(q, probe_at(spheres_of(patch), probe_, side), probe_);
    }
    return on_torus(q, {atoms_[patch.atoms[0]], atoms_[patch.atoms[1]], probe_}, probe_);
  }

  struct Corner {
    Vec3d normal{0, 0, 0};  // of one of the patches there
    bool sharp = false;
  };

  const SphereSet& atoms_;
  const double probe_;
  const PatchedMesh& mesh_;
  std::vector<Corner> corners_;  // by vertex
  std::vector<double> sides_;    // by patch, +1 or -1: which of the two probes at three atoms
  ExcludedSurvey out_;
};

}  // namespace

bool ExcludedSurvey::sound() const {
  return facts.closed_oriented_manifold() && facts.degenerate_triangles == 0 && inward == 0 &&
         bad_labels == 0 && bad_normals == 0;
}

std::string ExcludedSurvey::text() const {
  std::ostringstream out;
  out << facts.summary() << "; off patch " << off_patch << " Å; inward " << inward
      << ", bad labels " << bad_labels << ", bad normals " << bad_normals;
  return out.str();
}

ExcludedSurvey survey_excluded(const SphereSet& atoms, double probe, const PatchedMesh& mesh) {
  return Surveyor(atoms, probe, mesh).run();
}

}  // namespace vdwmesh::testing
