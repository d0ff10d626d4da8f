// The thesis's tables rerun on its grids, ours beside them.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/vec3.hpp"
#include "thesis/thesis_tables.hpp"

namespace vdwmesh::apps {

struct ThesisBenchOptions {
  std::filesystem::path structures;
  std::vector<std::string> tables;   // of kThesisTables
  std::vector<std::string> entries;  // of the thesis; empty: all
  int repeats = 3;                   // at most; the least time counts
};

// Wall-clock seconds. A time that was not taken is empty.
struct ThesisTimes {
  std::optional<double> program;     // the thesis's own program, compiled today, one thread
  std::optional<double> one_thread;  // ours
  std::optional<double> all;  // ours as it runs: all threads, or CUDA, atoms to mesh on the host
  std::optional<double> kernels;  // CUDA: kernels only
};

struct ThesisBenchRow {
  std::string table, column;  // "4.1", "blinn"; "4.4", "1 subdivision"
  ThesisEntry entry;          // of the thesis
  ThesisFigure thesis;
  std::optional<ThesisStructure> structure;  // empty: missing
  std::uint64_t atoms = 0;                   // of the structure
  Vec3i grid{};                              // cells along each axis
  std::optional<std::uint64_t> triangles;    // ours; empty where nothing ran
  std::optional<std::uint64_t> program_triangles;
  ThesisTimes seconds;
};

struct ThesisBench {
  std::vector<ThesisBenchRow> rows;
  int threads = 1;
  std::optional<std::string> device, driver;
  std::string no_device;  // why there is no CUDA; empty where there is
};

// The seconds that are compared with the thesis's: ours as it runs.
std::optional<double> seconds_ratio(const ThesisBenchRow& row);
// The same per triangle, which stand-ins have as well.
std::optional<double> per_triangle_ratio(const ThesisBenchRow& row);
std::optional<double> triangles_ratio(const ThesisBenchRow& row);

// `on_row` is called before each row, with its place and the number of rows.
ThesisBench rerun_thesis(
    const ThesisBenchOptions& options,
    const std::function<void(std::size_t, std::size_t, const ThesisBenchRow&)>& on_row);

std::string thesis_bench_text(const ThesisBench& bench);
std::string thesis_bench_csv(const ThesisBench& bench);
std::string thesis_bench_json(const ThesisBench& bench);

}  // namespace vdwmesh::apps
