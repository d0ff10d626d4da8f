// Reruns the tables of the thesis on its grids. A row is one entry and one column: our pipeline,
// with all threads and with one, beside the thesis's own program compiled today. The least time of
// several runs counts, because whatever disturbs a run makes it longer.
#include "thesis/thesis_bench.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "cuda/backend.hpp"
#include "steps/stopwatch.hpp"
#include "structure/reader.hpp"
#include "thesis/thesis_programs.hpp"

namespace vdwmesh::apps {
namespace {

constexpr double kEnoughSeconds = 2;  // of repeats, together

struct Function {
  const char* name;
  ThesisFunction theirs;
  FieldKind ours;
};
constexpr Function kFunctions[] = {
    {"blinn", ThesisFunction::blinn, FieldKind::blinn},
    {"soft", ThesisFunction::soft_object, FieldKind::soft_object},
    {"inverse-squared", ThesisFunction::inverse_squared, FieldKind::inverse_squared}};
constexpr const char* kSubdivisions[] = {"1 subdivision", "2 subdivisions"};

// The least seconds of up to `repeats` runs, fewer where they are long.
template <class Work>
double least_seconds(int repeats, Work&& work) {
  const Stopwatch all;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repeats; ++i) {
    const Stopwatch watch;
    work();
    least = std::min(least, watch.seconds());
    if (all.seconds() > kEnoughSeconds) break;
  }
  return least;
}

// ATOM records of the first model, alternate locations and all, as the thesis took them.
std::vector<Vec3d> read_atoms(const std::filesystem::path& path) {
  ReadOptions options;
  options.waters = Inclusion::keep;
  options.hetero_atoms = Inclusion::drop;
  options.altloc = "all";
  std::vector<Vec3d> atoms;
  for (const Atom& atom : read_structure(path, options).atoms) atoms.push_back(atom.position);
  return atoms;
}

SphereSet to_spheres(const std::vector<Vec3d>& atoms) {
  std::vector<Sphere> spheres;
  spheres.reserve(atoms.size());
  for (const Vec3d& atom : atoms) spheres.push_back({atom, 1.7});  // radii play no part
  return SphereSet(std::move(spheres));
}

// What the columns of a row ask for.
struct Work {
  FieldOptions field;
  int subdivisions = 0;
};

// The last tables refine the surface of the inverse-squared field; the others compare fields.
Work work_of(const std::string& table, std::size_t column) {
  if (is_vdw_table(table)) {
    return {{FieldKind::inverse_squared, FieldPreset::thesis_vdw, {}, {}},
            static_cast<int>(column) + 1};
  }
  return {{kFunctions[column].ours, FieldPreset::thesis, {}, {}}, 0};
}

struct Timed {
  double seconds = 0;
  std::optional<double> kernels;
  std::uint64_t triangles = 0;
};

Timed time_ours(const SphereSet& spheres, const Work& work, Backend backend, int repeats) {
  ExtractOptions extract;
  extract.field = work.field;
  extract.grid = preset_grid(work.field.preset, {}, {});
  RefineOptions refine;
  refine.subdivisions = work.subdivisions;
  refine.projection = Projection::field;
  refine.field = work.field;
  const auto pipeline = make_pipeline(backend);
  Timed timed;
  timed.seconds = least_seconds(repeats, [&] {
    const PipelineResult result = pipeline->run(spheres, extract, refine);
    timed.triangles = result.mesh.triangle_count();
    const double kernels = result.extract.field_seconds + result.extract.extract_seconds +
                           (work.subdivisions > 0 ? result.refine_seconds : 0);
    timed.kernels = std::min(kernels, timed.kernels.value_or(kernels));
  });
  return timed;
}

// As the thesis timed it: from atoms to triangles, without reading the file.
Timed time_program(const std::vector<Vec3d>& atoms, ThesisFunction function, SharedVertices shared,
                   int repeats) {
  const ThesisParameters parameters = thesis_parameters(function);
  Timed timed;
  timed.seconds = least_seconds(repeats, [&] {
    const ThesisGrid grid = thesis_grid(atoms, parameters);
    const std::vector<float> field = thesis_field(atoms, grid, parameters);
    timed.triangles =
        thesis_marching_cubes(atoms, field, grid, parameters, shared).triangles.size();
  });
  return timed;
}

class Bench {
 public:
  explicit Bench(const ThesisBenchOptions& options) : options_(options) {
    bench_.threads = static_cast<int>(
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    const DeviceList list = cuda_devices();
    bench_.no_device = list.reason;
    if (list.devices.empty()) return;
    bench_.no_device.clear();
    bench_.device = list.devices.front().name;
    bench_.driver = list.devices.front().driver;
  }

  // Rows without a structure stay in the tables, as missing.
  void plan() {
    for (const std::string& name : options_.tables) {
      for (const ThesisEntry& entry : thesis_table(name).entries) {
        if (!wanted(entry.id)) continue;
        for (std::size_t column = 0; column < entry.figures.size(); ++column) {
          ThesisBenchRow row;
          row.table = name;
          row.column = is_vdw_table(name) ? kSubdivisions[column] : kFunctions[column].name;
          row.entry = entry;
          row.thesis = entry.figures[column];
          row.structure = find_structure(options_.structures, entry.id);
          bench_.rows.push_back(std::move(row));
          columns_.push_back(column);
        }
      }
    }
  }

  template <class OnRow>
  ThesisBench run(OnRow&& on_row) && {
    for (std::size_t i = 0; i < bench_.rows.size(); ++i) {
      on_row(i, bench_.rows.size(), bench_.rows[i]);
      if (bench_.rows[i].structure) fill(bench_.rows[i], columns_[i]);
    }
    return std::move(bench_);
  }

 private:
  bool wanted(const std::string& id) const {
    return options_.entries.empty() || std::ranges::count(options_.entries, id) > 0;
  }

  void fill(ThesisBenchRow& row, std::size_t column) {
    const std::vector<Vec3d>& atoms = atoms_of(*row.structure);
    const SphereSet spheres = to_spheres(atoms);
    const Work work = work_of(row.table, column);
    row.atoms = atoms.size();
    row.grid = make_grid(spheres, preset_grid(work.field.preset, {}, {})).cells;
    if (is_gpu_table(row.table)) {
      if (bench_.device) fill_cuda(row, spheres, work);
    } else {
      fill_cpu(row, spheres, work);
      if (!is_vdw_table(row.table)) fill_program(row, atoms, kFunctions[column].theirs);
    }
  }

  // The first use of a device takes longer. A run before the first row keeps that out of all rows.
  void fill_cuda(ThesisBenchRow& row, const SphereSet& spheres, const Work& work) {
    if (!std::exchange(cuda_is_warm_, true)) time_ours(spheres, work, Backend::cuda, 1);
    const Timed timed = time_ours(spheres, work, Backend::cuda, options_.repeats);
    row.triangles = timed.triangles;
    row.seconds.all = timed.seconds;
    row.seconds.kernels = timed.kernels;
  }

  // Tables 4.1 and 4.2 differ in the thesis's program alone: ours is timed once for both.
  void fill_cpu(ThesisBenchRow& row, const SphereSet& spheres, const Work& work) {
    const std::string key = row.structure->id + row.column;
    auto found = ours_.find(key);
    if (found == ours_.end()) {
      const Timed all = time_ours(spheres, work, Backend::cpu, options_.repeats);
      const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
      const Timed single = time_ours(spheres, work, Backend::cpu, options_.repeats);
      found = ours_.emplace(key, std::pair(all, single)).first;
    }
    row.triangles = found->second.first.triangles;
    row.seconds.all = found->second.first.seconds;
    row.seconds.one_thread = found->second.second.seconds;
  }

  void fill_program(ThesisBenchRow& row, const std::vector<Vec3d>& atoms, ThesisFunction function) {
    const SharedVertices shared =
        row.table == "4.1" ? SharedVertices::recomputed : SharedVertices::hash_table;
    const Timed timed = time_program(atoms, function, shared, options_.repeats);
    row.program_triangles = timed.triangles;
    row.seconds.program = timed.seconds;
  }

  const std::vector<Vec3d>& atoms_of(const ThesisStructure& structure) {
    const auto [entry, is_new] = atoms_.try_emplace(structure.id);
    if (is_new) entry->second = read_atoms(structure.path);
    return entry->second;
  }

  const ThesisBenchOptions& options_;
  ThesisBench bench_;
  std::vector<std::size_t> columns_;  // of each row
  std::map<std::string, std::vector<Vec3d>> atoms_;
  std::map<std::string, std::pair<Timed, Timed>> ours_;  // all threads, one thread
  bool cuda_is_warm_ = false;
};

bool is_original(const ThesisBenchRow& row) {
  return row.structure && row.structure->kind == ThesisStructure::Kind::original;
}

}  // namespace

std::optional<double> seconds_ratio(const ThesisBenchRow& row) {
  if (!is_original(row) || !row.seconds.all) return std::nullopt;
  return row.thesis.seconds / *row.seconds.all;
}

std::optional<double> triangles_ratio(const ThesisBenchRow& row) {
  if (!is_original(row) || !row.triangles) return std::nullopt;
  return static_cast<double>(*row.triangles) / static_cast<double>(row.thesis.triangles);
}

std::optional<double> per_triangle_ratio(const ThesisBenchRow& row) {
  if (!row.seconds.all || !row.triangles) return std::nullopt;
  const double theirs = row.thesis.seconds / static_cast<double>(row.thesis.triangles);
  return theirs / (*row.seconds.all / static_cast<double>(*row.triangles));
}

ThesisBench rerun_thesis(
    const ThesisBenchOptions& options,
    const std::function<void(std::size_t, std::size_t, const ThesisBenchRow&)>& on_row) {
  Bench bench(options);
  bench.plan();
  return std::move(bench).run(on_row);
}

}  // namespace vdwmesh::apps
