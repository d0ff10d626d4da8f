// Writes spheres as PDB records, a script of PyMOL, and BILD.
#include "report/sphere_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "core/letters.hpp"
#include "report/atom_file.hpp"
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

const std::array<double, 3>& color_of(std::size_t group) { return kColors[group % kColors.size()]; }

std::string pdb_text(std::span<const SphereGroup> groups, std::string_view all) {
  constexpr std::uint64_t kSerials = 100'000, kResidues = 10'000;  // five columns, and four
  refuse_if(groups.size() >= kResidues,
            "a PDB file numbers up to 9,999 {}, and there are {}; write .bild", all, groups.size());
  std::string text;
  std::uint64_t serial = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const Sphere& s : groups[g].spheres) {
      const Vec3d& c = s.center;
      refuse_if(!fits_in_pdb(c),
                "a PDB file has no room for the coordinates {}, {}, {}; write .bild", c.x, c.y,
                c.z);
      serial = (serial + 1) % kSerials;  // viewers take numbers that come again
      fmt::format_to(
          std::back_inserter(text),
          "HETATM{:5} APOL STP C{:4}    {:8.3f}{:8.3f}{:8.3f}  1.00{:6.2f}          VE\n", serial,
          g + 1, c.x, c.y, c.z, std::min(s.radius, 999.99));
    }
  }
  return text + "END\n";
}

std::string pymol_text(std::span<const SphereGroup> groups, std::string_view all) {
  std::string text = fmt::format(
      "python\nfrom pymol import cmd\ncmd.read_pdbstr('''\\\n{0}''', '{1}')\n"
      "python end\nalter {1}, vdw=b\nrebuild {1}\nhide everything, {1}\n"
      "show spheres, {1}\nset sphere_transparency, 0.4, {1}\n",
      pdb_text(groups, all), all);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto& [red, green, blue] = color_of(g);
    fmt::format_to(std::back_inserter(text),
                   "select {0}_{1}, {5} and resi {1}\nset_color {0}_{1}, [{2}, {3}, {4}]\n"
                   "color {0}_{1}, {0}_{1}\n",
                   groups[g].kind, g + 1, red, green, blue, all);
  }
  return text + "deselect\n";
}

std::string bild_text(std::span<const SphereGroup> groups) {
  std::string text = ".transparency 0.4\n";
  const auto out = std::back_inserter(text);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto& [red, green, blue] = color_of(g);
    fmt::format_to(out, ".comment {} {}, {} Å³\n.color {} {} {}\n", groups[g].kind, g + 1,
                   groups[g].volume, red, green, blue);
    for (const Sphere& s : groups[g].spheres) {
      const Vec3d& c = s.center;
      fmt::format_to(out, ".sphere {} {} {} {}\n", c.x, c.y, c.z, s.radius);
    }
  }
  return text;
}

}  // namespace

std::optional<SphereFormat> find_sphere_format(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".pdb") return SphereFormat::pdb;
  if (extension == ".pml") return SphereFormat::pymol;
  return extension == ".bild" ? std::optional(SphereFormat::bild) : std::nullopt;
}

std::string spheres_text(std::span<const SphereGroup> groups, std::string_view all,
                         SphereFormat format) {
  if (format == SphereFormat::pdb) return pdb_text(groups, all);
  return format == SphereFormat::pymol ? pymol_text(groups, all) : bild_text(groups);
}

}  // namespace vdwmesh::apps
