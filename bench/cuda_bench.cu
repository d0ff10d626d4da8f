// Times of the CUDA backend on the device, by events; medians of repeated runs.
//
//   cuda_bench [--extract | --refine | --crossings | --end-to-end | --small] [XYZR...]
//   cuda_bench --once WHAT [XYZR]
//
// Extraction from spheres and from fields; refinement with crossings allowed, and undone; end to
// end against the CPU backend; each file a thousand times, one after another and in one batch. An
// option leaves out the other four. The last file is also taken six times, side by side. --once
// does one thing between cudaProfilerStart() and cudaProfilerStop(), for a profiler that starts
// there.
#include <cuda_profiler_api.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/workspace.hpp"
#include "cuda/backend.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/refine/device_refinement.cuh"
#include "extract/field_list.hpp"
#include "read_xyzr.hpp"
#include "small_molecules.cuh"
#include "support/sampled_spheres.hpp"
#include "synthetic_sets.hpp"

namespace vdwmesh {
namespace {

// ms of work on the stream, median over repeats after one warm-up.
double time_on_device(const Stream& stream, const std::function<void()>& work) {
  std::vector<double> times;
  work();
  for (int i = 0; i < kRepeats; ++i) {
    StageClock clock(stream.get());
    work();
    times.push_back(clock.lap());
  }
  return median(times);
}

double copy_rate(const Stream& stream) {
  const std::size_t bytes = std::size_t{4} << 30;
  const DeviceArray<std::uint8_t> from(bytes, stream.get()), to(bytes, stream.get());
  const double ms = time_on_device(stream, [&] {
    check_cuda(
        cudaMemcpyAsync(to.data(), from.data(), bytes, cudaMemcpyDeviceToDevice, stream.get()),
        "copy");
  });
  const double rate = 2.0 * static_cast<double>(bytes) / (ms * 1e-3);
  std::printf("device copy: %.2f TB/s (read + written)\n", rate * 1e-12);
  return rate;
}

ExtractOptions with_half_edges() {
  ExtractOptions options;
  options.connectivity = Connectivity::half_edges;
  return options;
}

void report_extraction(const char* name, const SphereSet& spheres, const ExtractOptions& options,
                       double rate) {
  const Stream stream;
  const GridSpec grid = make_grid(spheres, options.grid);
  const FieldModel model = make_field_model(options.field, grid);
  const CellList list = make_field_list(spheres, model);
  const DeviceCellList device_list(list.view(), stream.get());
  std::vector<double> search, count, scan, vertex, triangle, total;
  std::uint64_t vertices = 0, triangles = 0, bricks = 0, candidates = 0;
  for (int i = 0; i <= kRepeats; ++i) {
    const double seconds = seconds_of([&] {
      const DeviceExtraction e = extract_on_device(device_list.view(), model, options, stream);
      vertices = e.mesh.vertex_count();
      triangles = e.mesh.triangle_count();
      bricks = e.stats.surface_bricks;
      candidates = e.candidates;
      if (i == 0) return;
      search.push_back(e.timings.search);
      count.push_back(e.timings.count);
      scan.push_back(e.timings.scan);
      vertex.push_back(e.timings.vertices);
      triangle.push_back(e.timings.triangles);
    });
    if (i > 0) total.push_back(seconds * 1e3);
  }
  const double floor = static_cast<double>(indexed_mesh_bytes(
                           {vertices, triangles}, {.connectivity = Connectivity::half_edges})) /
                       (rate / 2) * 1e3 / 2;
  std::printf("%-34s %9lld x %6lld x %6lld cells  V %11llu T %11llu bricks %9llu of %llu\n", name,
              static_cast<long long>(grid.cells.x), static_cast<long long>(grid.cells.y),
              static_cast<long long>(grid.cells.z), static_cast<unsigned long long>(vertices),
              static_cast<unsigned long long>(triangles), static_cast<unsigned long long>(bricks),
              static_cast<unsigned long long>(candidates));
  std::printf(
      "    search %.3f  count %.3f  scan %.3f  vertices %.3f  triangles %.3f  sum %.3f  wall %.3f "
      "ms"
      "  (mesh written once: %.3f ms)\n",
      median(search), median(count), median(scan), median(vertex), median(triangle),
      median(search) + median(count) + median(scan) + median(vertex) + median(triangle),
      median(total), floor);
}

// Field in memory -> mesh with or without half-edges, double positions, no labels, against the
// floor of this run: the field read once and the mesh written once, at the rate of the copy.
void report_field_meshing(const SampledFieldView& field, const ExtractOptions& options,
                          double rate) {
  const Stream stream;
  std::vector<double> total;
  std::vector<ExtractTimings> stages;
  std::uint64_t vertices = 0, triangles = 0;
  for (int i = 0; i <= 2 * kRepeats; ++i) {
    const double seconds = seconds_of([&] {
      const DeviceExtraction e = mesh_field_on_device(field, options, stream);
      vertices = e.mesh.vertex_count();
      triangles = e.mesh.triangle_count();
      stages.push_back(e.timings);
    });
    if (i > 0) total.push_back(seconds * 1e3);
  }
  const auto stage = [&](float ExtractTimings::*member) {
    std::vector<double> times;
    for (const ExtractTimings& t : stages) times.push_back(static_cast<double>(t.*member));
    return median(times);
  };
  const bool with_normals = options.normals == Normals::gradients;
  const bool with_half_edges = options.connectivity == Connectivity::half_edges;
  const std::size_t vertex_bytes = sizeof(Vec3d) + (with_normals ? sizeof(Vec3f) : 0);
  const double bytes =
      static_cast<double>(field.grid.node_count() * sizeof(float) + vertices * vertex_bytes +
                          triangles * (with_half_edges ? 6 : 3) * sizeof(std::uint32_t));
  const double floor = bytes / rate * 1e3;
  std::printf(
      "    field -> mesh, %s, %s: V %llu T %llu  wall %.3f ms, floor %.3f ms, %.2f x\n"
      "    bits, bricks %.3f  count %.3f  scan %.3f  vertices %.3f  triangles %.3f ms\n",
      with_normals ? "normals" : "no normals", with_half_edges ? "half-edges" : "no half-edges",
      static_cast<unsigned long long>(vertices), static_cast<unsigned long long>(triangles),
      median(total), floor, median(total) / floor, stage(&ExtractTimings::search),
      stage(&ExtractTimings::count), stage(&ExtractTimings::scan), stage(&ExtractTimings::vertices),
      stage(&ExtractTimings::triangles));
}

// The field of the spheres at every node, which the host makes, is meshed.
void report_field(const char* name, const SphereSet& spheres, ExtractOptions options, double rate) {
  const testing::SampledField sampled = testing::sampled_spheres(spheres, options);
  const Stream stream;
  const DeviceArray<float> values =
      upload(sampled.values.data(), sampled.values.size(), stream.get());
  const SampledFieldView field{sampled.grid, values.data(), sampled.isovalue};
  std::printf("%-34s %lld x %lld x %lld nodes\n", name,
              static_cast<long long>(field.grid.cells.x + 1),
              static_cast<long long>(field.grid.cells.y + 1),
              static_cast<long long>(field.grid.cells.z + 1));
  for (const Normals normals : {Normals::none, Normals::gradients}) {
    options.normals = normals;
    report_field_meshing(field, options, rate);
  }
  options.normals = Normals::none;
  options.connectivity = Connectivity::triangles;
  report_field_meshing(field, options, rate);
}

void report_refinement(const char* name, const SphereSet& spheres, double spacing, int subdivisions,
                       Crossings crossings) {
  const Stream stream;
  ExtractOptions extract;
  extract.grid.spacing = spacing;
  extract.connectivity = Connectivity::half_edges;
  const GridSpec grid = make_grid(spheres, extract.grid);
  const FieldModel model = make_field_model(extract.field, grid);
  const CellList list = make_field_list(spheres, model);
  const DeviceCellList device_list(list.view(), stream.get());
  RefineOptions refine;
  refine.subdivisions = subdivisions;
  refine.crossings = crossings;
  refine.grid = grid;
  Workspace workspace;
  const DeviceSurface surface(spheres, refine, TriangleLabels::none, workspace, stream);
  std::vector<double> total;
  std::vector<float> levels;
  std::vector<RefineTimings> stages;
  std::uint64_t vertices = 0, triangles = 0;
  for (int i = 0; i < 4; ++i) {
    const double seconds = seconds_of([&] {
      DeviceExtraction e = extract_on_device(device_list.view(), model, extract, stream);
      const DeviceRefinement r =
          refine_on_device(surface.view(), std::move(e.mesh), refine, stream);
      stream.wait();
      levels = r.level_milliseconds;
      stages = r.timings;
      vertices = r.mesh.vertex_count();
      triangles = r.mesh.triangle_count();
    });
    if (i > 0) total.push_back(seconds * 1e3);
  }
  std::printf("%-34s %.2f Å x%d, crossings %s  V %llu T %llu  wall %.2f ms; levels", name, spacing,
              subdivisions, crossings == Crossings::allow ? "allowed" : "undone",
              static_cast<unsigned long long>(vertices), static_cast<unsigned long long>(triangles),
              median(total));
  for (const float ms : levels) std::printf(" %.2f", static_cast<double>(ms));
  std::printf(" ms (last: normals)\n");
  for (const RefineTimings& t : stages) {
    std::printf("    edges %.2f  midpoints %.2f  children %.2f  moves %.2f ms\n",
                static_cast<double>(t.edges), static_cast<double>(t.midpoints),
                static_cast<double>(t.children), static_cast<double>(t.moves));
  }
}

// GB/s from the device into page-locked memory.
double download_rate() {
  const Stream stream;
  constexpr std::size_t bytes = std::size_t{512} << 20;
  const DeviceArray<std::uint8_t> from(bytes, stream.get());
  void* to = nullptr;
  check_cuda(cudaMallocHost(&to, bytes), "page-locked memory");
  const double ms = time_on_device(stream, [&] {
    check_cuda(cudaMemcpyAsync(to, from.data(), bytes, cudaMemcpyDeviceToHost, stream.get()),
               "copy");
  });
  check_cuda(cudaFreeHost(to), "page-locked memory");
  return static_cast<double>(bytes) / ms * 1e-6;
}

// Into which memory a mesh goes: new, or the memory of the mesh before.
enum class Into { new_memory, memory_before };

// s from spheres in memory to mesh in memory, and of them the download: the second to fourth of
// four runs' medians.
struct EndToEnd {
  double all, download;
};
EndToEnd seconds_to_mesh(const SphereSet& spheres, const ExtractOptions& options, Backend backend,
                         Into into, PipelineResult& result) {
  std::vector<double> times, downloads;
  for (int i = 0; i < 4; ++i) {
    if (into == Into::new_memory) result = {};
    const double t =
        seconds_of([&] { make_pipeline(backend)->run_into(result, spheres, options, {}); });
    if (i == 0) continue;
    times.push_back(t);
    downloads.push_back(result.extract.download_seconds);
  }
  return {median(times), median(downloads)};
}

void report_end_to_end(const std::filesystem::path& path, double spacing, double bus_rate) {
  const SphereSet spheres(read_xyzr(path));
  ExtractOptions options;
  options.grid.spacing = spacing;
  PipelineResult result;
  const double cpu = seconds_to_mesh(spheres, options, Backend::cpu, Into::new_memory, result).all;
  std::printf("%-12s %.2f Å  atoms in memory -> mesh in memory: cpu %.4f s\n", path.stem().c_str(),
              spacing, cpu);
  const auto present = static_cast<int>(cuda_devices().devices.size());
  for (options.devices = 1; options.devices <= present; ++options.devices) {
    for (const Into into : {Into::new_memory, Into::memory_before}) {
      const EndToEnd cuda = seconds_to_mesh(spheres, options, Backend::cuda, into, result);
      const auto floor = static_cast<double>(indexed_mesh_bytes(result.mesh)) / bus_rate * 1e-9;
      std::printf(
          "    cuda, %d devices, %s: %.4f s, %.1f x; kernels %.4f, download %.4f s, %.2f x "
          "(page-locked at %.1f GB/s: %.4f)\n",
          options.devices, into == Into::new_memory ? "new memory" : "memory of the call before",
          cuda.all, cpu / cuda.all, result.extract.field_seconds + result.extract.extract_seconds,
          cuda.download, cuda.download / floor, bus_rate, floor);
    }
  }
}

// The synthetic cluster with `nodes` along each axis, as report_synthetic() meshes it.
ExtractOptions synthetic_options(const SphereSet& cluster, int nodes) {
  const Box box = bounding_box(cluster);
  ExtractOptions options = with_half_edges();
  options.field.kind = FieldKind::blinn;
  options.grid.padding = 2.0;
  options.grid.spacing = (box.upper.x - box.lower.x + 4.0) / (nodes - 1);
  return options;
}

void report_synthetic(double rate) {
  const SphereSet cluster = synthetic_cluster();
  for (const int nodes : {256, 512, 1024}) {
    ExtractOptions options = synthetic_options(cluster, nodes);
    report_extraction(("synthetic blinn " + std::to_string(nodes)).c_str(), cluster, options, rate);
    report_field(("synthetic blinn " + std::to_string(nodes)).c_str(), cluster, options, rate);
    options.field.kind = FieldKind::vdw;
    report_extraction(("synthetic vdw " + std::to_string(nodes)).c_str(), cluster, options, rate);
  }
}

void report_extractions(const std::string& name, const SphereSet& spheres, double rate) {
  ExtractOptions options = with_half_edges();
  report_extraction((name + " vdw").c_str(), spheres, options, rate);
  options.field.kind = FieldKind::blinn;
  report_extraction((name + " blinn").c_str(), spheres, options, rate);
}

// What is asked for; each is a part of the output.
struct Parts {
  bool extract = true, refine = true, crossings = true, end_to_end = true, small = true;
};

void report_file(const std::filesystem::path& path, const Parts& parts, double rate) {
  const SphereSet spheres(read_xyzr(path));
  const std::string name = path.stem();
  if (parts.extract) report_extractions(name, spheres, rate);
  if (parts.refine) report_refinement(name.c_str(), spheres, 0.5, 2, Crossings::allow);
  if (parts.crossings) report_refinement(name.c_str(), spheres, 0.5, 2, Crossings::undo);
  if (parts.small) {
    report_small(name.c_str(), spheres);
    report_batch(name.c_str(), spheres);
  }
  if (!parts.end_to_end) return;
  const double bus_rate = download_rate();
  for (const double spacing : {0.5, 0.25}) report_end_to_end(path, spacing, bus_rate);
}

void report_million(const SphereSet& spheres, const Parts& parts, double rate) {
  const char* const name = "six copies";
  if (parts.extract) {
    report_extractions(name, spheres, rate);
  }
  for (const int subdivisions : {1, 2}) {
    if (parts.refine) report_refinement(name, spheres, 0.5, subdivisions, Crossings::allow);
    if (parts.crossings) report_refinement(name, spheres, 0.5, subdivisions, Crossings::undo);
  }
}

// Does the work twice, the second time as what a profiler records.
void profile(const std::function<void()>& work) {
  work();
  check_cuda(cudaDeviceSynchronize(), "waiting");
  check_cuda(cudaProfilerStart(), "profiler");
  work();
  check_cuda(cudaDeviceSynchronize(), "waiting");
  check_cuda(cudaProfilerStop(), "profiler");
}

// `what`: "vdw", "blinn" (extraction) or "field" (field -> mesh).
void run_once(const std::string& what, const SphereSet& spheres, ExtractOptions options) {
  const Stream stream;
  options.field.kind = what == "vdw" ? FieldKind::vdw : FieldKind::blinn;
  if (what == "field") {
    const testing::SampledField sampled = testing::sampled_spheres(spheres, options);
    const DeviceArray<float> values =
        upload(sampled.values.data(), sampled.values.size(), stream.get());
    const SampledFieldView field{sampled.grid, values.data(), sampled.isovalue};
    options.normals = Normals::none;
    return profile([&] { mesh_field_on_device(field, options, stream); });
  }
  const FieldModel model = make_field_model(options.field, make_grid(spheres, options.grid));
  const CellList list = make_field_list(spheres, model);
  const DeviceCellList device_list(list.view(), stream.get());
  profile([&] { extract_on_device(device_list.view(), model, options, stream); });
}

// argv: --once WHAT, where WHAT is "vdw", "blinn" or "field"; then a file, which is taken
// six times if WHAT begins with "six-", or nothing for the synthetic cluster with 1024 nodes along
// each axis.
int once(int argc, char** argv) {
  std::string what = argc > 2 ? argv[2] : "vdw";
  const bool six = what.starts_with("six-");
  if (six) what = what.substr(4);
  if (argc > 3) {
    const SphereSet spheres(read_xyzr(argv[3]));
    run_once(what, six ? side_by_side(spheres, 6) : spheres, with_half_edges());
  } else {
    const SphereSet cluster = synthetic_cluster();
    run_once(what, cluster, synthetic_options(cluster, 1024));
  }
  return 0;
}

int run(int argc, char** argv) {
  const DeviceList devices = cuda_devices();
  if (devices.devices.empty()) {
    std::printf("cuda_bench: %s\n", devices.reason.c_str());
    return 2;
  }
  std::printf("%s, driver %s\n", devices.devices[0].name.c_str(),
              devices.devices[0].driver.c_str());
  Parts parts;
  int first = 1;
  const std::string option = argc > 1 ? argv[1] : "";
  const DeviceScope device;
  if (option == "--once") return once(argc, argv);
  if (option.starts_with("--")) {
    first = 2;
    parts = {option == "--extract", option == "--refine", option == "--crossings",
             option == "--end-to-end", option == "--small"};
  }
  const double rate = copy_rate(Stream());
  if (parts.extract) report_synthetic(rate);
  for (int i = first; i < argc; ++i) report_file(argv[i], parts, rate);
  if (first < argc)
    report_million(side_by_side(SphereSet(read_xyzr(argv[argc - 1])), 6), parts, rate);
  return 0;
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  try {
    return vdwmesh::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cuda_bench: %s\n", error.what());
    return 1;
  }
}
