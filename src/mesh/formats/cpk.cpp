// Colours a SurfaceMesh by element: a table from element to colour, looked up once per atom, and a
// parallel loop that gives each vertex the colour of its atom. The colours are those of the
// space-filling models of Corey, Pauling and Koltun (CPK).
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <string_view>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/letters.hpp"
#include "mesh/element_color.hpp"
#include "mesh/surface_handles.hpp"
#include "mesh/surface_mesh.hpp"

namespace vdwmesh {
namespace {

using Color = std::array<std::uint8_t, 3>;

// The colours of Corey, Pauling and Koltun's models as Jmol extends them to the elements met in
// structures of macromolecules (jmol.sourceforge.net/jscolors). Elements are in capitals.
const std::pair<std::string_view, Color> kColors[] = {
    {"H", {255, 255, 255}},  {"D", {255, 255, 192}},  {"C", {144, 144, 144}},
    {"N", {48, 80, 248}},    {"O", {255, 13, 13}},    {"F", {144, 224, 80}},
    {"NA", {171, 92, 242}},  {"MG", {138, 255, 0}},   {"SI", {240, 200, 160}},
    {"P", {255, 128, 0}},    {"S", {255, 255, 48}},   {"CL", {31, 240, 31}},
    {"K", {143, 64, 212}},   {"CA", {61, 255, 0}},    {"MN", {156, 122, 199}},
    {"FE", {224, 102, 51}},  {"CO", {240, 144, 160}}, {"NI", {80, 208, 80}},
    {"CU", {200, 128, 51}},  {"ZN", {125, 128, 176}}, {"SE", {255, 161, 0}},
    {"BR", {166, 41, 41}},   {"I", {148, 0, 148}},    {"B", {255, 181, 181}},
    {"LI", {204, 128, 255}}, {"AG", {192, 192, 192}}, {"CD", {255, 217, 143}},
    {"HG", {184, 184, 208}}, {"PT", {208, 208, 224}}, {"AU", {255, 209, 35}},
};
const Color kOther{255, 20, 147};  // all other elements

// Reports the first vertex whose atom is beyond the end of the table of elements.
[[noreturn]] void throw_first_without_element(const SurfaceMesh& mesh,
                                              VertexSpheresProperty spheres, std::size_t elements) {
  const auto has_none = [&](const auto v) {
    const SphereId atom = mesh.property(spheres, v)[0];
    return atom != kNoSphere && atom >= elements;
  };
  const auto all = mesh.vertices();
  const OpenMesh::VertexHandle first = *std::find_if(all.begin(), all.end(), has_none);
  throw InvalidInput(fmt::format("vertex {} lies on sphere {}, but there are {} elements",
                                 first.idx(), mesh.property(spheres, first)[0], elements));
}

}  // namespace

Color element_color(std::string_view element) {
  const std::string upper = upper_case(element);
  for (const auto& [known, color] : kColors)
    if (known == upper) return color;
  return kOther;
}

void color_by_element(SurfaceMesh& mesh, std::span<const std::string> elements) {
  std::vector<SurfaceMesh::Color> colors;  // by sphere
  colors.reserve(elements.size());
  for (const std::string& element : elements) {
    const Color c = element_color(element);
    colors.emplace_back(c[0], c[1], c[2]);
  }
  const VertexSpheresProperty spheres = vertex_spheres(mesh);
  // The parallel loop only notes that some vertex has an atom without an element. The search for
  // the first such vertex is serial, so the error does not depend on the threads.
  std::atomic<bool> all_named = true;
  for_each_index(mesh.n_vertices(), [&](std::size_t v) {
    const SphereId atom = mesh.property(spheres, handles::vertex(v))[0];
    if (atom == kNoSphere) return;
    if (atom < colors.size()) {
      mesh.set_color(handles::vertex(v), colors[atom]);
    } else {
      all_named = false;
    }
  });
  if (!all_named) throw_first_without_element(mesh, spheres, elements.size());
}

}  // namespace vdwmesh
