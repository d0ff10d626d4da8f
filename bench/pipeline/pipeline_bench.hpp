// What every stage from structure file to mesh file costs, beside the least that its bytes can.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "command_line/names.hpp"
#include "options.hpp"
#include "pipeline/copy_rate.hpp"
#include "report/report.hpp"

namespace vdwmesh::apps {

// A stage of the way from file to file; a part of the stage above it; or work beside that way.
enum class StageKind { stage, part, beside };
}  // namespace vdwmesh::apps

namespace vdwmesh {
template <>
inline constexpr auto kNames<apps::StageKind> =
    names<apps::StageKind>({{"stage", apps::StageKind::stage},
                            {"part", apps::StageKind::part},
                            {"beside", apps::StageKind::beside}});
}  // namespace vdwmesh

namespace vdwmesh::apps {

struct PipelineBenchOptions {
  std::vector<InputOptions> inputs;
  std::vector<double> spacings = {0.5, 0.25};  // Å, longest first
  SurfaceOptions surface;                      // its subdivisions and crossings
  Switch distances = Switch::off;              // take longer than all the rest
  MachineOptions machine;
  int repeats = 3;  // at most; the least time counts
};

// What was not measured is empty.
struct StageRow {
  std::string name;
  StageKind kind = StageKind::stage;
  std::optional<double> cpu_seconds;  // of all threads
  double wall_seconds = 0;
  std::optional<std::uint64_t> bytes_read, bytes_written;  // that no way of doing it can avoid
  std::optional<std::uint64_t> peak_memory;                // bytes resident, of the whole process
  std::optional<double> floor_seconds;  // those bytes at the rate of a copy on one core
};

struct PipelineCase {
  std::string input;
  double spacing = 0;  // Å
  std::uint64_t spheres = 0, vertices = 0, triangles = 0;
  std::vector<StageRow> stages;
  std::vector<std::string> warnings;  // of the reader, and where the CPU stood in for a device
};

struct PipelineBench {
  std::vector<PipelineCase> cases;
  BackendReport backend;
  CopyRate copy;
};

// CPU seconds per second of the floor; empty where either is, or for a CUDA stage, whose seconds
// are the device's.
std::optional<double> floor_ratio(const StageRow& row);
// From file to file: the sum over the stages.
StageRow total_of(const PipelineCase& done);

// The inputs at the spacings, refined and, where wanted, with the distances to the exact surface.
// `on_case` is called before each of the cases, with its place
// and their number.
PipelineBench time_pipeline(const PipelineBenchOptions& options,
                            const std::function<void(std::size_t, std::size_t)>& on_case);

std::string pipeline_bench_text(const PipelineBench& bench);
std::string pipeline_bench_csv(const PipelineBench& bench);
std::string pipeline_bench_json(const PipelineBench& bench);

}  // namespace vdwmesh::apps
