// Ours beside what a user would pick instead, on the same input in the same run: VTK's Flying Edges
// and OpenVDB for the mesh, freesasa for the exposed area, gemmi for reading.
//
//   anchors_bench [--spacing H,H...] [--repeat N] [--only areas] [--probe R] FILE...
//
// --only areas leaves reading and meshes out; --probe adds R to the radii (Å), for accessible
// areas. Every program runs in a process of its own and in turn, N times; the least of each figure
// counts. "Ratio" is the peer's figure over ours: above 1 we are ahead. Peers whose library was not
// found when this was built are left out (scripts/install-deps.sh anchors installs them). Memory is
// the peak beyond what the process began with, the spheres. Kernel seconds are part of the CPU's:
// where pages are dear they decide the ratio.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "anchors/anchors.hpp"
#include "anchors/apart.hpp"
#include "extract/extractor.hpp"
#include "measures/exact_union.hpp"
#include "parse_list.hpp"
#include "structure/reader.hpp"

namespace vdwmesh::anchors {
namespace {

struct Options {
  std::vector<std::string> files;
  std::vector<double> spacings{0.5, 0.25};  // Å
  int repeat = 3;
  bool only_areas = false;
  double probe = 0;  // Å
};

struct Runner {
  std::string name;
  std::function<std::uint64_t()> work;
  Cost cost{};
};

std::uint64_t our_mesh(const std::vector<Sphere>& spheres, double spacing, std::size_t threads,
                       Normals normals = Normals::gradients) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  ExtractOptions options;
  options.grid.spacing = spacing;
  options.normals = normals;
  return make_cpu_extractor()->extract(SphereSet(spheres), options).mesh.triangle_count();
}

std::uint64_t our_union(const std::vector<Sphere>& spheres, std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  return exact_union(SphereSet(spheres), {UnionMethod::arcs, nullptr}).per_sphere.size();
}

// In turn, so that what else the machine does falls on all alike.
void run_in_turn(std::vector<Runner>& runners, int repeat) {
  for (int i = 0; i < repeat; ++i) {
    for (Runner& runner : runners) {
      const Cost cost = run_apart(runner.name, runner.work);
      runner.cost = i == 0 ? cost : least(runner.cost, cost);
    }
  }
}

// The first runner is ours on one thread, the second ours on two; the others are compared with the
// first, and the second by its wall seconds.
void print(const std::string& title, const char* items, const std::vector<Runner>& runners) {
  fmt::print("\n{}\n{:<26} {:>10} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n", title, "", items,
             "CPU s", "kernel s", "wall s", "MB", "CPU", "wall", "memory");
  const Cost& ours = runners.front().cost;
  for (const Runner& runner : runners) {
    const Cost& c = runner.cost;
    fmt::print("{:<26} {:>10} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.1f} {:>9.2f} {:>9.2f} {:>9.2f}\n",
               runner.name, c.items, c.cpu, c.kernel, c.wall, static_cast<double>(c.memory) / 1e6,
               c.cpu / ours.cpu, c.wall / ours.wall,
               static_cast<double>(c.memory) / static_cast<double>(ours.memory));
  }
  std::fflush(stdout);
}

void compare_meshes(const std::string& file, const std::vector<Sphere>& spheres,
                    const Options& options) {
  for (const double spacing : options.spacings) {
    std::vector<Runner> runners{
        {"ours, one thread", [&] { return our_mesh(spheres, spacing, 1); }},
        {"ours, two threads", [&] { return our_mesh(spheres, spacing, 2); }},
        {"ours, no normals", [&] { return our_mesh(spheres, spacing, 1, Normals::none); }}};
#ifdef VDWMESH_ANCHOR_VTK
    runners.push_back({"VTK Flying Edges", [&] { return flying_edges(spheres, spacing); }});
#endif
#ifdef VDWMESH_ANCHOR_OPENVDB
    runners.push_back({"OpenVDB level set", [&] { return level_set(spheres, spacing); }});
#endif
    run_in_turn(runners, options.repeat);
    print(fmt::format("{}: {} spheres to mesh at {} A", file, spheres.size(), spacing), "triangles",
          runners);
  }
}

void compare_unions(const std::string& file, const std::vector<Sphere>& spheres,
                    const Options& options) {
  std::vector<Runner> runners{{"ours (arcs), one thread", [&] { return our_union(spheres, 1); }},
                              {"ours (arcs), two threads", [&] { return our_union(spheres, 2); }}};
#ifdef VDWMESH_ANCHOR_FREESASA
  runners.push_back({"freesasa, 20 slices", [&] { return lee_richards(spheres); }});
  runners.push_back({"freesasa, 100 points", [&] { return shrake_rupley(spheres); }});
#endif
  run_in_turn(runners, options.repeat);
  print(fmt::format("{}: exposed area (ours: area and volume), probe {} A", file, options.probe),
        "spheres", runners);
}

void compare_readers(const std::string& file, const Options& options) {
  std::vector<Runner> runners{
      {"ours: read and choose", [&] { return read_structure(file).atoms_read; }}};
#ifdef VDWMESH_ANCHOR_GEMMI
  if (!file.ends_with(".xyzr"))
    runners.push_back({"gemmi: read", [&] { return gemmi_structure(file); }});
#endif
  run_in_turn(runners, options.repeat);
  print(fmt::format("{}: file to atoms", file), "atoms", runners);
}

std::vector<Sphere> read_spheres(const std::string& file, double probe) {
  std::vector<Sphere> spheres;
  for (const Atom& atom : read_structure(file).atoms)
    spheres.push_back({atom.position, atom.radius + probe});
  return spheres;
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const bool has_value = i + 1 < argc;
    if (argument == "--spacing" && has_value)
      options.spacings = parse_list(argv[++i]);
    else if (argument == "--repeat" && has_value)
      options.repeat = std::max(1, std::stoi(argv[++i]));
    else if (argument == "--probe" && has_value)
      options.probe = std::stod(argv[++i]);
    else if (argument == "--only" && has_value && std::string(argv[i + 1]) == "areas") {
      options.only_areas = true;
      ++i;
    } else
      options.files.push_back(argument);
  }
  return options;
}

int run(int argc, char** argv) {
  const Options options = parse(argc, argv);
  if (options.files.empty()) {
    fmt::print(stderr,
               "usage: anchors_bench [--spacing H,H...] [--repeat N] [--only areas] [--probe R] "
               "FILE...\n");
    return 1;
  }
  for (const std::string& file : options.files) {
    const std::vector<Sphere> spheres = read_spheres(file, options.probe);
    if (!options.only_areas) compare_readers(file, options);
    compare_unions(file, spheres, options);
    if (options.only_areas) continue;
    compare_meshes(file, spheres, options);
  }
  return 0;
}

}  // namespace
}  // namespace vdwmesh::anchors

int main(int argc, char** argv) {
  try {
    return vdwmesh::anchors::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "anchors_bench: {}\n", error.what());
    return 1;
  }
}
