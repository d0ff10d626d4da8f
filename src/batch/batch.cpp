// run_batch(): reads, measures and describes structures, as rows in order (ordered_rows.hpp). Each
// worker keeps the memory of the measures from one structure to the next. Whatever goes wrong with
// one structure is the error of its row.
#include "batch/batch.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <new>
#include <numeric>
#include <utility>

#include "batch/molecule_spheres.hpp"
#include "batch/ordered_rows.hpp"
#include "core/errors.hpp"
#include "core/fnv.hpp"
#include "core/workspace.hpp"

namespace vdwmesh {
namespace {

// Of one worker.
struct WorkerSpace {
  Workspace workspace;
  ExactUnion measured;
};

void measure(const NamedStructure& structure, const BatchOptions& options, WorkerSpace& space,
             BatchRow& row) {
  const Molecule molecule = read_named_structure(structure, options.read);
  describe_input(molecule, row);
  const SphereSet spheres = to_spheres(molecule, options.probe);
  if (options.check) options.check(spheres);
  const auto chosen = measured_spheres(molecule);
  UnionOptions wanted;
  wanted.method = options.method;
  wanted.topology = options.topology;
  wanted.workspace = &space.workspace;
  if (chosen) wanted.measured = *chosen;
  exact_union_into(space.measured, spheres, wanted);
  describe_union(space.measured, row);
}

// An error leaves no measures behind.
BatchRow row_of(const NamedStructure& structure, const BatchOptions& options, WorkerSpace& space) {
  BatchRow row;
  row.name = structure.name;
  row.content = content_of(structure);
  row.error = refusal_of([&] { measure(structure, options, space, row); });
  if (row.error) space.workspace.clear();  // may be half filled
  return row;
}

std::size_t workers_for(const BatchOptions& options) {
  if (options.threads > 0) return static_cast<std::size_t>(options.threads);
  return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

}  // namespace

std::optional<std::string> content_of(const NamedStructure& structure) {
  if (!structure.fault.empty()) return std::nullopt;
  // What a pipe gives can be read once only.
  std::error_code error;
  if (!structure.bytes && !std::filesystem::is_regular_file(structure.name, error))
    return std::nullopt;
  std::uint64_t hash = fnv1a(structure.bytes ? *structure.bytes : std::string());
  if (!structure.bytes) {
    std::ifstream file(structure.name, std::ios::binary);
    std::vector<char> part(std::size_t{1} << 16);
    do {
      file.read(part.data(), static_cast<std::streamsize>(part.size()));
      hash = fnv1a({part.data(), static_cast<std::size_t>(file.gcount())}, hash);
    } while (file);
    if (!file.eof()) return std::nullopt;
  }
  return fmt::format("{:016x}", hash);
}

Molecule read_named_structure(const NamedStructure& structure, const ReadOptions& options) {
  if (!structure.fault.empty()) throw FileFormatError(structure.fault);
  if (structure.bytes) return read_structure(structure.name, *structure.bytes, options);
  return read_structure(structure.name, options);
}

void describe_input(const Molecule& molecule, BatchRow& row) {
  row.atoms = molecule.atoms.size();
  row.left_out = molecule.skipped;
  row.guessed_elements = molecule.elements_guessed;
  row.warnings = molecule.warnings;
  row.assumed_radii = 0;
  for (const AssumedRadius& radius : molecule.radii_assumed) *row.assumed_radii += radius.count;
}

void describe_union(const ExactUnion& measured, BatchRow& row) {
  row.method = measured.method;
  row.area = measured.area;
  row.volume = measured.volume;
  if (measured.counts) {
    row.components = measured.counts->components;
    row.euler_characteristic = measured.counts->euler_characteristic;
  }
  if (measured.topology) {
    row.components = measured.topology->components;
    row.tunnels = measured.topology->tunnels;
    row.voids = measured.topology->voids;
    row.euler_characteristic = measured.topology->euler_characteristic;
  }
  row.fallback_spheres = measured.fallback_spheres;
  row.doubtful_spheres = measured.doubtful_spheres;
}

std::optional<std::string> refusal_of(const std::function<void()>& work) {
  try {
    work();
    return std::nullopt;
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    return error.what();
  } catch (const std::bad_alloc&) {
    return "out of memory";
  } catch (const std::exception& error) {
    return fmt::format("internal error: {}", error.what());
  }
}

BatchPart part_of(std::uint64_t part, std::uint64_t parts, std::uint64_t structures) {
  const auto begin = [&](std::uint64_t p) {
    return structures / parts * p + std::min(p, structures % parts);
  };
  return {begin(part), begin(part + 1) - begin(part)};
}

BatchRow measure_structure(const NamedStructure& structure, const BatchOptions& options) {
  WorkerSpace space;
  return row_of(structure, options, space);
}

std::uint64_t run_batch(StructureSource& source, std::uint64_t most, const BatchOptions& options,
                        const std::function<void(const BatchRow&)>& on_row) {
  tbb::enumerable_thread_specific<WorkerSpace> spaces;
  return make_rows<BatchRow>(
      source, most, workers_for(options), options.monitor,
      [&](const NamedStructure& structure) { return row_of(structure, options, spaces.local()); },
      on_row);
}

}  // namespace vdwmesh
