// What the command line can say, as checked options of the libraries: the rooms of the program take
// these structs and know nothing of how they were typed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/study.hpp"
#include "cuda/backend.hpp"
#include "extract/extractor.hpp"
#include "measures/exact_union.hpp"
#include "refine/refiner.hpp"
#include "structure/reader.hpp"

namespace vdwmesh::apps {

enum class Switch { off, on };

struct InputOptions {
  std::filesystem::path path;
  std::string sample;  // used in place of `path` where not empty
  ReadOptions read;
  double probe = 0;  // Å
};

// Which surface is measured or meshed: the boundary of the union of the balls, which a probe makes
// the accessible surface; or the solvent-excluded surface.
enum class ExactSurface { vdw, excluded };

// Edge lengths of Mesher::exact that differ from atom to atom.
struct EdgeGrading {
  std::optional<double> relative;   // as a share of the sphere's radius
  std::string table;                // path of a table of atoms with their edge lengths
  std::vector<std::string> groups;  // "SELECTION=LENGTH" as it was given
  std::vector<double> of_groups;    // Å, of the groups of ReadOptions::groups
  bool is_uniform() const { return !relative && table.empty() && groups.empty(); }
};

struct SurfaceOptions {
  ExactSurface kind = ExactSurface::vdw;  // `excluded` by Mesher::exact alone
  Mesher mesher = Mesher::marching_cubes;
  // What decided that: "default", or an option such as --mesher or --spacing; empty where a verb
  // has one mesher.
  std::string mesher_reason;
  // Å, of Mesher::exact; empty: the grading gives all lengths.
  std::optional<double> edge_length;
  EdgeGrading grading;
  std::vector<double> edge_lengths;  // Å, by sphere, once the structure is read; empty: all alike
  std::optional<double> min_angle;   // degrees, of Mesher::exact
  FieldOptions field;
  GridOptions grid;
  int subdivisions = 0;
  Projection projection = Projection::none;
  Crossings crossings = Crossings::undo;
  std::vector<std::string> notes;  // for people: options that have no effect

  // Whether `crossings` has an effect. Nothing can cross if no vertex moves, and meshes of the
  // exact mesher are refined without a search (refine/refiner.hpp).
  bool looks_for_crossings() const {
    return mesher == Mesher::marching_cubes && projection != Projection::none;
  }
};

// Records of studies hold these numbers.
enum class SelfIntersections { count = 1, skip = 2 };

// CGAL's measures of the OpenMesh mesh, beside ours.
enum class CgalCheck { small_meshes, run, skip };

struct ExactOptions {
  ExactSurface surface = ExactSurface::vdw;
  UnionMethod method = UnionMethod::cgal;
  TopologyRequest topology = TopologyRequest::full;
  Switch certify = Switch::off;
};

struct DistanceChoice {
  Switch distances = Switch::on;
  double samples_per_area = 10;  // per Å²
  std::uint64_t seed = 1;
};

enum class Progress { terminal_only, always, never };
enum class Verbosity { normal, quiet };

struct MachineOptions {
  Backend backend = Backend::automatic;
  int devices = 1;                 // CUDA devices that share an extraction
  int threads = 0;                 // 0: all
  std::uint64_t memory_limit = 0;  // bytes
  Progress progress = Progress::terminal_only;
  Verbosity verbosity = Verbosity::normal;
};

enum class AtomGroup { atom, residue, chain };

enum class RowFormat { by_extension, jsonl, csv };

// Part `number` (from 1) of `count` parts of a batch.
struct Shard {
  std::uint64_t number = 1, count = 1;
};

// The verb whose figures the rows of a batch have.
enum class BatchVerb { exact, report };

struct BatchChoice {
  BatchVerb verb = BatchVerb::exact;
  std::string output;  // a file; standard output if empty
  RowFormat rows = RowFormat::by_extension;
  Shard shard;
  Switch resume = Switch::on;
};

// Where results go: a file, standard output ("-") or nowhere (empty).
struct OutputOptions {
  std::string json, per_atom, voids;
  AtomGroup group = AtomGroup::atom;
};

}  // namespace vdwmesh::apps
