// Exact measures of many structures: areas, volumes and topology, one row for each structure.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "batch/structure_source.hpp"
#include "measures/exact_union.hpp"
#include "structure/molecule.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {

class Monitor;

struct BatchOptions {
  ReadOptions read;
  double probe = 0;  // Å, added to every radius
  UnionMethod method = UnionMethod::automatic;
  TopologyRequest topology = TopologyRequest::none;
  int threads = 0;  // structures that are measured at the same time; 0: as many as TBB has threads
  // Called before a structure is measured, from any thread. What it throws refuses the structure.
  std::function<void(const SphereSet&)> check;
  Monitor* monitor = nullptr;  // hears of every row
};

// What is known of one structure. Members without a value were not computed.
struct BatchRow {
  std::string name;
  std::optional<std::string> content;  // content_of() the structure, from before it was read
  std::optional<std::uint64_t> atoms;  // that are measured, or cover those
  std::optional<std::map<std::string, std::uint64_t>> left_out;  // reason -> atoms of the file
  std::optional<std::uint64_t> assumed_radii;     // atoms, see Molecule::radii_assumed
  std::optional<std::uint64_t> guessed_elements;  // atoms
  std::optional<UnionMethod> method;
  std::optional<double> area, volume;  // Å², Å³
  std::optional<std::uint64_t> components, tunnels, voids;
  std::optional<std::int64_t> euler_characteristic;
  // Spheres that the arcs doubted, of which the triangulation gave the measures; and those of which
  // they leave the topology open, so that there are no counts.
  std::optional<std::uint64_t> fallback_spheres, doubtful_spheres;
  std::vector<std::string> warnings;  // what may be wrong with the file
  std::optional<std::string> error;   // why there are no measures; one line
};

// 16 digits that depend on the bytes of a structure, packed as they may be; nothing where they
// cannot be read.
std::optional<std::string> content_of(const NamedStructure& structure);

// Reads a structure of a source.
Molecule read_named_structure(const NamedStructure& structure, const ReadOptions& options);

// Write into the row what is known of the atoms, and what of the union of their balls.
void describe_input(const Molecule& molecule, BatchRow& row);
void describe_union(const ExactUnion& measured, BatchRow& row);

// Does the work on one structure. Returns the reason in one line if the structure is refused, which
// it is for whatever the work throws but Cancelled.
std::optional<std::string> refusal_of(const std::function<void()>& work);

// A run of structures, by their places in the inputs.
struct BatchPart {
  std::uint64_t first, count;
};

// Part `part`, from 0, of `parts` of so many structures. Parts follow each other and differ in
// length by one at most.
BatchPart part_of(std::uint64_t part, std::uint64_t parts, std::uint64_t structures);

// The row of one structure. A structure that is refused is a row with its error.
BatchRow measure_structure(const NamedStructure& structure, const BatchOptions& options);

// Measures the next structures of the source, up to `most`, and calls on_row() for each, in the
// order of the source, one at a time. Structures are measured side by side, each on one thread, and
// no more than a few for each thread are in memory. Returns the number of rows. Throws what the
// source and on_row() throw, after the rows before it, and Cancelled.
std::uint64_t run_batch(StructureSource& source, std::uint64_t most, const BatchOptions& options,
                        const std::function<void(const BatchRow&)>& on_row);

}  // namespace vdwmesh
