// Names and colours of the parts of pockets' meshes.
#include "report/pockets/pocket_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "report/sphere_file.hpp"

namespace vdwmesh::apps {

std::vector<NamedMesh> named_meshes(std::vector<PocketMesh> meshes) {
  constexpr std::uint8_t kWall = 160, kMouth = 70;  // how opaque, of 255
  std::vector<NamedMesh> out;
  for (std::size_t p = 0; p < meshes.size(); ++p) {
    if (meshes[p].mesh.triangles.empty()) continue;
    NamedMesh& named = out.emplace_back();
    named.name = fmt::format("pocket {}", p + 1);
    named.mesh = std::move(meshes[p].mesh);
    named.parts = std::move(meshes[p].parts);
    const std::uint32_t mouths = std::ranges::max(named.parts);
    const auto [red, green, blue] = group_color(p + 1);
    for (std::uint32_t part = 0; part <= mouths; ++part) {
      named.part_names.push_back(part == 0 ? named.name + " wall"
                                           : fmt::format("{} mouth {}", named.name, part));
      named.part_colors.push_back({red, green, blue, part == 0 ? kWall : kMouth});
    }
  }
  return out;
}

}  // namespace vdwmesh::apps
