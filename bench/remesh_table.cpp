// Meshes of the excluded surface at any density, checked.
//
//   remesh_table [--probes P,...] [--densities N,...] [--most TRIANGLES] FILE...
//
// CSV on standard output, a row for each mesh. chi and shells are differences from
// excluded_measures(); off is the largest distance of a vertex from the surface, Å. --most: meshes
// that are expected to start from more triangles are left out.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "core/errors.hpp"
#include "excluded/excluded_distances.hpp"
#include "parse_list.hpp"
#include "remesh/surface_remesher.hpp"
#include "structure/radii.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {
namespace {

struct RemeshTableOptions {
  std::vector<double> probes{0.7, 1.4, 3}, densities{0.5, 1, 2, 4, 8, 16, 50};
  double most = 1e9;  // triangles
};

SphereSet atoms_of(const std::string& file) {
  std::vector<Sphere> balls;
  for (const Atom& atom : read_structure(file).atoms) balls.push_back({atom.position, atom.radius});
  return SphereSet(std::move(balls));
}

double farthest_vertex(const IndexedMesh& mesh, const SphereSet& atoms, double probe) {
  const std::span<const Vec3d> points(mesh.positions.data(), mesh.vertex_count());
  double most = 0;
  for (const double d : excluded_signed_distances(points, atoms, probe)) {
    most = std::isnan(d) ? HUGE_VAL : std::max(most, std::abs(d));
  }
  return most;
}

void print_mesh(const SphereSet& atoms, const ExcludedMeasures& exact, double density) {
  const ExcludedSurface& surface = exact.complete;
  const RemeshedSurface made = remesh_excluded(
      atoms, {.probe = exact.probe, .edge_length = edge_length_of_density(density)});
  const MeshTopology found = topology(made.mesh);
  const MeshMeasures size = measures(made.mesh);
  const Distribution angles = quality(made.mesh).min_angle_deg;
  const auto difference = [](auto a, auto b) {
    return static_cast<long>(a) - static_cast<long>(b);
  };
  std::printf("%zu,%.2f,%d,%ld,%ld,%zu,%.1e,%.2f,%.2f,%llu,%llu,%llu,%d,%.4f,%.4f,%llu,%.2f,%.2f",
              made.mesh.triangle_count(),
              static_cast<double>(made.mesh.triangle_count()) / surface.area,
              found.closed && found.manifold && found.oriented ? 1 : 0,
              difference(found.euler_characteristic, surface.topology->euler_characteristic),
              difference(found.shells, surface.topology->shells.size()),
              static_cast<std::size_t>(self_intersections(made.mesh)),
              farthest_vertex(made.mesh, atoms, exact.probe), angles.min, angles.p01,
              static_cast<unsigned long long>(made.stats.below_20_degrees),
              static_cast<unsigned long long>(made.stats.below_20_at_features),
              static_cast<unsigned long long>(made.stats.joined), made.stats.runs,
              100 * (size.area / surface.area - 1),
              100 * (size.volume.value_or(HUGE_VAL) / surface.volume - 1),
              static_cast<unsigned long long>(made.stats.exact_triangles), made.stats.exact_seconds,
              made.stats.seconds);
}

void print_rows(const std::string& file, const RemeshTableOptions& options) {
  const std::string set = std::filesystem::path(file).stem().string();
  const SphereSet atoms = atoms_of(file);
  for (const double probe : options.probes) {
    ExcludedMeasures exact;
    try {
      exact = excluded_measures(atoms, {.probe = probe, .shells = true});
    } catch (const Error& error) {
      std::printf("%s,%zu,%g,,%s\n", set.c_str(), atoms.size(), probe, error.what());
      continue;
    }
    for (const double density : options.densities) {
      // The mesh along the curves has at least some 27 triangles per Å², and 2.5 of its density.
      if (exact.complete.area * std::max(27.0, 2.5 * density) > options.most) continue;
      std::printf("%s,%zu,%g,%g,", set.c_str(), atoms.size(), probe, density);
      try {
        print_mesh(atoms, exact, density);
      } catch (const Error& error) {
        std::printf("%s", error.what());
      }
      std::printf("\n");
      std::fflush(stdout);
    }
  }
}

int run(int argc, char** argv) {
  RemeshTableOptions options;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string_view arg = argv[i];
    if (arg == "--probes" && i + 1 < argc) {
      options.probes = parse_list(argv[++i]);
    } else if (arg == "--densities" && i + 1 < argc) {
      options.densities = parse_list(argv[++i]);
    } else if (arg == "--most" && i + 1 < argc) {
      options.most = std::atof(argv[++i]);
    } else {
      files.emplace_back(arg);
    }
  }
  if (files.empty()) {
    std::fprintf(stderr, "usage: remesh_table [OPTIONS] FILE...\n");
    return 2;
  }
  std::printf(
      "set,atoms,probe,density,triangles,per_area,sound,chi,shells,crossings,off,least_angle,"
      "p01_angle,below_20,below_20_at_features,joined,runs,area_percent,volume_percent,"
      "exact_triangles,exact_seconds,seconds\n");
  for (const std::string& file : files) {
    try {
      print_rows(file, options);
    } catch (const Error& error) {
      std::printf("%s,,,,%s\n", file.c_str(), error.what());
    }
  }
  return 0;
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) { return vdwmesh::run(argc, argv); }
