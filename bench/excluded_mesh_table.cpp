// The tables of meshes in docs/excluded_surface.md: meshes of the excluded surface, checked.
//
//   excluded_mesh_table [--search N] [--levels N] [--probes P,...] [--edge-lengths H,...] FILE...
//
// CSV on standard output, a row for each mesh. Differences are from excluded_measures().
// --search: self-intersections of meshes up to N triangles.
// --levels: subdivisions of each mesh, a row for each level. Then a ratio is the error of the level
// above over that of the level, and left is the relative error of what both tend to.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "core/errors.hpp"
#include "excluded/excluded_mesher.hpp"
#include "refine/patch_refiner.hpp"
#include "structure/reader.hpp"
#include "support/excluded_survey.hpp"

namespace vdwmesh {
namespace {

struct TableOptions {
  std::uint64_t search = 2'000'000;
  int levels = 0;
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

// What levels are compared by: errors relative to the exact measures.
struct LevelErrors {
  double area, volume;
};

// What stands before the figures of a mesh.
struct RowName {
  std::string set;
  double edge_length;
  int level;
  double split, seconds;  // of the mesher
};

void print_ratio(double coarse, double fine) {
  std::printf(",%.3f,%.1e", coarse / fine, fine + (fine - coarse) / 3);
}

LevelErrors print_row(const RowName& name, const SphereSet& atoms, const ExcludedMeasures& exact,
                      const PatchedMesh& mesh, const std::optional<LevelErrors>& above,
                      const TableOptions& options) {
  const testing::ExcludedSurvey s = testing::survey_excluded(atoms, exact.probe, mesh);
  const reference::MeshFacts& f = s.facts;
  const ExcludedSurface& surface = exact.complete;
  const Distribution angles = quality(mesh.mesh).min_angle_deg;
  const LevelErrors errors{f.area / surface.area - 1, f.volume / surface.volume - 1};
  const std::string crossings =
      f.triangles <= options.search ? std::to_string(self_intersections(mesh.mesh)) : "";
  std::printf("%s,%g,%g,%zu,%d,%ld,%ld,%s,%zu,%llu,%llu,%.1e,%.2f,%.2f,%.4f,%.4f,%.0f,%.2f,%d",
              name.set.c_str(), exact.probe, name.edge_length, f.triangles, s.sound() ? 1 : 0,
              static_cast<long>(f.euler_characteristic() - surface.topology->euler_characteristic),
              static_cast<long>(f.positive_shells + f.negative_shells) -
                  static_cast<long>(surface.topology->shells.size()),
              crossings.c_str(), f.degenerate_triangles, static_cast<unsigned long long>(s.inward),
              static_cast<unsigned long long>(s.bad_normals + s.bad_labels), s.off_patch,
              angles.p01, angles.min, 100 * errors.area, 100 * errors.volume, name.split,
              name.seconds, name.level);
  if (above) {
    print_ratio(above->area, errors.area);
    print_ratio(above->volume, errors.volume);
  } else {
    std::printf(",,,,");
  }
  std::printf("\n");
  return errors;
}

// A mesh and its subdivisions.
void print_levels(const std::string& set, const SphereSet& atoms, const ExcludedMeasures& exact,
                  double h, const TableOptions& options) {
  ExcludedMeshOptions wanted;
  wanted.probe = exact.probe;
  wanted.edge_length = h;
  ExcludedMesh made = mesh_excluded(atoms, wanted);
  RowName name{set, h, 0, static_cast<double>(made.stats.split), made.stats.seconds};
  PatchedMesh mesh = std::move(static_cast<PatchedMesh&>(made));
  std::optional<LevelErrors> above;
  for (name.level = 0; name.level <= options.levels; ++name.level) {
    if (name.level > 0) {
      mesh = refine_patches(atoms, std::move(mesh), {.subdivisions = 1}).mesh;
    }
    above = print_row(name, atoms, exact, mesh, above, options);
  }
}

void print_rows(const std::string& file, const TableOptions& options) {
  const std::string set = std::filesystem::path(file).stem().string();
  const SphereSet atoms = read_atoms(file);
  for (const double probe : options.probes) {
    const ExcludedMeasures exact = excluded_measures(atoms, {.probe = probe});
    for (const double h : options.edge_lengths) {
      try {
        print_levels(set, atoms, exact, h, options);
      } catch (const Error& error) {
        std::printf("%s,%g,%g,,,,,,,,,,,,,,,,,,,,,%s\n", set.c_str(), probe, h, error.what());
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
    } else if (arg == "--levels" && i + 1 < argc) {
      options.levels = std::atoi(argv[++i]);
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
      "bad_labels,off_patch,p01_angle,least_angle,area_percent,volume_percent,split,seconds,"
      "level,area_ratio,area_left,volume_ratio,volume_left\n");
  for (const std::string& file : files) print_rows(file, options);
  return 0;
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) { return vdwmesh::run(argc, argv); }
