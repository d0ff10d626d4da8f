// What the verbs share on the command line: groups of options that add themselves to a verb and
// turn into checked options of the libraries before any work begins.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/study.hpp"
#include "arrangement/exact_union.hpp"
#include "cuda/backend.hpp"
#include "extract/extractor.hpp"
#include "named_files.hpp"
#include "refine/refiner.hpp"
#include "structure/reader.hpp"

namespace CLI {
class App;
}

namespace vdwmesh::apps {

struct InputOptions {
  std::filesystem::path path;
  std::string sample;  // used in place of `path` where not empty
  ReadOptions read;
  double probe = 0;  // Å
};

struct SurfaceOptions {
  Mesher mesher = Mesher::marching_cubes;
  double edge_length = 0;  // Å, of Mesher::exact
  FieldOptions field;
  GridOptions grid;
  int subdivisions = 0;
  Projection projection = Projection::none;
  std::vector<std::string> notes;  // for people: options that have no effect
};

enum class Switch { off, on };

struct ExactOptions {
  UnionMethod method = UnionMethod::cgal;
  Switch topology = Switch::on;
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

struct OutputOptions {
  std::string json, per_atom;  // empty: none; "-": standard output
  AtomGroup group = AtomGroup::atom;
};

// The names of the contract for values of the libraries, as the report prints them.
std::string_view mesher_name(Mesher mesher);
std::string_view field_name(FieldKind kind);
std::string_view preset_name(FieldPreset preset);
std::string_view projection_name(Projection projection);
std::string_view backend_name(Backend backend);
std::string_view method_name(UnionMethod method);
// The inverse. Throw InvalidInput for an unknown name, naming `option`.
Mesher mesher_of_name(std::string_view name, std::string_view option = "--mesher");
FieldKind field_of_name(std::string_view name, std::string_view option = "--field");
Projection projection_of_name(std::string_view name, std::string_view option = "--project");
Backend backend_of_name(std::string_view name, std::string_view option = "--backend");
Switch switch_of_name(std::string_view option, std::string_view name);

class InputFlags {
 public:
  enum class Inputs { one, several };
  void add_to(CLI::App& verb, Inputs inputs = Inputs::one);
  // `preset` decides about HETATM records where neither flag is given.
  InputOptions resolve(NamedFiles& files, FieldPreset preset = FieldPreset::radius_aware) const;
  // Of Inputs::several: the files, then the samples.
  std::vector<InputOptions> resolve_all(NamedFiles& files) const;

 private:
  std::vector<std::string> paths_, samples_;
  std::string path_, sample_, format_, model_ = "first", altloc_ = "highest", radii_ = "bondi";
  std::string assembly_ = "asymmetric", select_, probe_ = "0";
  bool waters_ = false, no_hydrogens_ = false, no_hetatm_ = false, hetatm_ = false;
};

class SurfaceFlags {
 public:
  void add_to(CLI::App& verb, int default_subdivisions);
  SurfaceOptions resolve() const;

 private:
  FieldOptions resolve_field() const;
  void resolve_mesher(SurfaceOptions& options) const;
  std::string mesher_ = "marching-cubes", field_ = "vdw", preset_ = "radius-aware", subdivide_;
  std::optional<std::string> edge_length_, spacing_, padding_, isovalue_, blobbiness_, project_;
};

class ExactFlags {
 public:
  void add_to(CLI::App& verb);
  ExactOptions resolve() const;

 private:
  std::optional<std::string> method_, topology_;
};

class DistanceFlags {
 public:
  void add_to(CLI::App& verb);
  DistanceChoice resolve() const;

 private:
  std::string distances_ = "on";
  std::optional<std::string> samples_, seed_;
};

class MachineFlags {
 public:
  enum class Backends { choose, none };
  void add_to(CLI::App& verb, Backends backends);
  MachineOptions resolve() const;

 private:
  std::string backend_ = "auto";
  std::optional<std::string> devices_, threads_, memory_limit_;
  bool quiet_ = false, progress_ = false;
};

class OutputFlags {
 public:
  enum class PerAtom { offered, none };
  void add_to(CLI::App& verb, PerAtom per_atom);
  // Checks that the files can be made.
  OutputOptions resolve(NamedFiles& files) const;

 private:
  std::string json_, per_atom_;
  std::optional<std::string> group_;
};

}  // namespace vdwmesh::apps
