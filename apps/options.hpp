// What the command line can say, as checked options of the libraries: the rooms of the program take
// these structs and know nothing of how they were typed.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "cuda/backend_choice.hpp"
#include "request/mesh_request.hpp"
#include "structure/reader.hpp"

namespace vdwmesh::apps {

enum class Switch { off, on };

struct InputOptions {
  std::filesystem::path path;
  std::string sample;  // used in place of `path` where not empty
  ReadOptions read;
  double probe = 0;  // Å
};

// Records of studies hold these numbers.
enum class SelfIntersections { count = 1, skip = 2 };

// CGAL's measures of the OpenMesh mesh, beside ours.
enum class CgalCheck { small_meshes, run, skip };

struct DistanceChoice {
  Switch distances = Switch::on;
  double samples_per_area = 10;  // per Å²
  std::uint64_t seed = 1;
};

enum class Progress { terminal_only, always, never };
enum class Verbosity { normal, quiet, verbose };

struct MachineOptions {
  Backend backend = Backend::automatic;
  int devices = 1;                 // CUDA devices that share an extraction
  int threads = 0;                 // 0: all
  std::uint64_t memory_limit = 0;  // bytes
  Progress progress = Progress::terminal_only;
  Verbosity verbosity = Verbosity::normal;
};

enum class AtomGroup { atom, residue, chain };

// What a file of atoms has as B factors.
enum class AtomFigure { area, volume, exposure, depth };
// The same of interfaces: what an atom loses in all of them, its contacts, and its area alone.
enum class InterfaceFigure { buried, contact, area };

enum class RowFormat { by_extension, jsonl, csv };

// Part `number` (from 1) of `count` parts of a batch.
struct Shard {
  std::uint64_t number = 1, count = 1;
};

// The verb whose figures the rows of a batch have.
enum class BatchVerb { exact, report, interface, pockets };

struct BatchChoice {
  BatchVerb verb = BatchVerb::exact;
  std::string output;  // a file; standard output if empty
  RowFormat rows = RowFormat::by_extension;
  Shard shard;
  Switch resume = Switch::on;
};

// What `pockets` answers in place of its table; one of them at most.
struct PocketQuery {
  std::optional<std::array<double, 2>> scan;  // Å: the smallest and the largest probe
  std::optional<double> shell;                // Å: the larger of two probes
  std::string from;                           // an atom, a place or a pocket
  std::optional<double> edge_length;          // Å: of the pockets' meshes
};

// Where results go: a file, standard output ("-") or nowhere (empty).
struct OutputOptions {
  std::string json, per_atom, voids, csv, spheres, gradient, depth, atoms, residues;
  std::string pocket_meshes;
  AtomGroup group = AtomGroup::atom;
  AtomFigure b_factor = AtomFigure::area;  // of `atoms`
  InterfaceFigure interface_figure = InterfaceFigure::buried;
};

}  // namespace vdwmesh::apps
