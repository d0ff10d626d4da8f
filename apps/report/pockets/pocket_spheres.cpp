// Writes spheres of pockets as PDB records, a script of PyMOL, and BILD.
#include "report/pockets/pocket_spheres.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "report/atom_file.hpp"
#include "request/refuse.hpp"

namespace vdwmesh::apps {
namespace {

// Colours that pockets take in turn (Okabe and Ito's, told apart by most eyes).
constexpr std::array<std::array<double, 3>, 7> kColors{{{0.90, 0.62, 0},
                                                        {0.34, 0.71, 0.91},
                                                        {0, 0.62, 0.45},
                                                        {0.94, 0.89, 0.26},
                                                        {0, 0.45, 0.70},
                                                        {0.84, 0.37, 0},
                                                        {0.80, 0.47, 0.65}}};

const std::array<double, 3>& color_of(const PocketRow& pocket) {
  return kColors[(pocket.rank - 1) % kColors.size()];
}

std::string pdb_text(const PocketReport& report) {
  constexpr std::uint64_t kSerials = 100'000, kResidues = 10'000;  // five columns, and four
  refuse_if(report.pockets.size() >= kResidues,
            "a PDB file numbers up to 9,999 pockets, and there are {}; write .bild",
            report.pockets.size());
  std::string text;
  std::uint64_t serial = 0;
  for (const PocketRow& p : report.pockets) {
    for (const Sphere& s : p.alpha_spheres) {
      const Vec3d& c = s.center;
      refuse_if(!fits_in_pdb(c),
                "a PDB file has no room for the coordinates {}, {}, {}; write .bild", c.x, c.y,
                c.z);
      serial = (serial + 1) % kSerials;  // viewers take numbers that come again
      fmt::format_to(
          std::back_inserter(text),
          "HETATM{:5} APOL STP C{:4}    {:8.3f}{:8.3f}{:8.3f}  1.00{:6.2f}          VE\n", serial,
          p.rank, c.x, c.y, c.z, std::min(s.radius + p.probe, 999.99));
    }
  }
  return text + "END\n";
}

std::string pymol_text(const PocketReport& report) {
  std::string text = "python\nfrom pymol import cmd\ncmd.read_pdbstr('''\\\n" + pdb_text(report) +
                     "''', 'pockets')\npython end\nalter pockets, vdw=b\nrebuild pockets\n"
                     "hide everything, pockets\nshow spheres, pockets\n"
                     "set sphere_transparency, 0.4, pockets\n";
  for (const PocketRow& p : report.pockets) {
    const auto& [red, green, blue] = color_of(p);
    fmt::format_to(std::back_inserter(text),
                   "select {0}_{1}, pockets and resi {1}\nset_color {0}_{1}, [{2}, {3}, {4}]\n"
                   "color {0}_{1}, {0}_{1}\n",
                   kind_name(p.kind), p.rank, red, green, blue);
  }
  return text + "deselect\n";
}

std::string bild_text(const PocketReport& report) {
  std::string text = ".transparency 0.4\n";
  const auto out = std::back_inserter(text);
  for (const PocketRow& p : report.pockets) {
    const auto& [red, green, blue] = color_of(p);
    fmt::format_to(out, ".comment {} {}, {} Å³\n.color {} {} {}\n", kind_name(p.kind), p.rank,
                   p.volume, red, green, blue);
    for (const Sphere& s : p.alpha_spheres) {
      const Vec3d& c = s.center;
      fmt::format_to(out, ".sphere {} {} {} {}\n", c.x, c.y, c.z, s.radius + p.probe);
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

std::string pocket_spheres(const PocketReport& report, SphereFormat format) {
  if (format == SphereFormat::pdb) return pdb_text(report);
  return format == SphereFormat::pymol ? pymol_text(report) : bild_text(report);
}

}  // namespace vdwmesh::apps
