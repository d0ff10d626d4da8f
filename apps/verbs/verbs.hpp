// The programs and their verbs: what they are called, and what runs them.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

namespace vdwmesh::apps {

struct Options;

// Sets of verbs, as sums: which ones take an option.
using VerbSet = unsigned;
inline constexpr VerbSet kMesh = 1, kReport = 2, kExact = 4, kCompare = 8, kRender = 16,
                         kStudy = 32, kInfo = 64, kBatch = 128, kInterface = 1024, kPockets = 2048,
                         kView = 4096;
// Of vdwmesh-mpi, which has fewer options for the same.
inline constexpr VerbSet kRanksMesh = 256, kRanksExact = 512;

struct Verb {
  VerbSet bit;
  std::string_view name;  // "mesh"
  std::string_view summary;
  // Works with options that are checked. Throws the exceptions of core/errors.hpp.
  std::function<void(const Options& options)> run;
};

struct Program {
  std::string_view name;        // as it is called
  std::string_view usage_name;  // as it is started: "mpirun -n P vdwmesh-mpi"
  std::string_view summary;
  std::span<const Verb> verbs;  // in the order of the help
  std::uint64_t processes = 1;  // of it on this host, which share its memory
};

// The program `vdwmesh`.
const Program& plain_program();

void run_mesh(const Options& options);
void run_report(const Options& options);
void run_exact(const Options& options);
void run_interface(const Options& options);
void run_compare(const Options& options);
void run_render(const Options& options);
void run_study(const Options& options);
void run_batch_verb(const Options& options);
void run_pockets(const Options& options);
void run_view(const Options& options);
void run_info(const Options& options);

}  // namespace vdwmesh::apps
