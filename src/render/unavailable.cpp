// Stands in for the renderer in a build without the libraries that it needs: every call throws
// BackendUnavailable with the reason.
#include "core/errors.hpp"
#include "render/picture.hpp"
#include "render/renderer.hpp"

namespace vdwmesh {
namespace {

constexpr const char* kReason =
    "no pictures: this build was made without them (VDWMESH_RENDER=OFF, or libepoxy, libpng, "
    "FreeType or DejaVu Sans were not found)";

}  // namespace

Renderer::Renderer() { throw BackendUnavailable(kReason); }
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
const std::string& Renderer::device() const { throw BackendUnavailable(kReason); }
Picture Renderer::draw(const MeshSource&, const RenderOptions&) const {
  throw BackendUnavailable(kReason);
}
std::string encode_png(const Picture&) { throw BackendUnavailable(kReason); }

}  // namespace vdwmesh
