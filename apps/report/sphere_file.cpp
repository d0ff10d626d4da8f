// Writes spheres as PDB records, a script of PyMOL, BILD, and MolViewSpec.
#include "report/sphere_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "report/atom_file.hpp"
#include "report/json_text.hpp"
#include "request/refuse.hpp"

namespace vdwmesh::apps {
namespace {

// Colours that groups take in turn (Okabe and Ito's, told apart by most eyes).
constexpr std::array<std::array<double, 3>, 7> kColors{{{0.90, 0.62, 0},
                                                        {0.34, 0.71, 0.91},
                                                        {0, 0.62, 0.45},
                                                        {0.94, 0.89, 0.26},
                                                        {0, 0.45, 0.70},
                                                        {0.84, 0.37, 0},
                                                        {0.80, 0.47, 0.65}}};

using Color = std::array<double, 3>;
const Color& color_of(const SphereGroup& group) {
  return kColors[(group.number - 1) % kColors.size()];
}

std::string pdb_text(const std::vector<SphereGroup>& groups, std::string_view all) {
  constexpr std::uint64_t kSerials = 100'000, kResidues = 10'000;  // five columns, and four
  refuse_if(groups.size() >= kResidues,
            "a PDB file numbers up to 9,999 {}, and there are {}; write .bild", all, groups.size());
  std::string text;
  std::uint64_t serial = 0;
  for (const SphereGroup& group : groups) {
    for (const Sphere& s : group.spheres) {
      const Vec3d& c = s.center;
      refuse_if(!fits_in_pdb(c),
                "a PDB file has no room for the coordinates {}, {}, {}; write .bild", c.x, c.y,
                c.z);
      serial = (serial + 1) % kSerials;  // viewers take numbers that come again
      fmt::format_to(
          std::back_inserter(text),
          "HETATM{:5} APOL STP C{:4}    {:8.3f}{:8.3f}{:8.3f}  1.00{:6.2f}          VE\n", serial,
          group.number, c.x, c.y, c.z, std::min(s.radius, 999.99));
    }
  }
  return text + "END\n";
}

std::string pymol_text(const std::vector<SphereGroup>& groups, std::string_view all) {
  std::string text = fmt::format(
      "python\nfrom pymol import cmd\ncmd.read_pdbstr('''\\\n{0}''', '{1}')\n"
      "python end\nalter {1}, vdw=b\nrebuild {1}\nhide everything, {1}\n"
      "show spheres, {1}\nset sphere_transparency, 0.4, {1}\n",
      pdb_text(groups, all), all);
  for (const SphereGroup& group : groups) {
    const auto& [red, green, blue] = color_of(group);
    fmt::format_to(std::back_inserter(text),
                   "select {0}_{1}, {5} and resi {1}\nset_color {0}_{1}, [{2}, {3}, {4}]\n"
                   "color {0}_{1}, {0}_{1}\n",
                   group.kind, group.number, red, green, blue, all);
  }
  return text + "deselect\n";
}

std::string bild_text(const std::vector<SphereGroup>& groups) {
  std::string text = ".transparency 0.4\n";
  const auto out = std::back_inserter(text);
  for (const SphereGroup& group : groups) {
    const auto& [red, green, blue] = color_of(group);
    fmt::format_to(out, ".comment {} {}, {}\n.color {} {} {}\n", group.kind, group.number,
                   group.figure, red, green, blue);
    for (const Sphere& s : group.spheres) {
      const Vec3d& c = s.center;
      fmt::format_to(out, ".sphere {} {} {} {}\n", c.x, c.y, c.z, s.radius);
    }
  }
  return text;
}

// "#e69f00".
std::string web_color(const Color& color) {
  std::string text = "#";
  for (const double part : color)
    fmt::format_to(std::back_inserter(text), "{:02x}", std::lround(255 * part));
  return text;
}

// The tree of nodes of MolViewSpec 1: a node of primitives for each group, with an ellipsoid of one
// radius for each sphere.
std::string molstar_text(const std::vector<SphereGroup>& groups) {
  JsonText json(JsonText::Layout::compact);
  json.object("metadata", [&] {
    json("version", "1");
    json("timestamp", "1970-01-01T00:00:00Z");  // files of one input are the same
  });
  const auto sphere = [&](const Sphere& s) {
    json("kind", "primitive");
    json.object("params", [&] {
      json("kind", "ellipsoid");
      json("center", std::vector{s.center.x, s.center.y, s.center.z});
      json("radius", s.radius);
    });
  };
  json.object("root", [&] {
    json("kind", "root");
    json.list("children", groups, [&](const SphereGroup& group) {
      json("kind", "primitives");
      json.object("params", [&] {
        json("color", web_color(color_of(group)));
        json("opacity", 0.6);
        json("tooltip", fmt::format("{} {}, {}", group.kind, group.number, group.figure));
      });
      json.list("children", group.spheres, sphere);
    });
  });
  return std::move(json).take();
}

}  // namespace

std::array<std::uint8_t, 3> group_color(std::uint64_t number) {
  const auto& [red, green, blue] = kColors[(number - 1) % kColors.size()];
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::lround(255 * x)); };
  return {byte(red), byte(green), byte(blue)};
}

std::optional<SphereFormat> find_sphere_format(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".pdb") return SphereFormat::pdb;
  if (extension == ".pml") return SphereFormat::pymol;
  if (extension == ".mvsj") return SphereFormat::molstar;
  return extension == ".bild" ? std::optional(SphereFormat::bild) : std::nullopt;
}

std::string sphere_file(const std::vector<SphereGroup>& groups, std::string_view all,
                        SphereFormat format) {
  switch (format) {
    case SphereFormat::pdb:
      return pdb_text(groups, all);
    case SphereFormat::pymol:
      return pymol_text(groups, all);
    case SphereFormat::bild:
      return bild_text(groups);
    case SphereFormat::molstar:
      break;
  }
  return molstar_text(groups);
}

}  // namespace vdwmesh::apps
