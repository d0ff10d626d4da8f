// Curvatures by vertex of meshes that follow the curves between patches.
//
// Vertices of one patch take its curvature in the loop over the triangles. The others are few; they
// are listed with their patches, and take the mean.
#include "surface/surface_patch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint32_t kNoPatch = 0xffffffffu;

// The mean of the finite ones among some values.
class FiniteMean {
 public:
  void add(double value) {
    if (!std::isfinite(value)) return;
    sum_ += value;
    ++count_;
  }
  float value() const {
    return count_ > 0 ? static_cast<float>(sum_ / count_) : std::numeric_limits<float>::quiet_NaN();
  }

 private:
  double sum_ = 0;
  int count_ = 0;
};

}  // namespace

void check_patches(const PatchedMesh& mesh) {
  if (mesh.triangle_patch.size() != mesh.mesh.triangle_count()) {
    throw InvalidInput(fmt::format("the mesh has {} patches of triangles, {} are needed",
                                   mesh.triangle_patch.size(), mesh.mesh.triangle_count()));
  }
  const auto is_beyond = [&](std::uint32_t patch) { return patch >= mesh.patches.size(); };
  if ((!mesh.vertex_patch.empty() && mesh.vertex_patch.size() != mesh.mesh.vertex_count()) ||
      std::ranges::any_of(mesh.vertex_patch, is_beyond)) {
    throw InvalidInput("the patches of vertices do not fit the mesh");
  }
  const auto beyond = std::ranges::find_if(mesh.triangle_patch, is_beyond);
  if (beyond == mesh.triangle_patch.end()) return;
  throw InvalidInput(fmt::format("triangle {} lies on patch {}, beyond the mesh's {}",
                                 beyond - mesh.triangle_patch.begin(), *beyond,
                                 mesh.patches.size()));
}

std::vector<VertexPatch> patches_of_shared_vertices(const PatchedMesh& mesh) {
  std::vector<std::uint32_t> first(mesh.mesh.vertex_count(), kNoPatch);
  std::vector<VertexPatch> pairs;
  for (std::size_t t = 0; t < mesh.mesh.triangle_count(); ++t) {
    const std::uint32_t patch = mesh.triangle_patch[t];
    for (const std::uint32_t v : mesh.mesh.triangles[t]) {
      if (first[v] == kNoPatch) first[v] = patch;
      if (first[v] == patch) continue;
      pairs.push_back({v, first[v]});
      pairs.push_back({v, patch});
    }
  }
  const auto key = [](const VertexPatch& p) { return std::tuple(p.vertex, p.patch); };
  std::ranges::sort(pairs, {}, key);
  const auto repeated = std::ranges::unique(pairs, {}, key);
  pairs.erase(repeated.begin(), repeated.end());
  return pairs;
}

VertexCurvatures vertex_curvatures(const PatchedMesh& mesh) {
  check_patches(mesh);
  const auto curvatures = [&](std::uint32_t v, std::uint32_t patch) {
    return patch_curvatures(mesh.patches[patch], mesh.mesh.positions[v]);
  };
  VertexCurvatures out;
  out.mean.resize(mesh.mesh.vertex_count());
  out.gaussian.resize(mesh.mesh.vertex_count());
  const auto set = [&](std::uint32_t v, std::uint32_t patch) {
    const PrincipalCurvatures c = curvatures(v, patch);
    FiniteMean mean, gaussian;
    mean.add(c.mean()), gaussian.add(c.gaussian());
    out.mean[v] = mean.value(), out.gaussian[v] = gaussian.value();
  };
  if (!mesh.vertex_patch.empty()) {
    for (std::uint32_t v = 0; v < mesh.vertex_patch.size(); ++v) set(v, mesh.vertex_patch[v]);
    return out;
  }
  for (std::size_t t = 0; t < mesh.mesh.triangle_count(); ++t) {
    for (const std::uint32_t v : mesh.mesh.triangles[t]) set(v, mesh.triangle_patch[t]);
  }
  const std::vector<VertexPatch> shared = patches_of_shared_vertices(mesh);
  for (std::size_t i = 0; i < shared.size();) {
    const std::uint32_t v = shared[i].vertex;
    FiniteMean mean, gaussian;
    for (; i < shared.size() && shared[i].vertex == v; ++i) {
      const PrincipalCurvatures c = curvatures(v, shared[i].patch);
      mean.add(c.mean()), gaussian.add(c.gaussian());
    }
    out.mean[v] = mean.value(), out.gaussian[v] = gaussian.value();
  }
  return out;
}

}  // namespace vdwmesh
