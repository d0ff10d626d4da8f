// The verbs of the program: what they are called, and what runs them.
#pragma once

#include <span>
#include <string_view>

namespace vdwmesh::apps {

struct Options;

// Sets of verbs, as sums: which ones take an option.
using VerbSet = unsigned;
inline constexpr VerbSet kMesh = 1, kReport = 2, kExact = 4, kCompare = 8, kRender = 16,
                         kStudy = 32, kThesisBench = 64, kPipelineBench = 128, kInfo = 256,
                         kBatch = 512;

struct Verb {
  VerbSet bit;
  std::string_view name;  // "mesh"; of two words where a verb of verbs has them, "bench thesis"
  std::string_view summary;
  // Works with options that are checked. Throws the exceptions of core/errors.hpp.
  void (*run)(const Options& options);
};

// In the order of the help.
std::span<const Verb> all_verbs();

void run_mesh(const Options& options);
void run_report(const Options& options);
void run_exact(const Options& options);
void run_compare(const Options& options);
void run_render(const Options& options);
void run_study(const Options& options);
void run_thesis_bench(const Options& options);
void run_pipeline_bench(const Options& options);
void run_batch_verb(const Options& options);
void run_info(const Options& options);

}  // namespace vdwmesh::apps
