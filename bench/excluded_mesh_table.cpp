// The table of meshes in docs/excluded_surface.md: meshes of the excluded surface, checked.
//
//   excluded_mesh_table [--search N] [--probes P,...] [--edge-lengths H,...] FILE...
//
// CSV on standard output, a row for each mesh. Differences are from excluded_measures().
// --search: self-intersections of meshes up to N triangles.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "core/errors.hpp"
#include "excluded/excluded_mesher.hpp"
#include "structure/reader.hpp"
#include "support/excluded_survey.hpp"

namespace vdwmesh {
namespace {

struct TableOptions {
  std::uint64_t search = 2'000'000;
  std::vector<double> probes{0.7, 1.4, 3}, edge_lengths{0.7, 0.5, 0.35};
};

std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> out;
  std::stringstream in(text);
  for (std::string cell; std::getline(in, cell, ',');) out.push_back(std::stod(cell));
  return out;
}

SphereSet read_atoms(const std::string& file) {
  std::vector<Sphere> balls;
  for (const Atom& atom : read_structure(file).atoms) balls.push_back({atom.position, atom.radius});
  return SphereSet(std::move(balls));
}

void print_row(const std::string& set, const SphereSet& atoms, const ExcludedMeasures& exact,
               double h, const TableOptions& options) {
  ExcludedMeshOptions wanted;
  wanted.probe = exact.probe;
  wanted.edge_length = h;
  const ExcludedMesh mesh = mesh_excluded(atoms, wanted);
  const testing::ExcludedSurvey s = testing::survey_excluded(atoms, exact.probe, mesh);
  const reference::MeshFacts& f = s.facts;
  const ExcludedSurface& surface = exact.complete;
  const Distribution angles = quality(mesh.mesh).min_angle_deg;
  const std::string crossings =
      f.triangles <= options.search ? std::to_string(self_intersections(mesh.mesh)) : "";
  std::printf("%s,%g,%g,%zu,%d,%ld,%ld,%s,%zu,%llu,%llu,%.1e,%.2f,%.2f,%.4f,%.4f,%llu,%.2f\n",
              set.c_str(), exact.probe, h, f.triangles, s.sound() ? 1 : 0,
              static_cast<long>(f.euler_characteristic() - surface.topology->euler_characteristic),
              static_cast<long>(f.positive_shells + f.negative_shells) -
                  static_cast<long>(surface.topology->shells.size()),
              crossings.c_str(), f.degenerate_triangles, static_cast<unsigned long long>(s.inward),
              static_cast<unsigned long long>(s.bad_normals + s.bad_labels), s.off_patch,
              angles.p01, angles.min, 100 * (f.area / surface.area - 1),
              100 * (f.volume / surface.volume - 1),
              static_cast<unsigned long long>(mesh.stats.split), mesh.stats.seconds);
}

void print_rows(const std::string& file, const TableOptions& options) {
  const std::string set = std::filesystem::path(file).stem().string();
  const SphereSet atoms = read_atoms(file);
  for (const double probe : options.probes) {
    const ExcludedMeasures exact = excluded_measures(atoms, {.probe = probe});
    for (const double h : options.edge_lengths) {
      try {
        print_row(set, atoms, exact, h, options);
      } catch (const Error& error) {
        std::printf("%s,%g,%g,,,,,,,,,,,,,,,%s\n", set.c_str(), probe, h, error.what());
      }
      std::fflush(stdout);
    }
  }
}

int run(int argc, char** argv) {
  TableOptions options;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string_view arg = argv[i];
    if (arg == "--search" && i + 1 < argc) {
      options.search = std::strtoull(argv[++i], nullptr, 10);
    } else if (arg == "--probes" && i + 1 < argc) {
      options.probes = numbers_in(argv[++i]);
    } else if (arg == "--edge-lengths" && i + 1 < argc) {
      options.edge_lengths = numbers_in(argv[++i]);
    } else {
      files.emplace_back(arg);
    }
  }
  if (files.empty()) {
    std::fprintf(stderr, "usage: excluded_mesh_table [OPTIONS] FILE...\n");
    return 2;
  }
  std::printf(
      "set,probe,edge_length,triangles,sound,chi,shells,self_intersections,degenerate,inward,"
      "bad_labels,off_patch,p01_angle,least_angle,area_percent,volume_percent,split,seconds\n");
  for (const std::string& file : files) print_rows(file, options);
  return 0;
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) { return vdwmesh::run(argc, argv); }
