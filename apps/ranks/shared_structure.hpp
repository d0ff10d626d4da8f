// The structure, which one rank reads and all get. What travels is what the file says: its text if
// it lists spheres, and of an assembly the atoms of the file and the maps that copy them. The ranks
// of each host make the spheres of it together, once for the host.
#pragma once

#include <cstdint>
#include <vector>

#include "distributed/host_memory.hpp"
#include "distributed/ranks.hpp"
#include "mesh/element_color.hpp"
#include "options.hpp"
#include "spheres/sphere_set.hpp"
#include "steps/session.hpp"
#include "structure/molecule.hpp"
#include "structure/read/assembly.hpp"

namespace vdwmesh::apps {

// An atom of the file, of which an assembly has copies.
struct UnitAtom {
  Vec3d position;  // Å
  double radius;   // Å, without the probe
  RgbColor color;
};

// A run of copies: sphere `begin` + i of the assembly is atom `first` + i, moved.
struct UnitCopy {
  std::uint64_t first, begin, count;
  AffineMap map;
};

// How the ranks have made the spheres, and so can make their colours.
enum class SphereOrigin : std::uint8_t {
  records,   // the first rank has made them of the records of all atoms
  lines,     // of lines of text, which name no elements
  assembly,  // copies of `atoms`
};

struct SharedStructure {
  // Empty but on the first rank. Has no atoms there unless the origin of the spheres is `records`.
  Molecule molecule;
  HostArray<Sphere> of_spheres;  // once on every host
  SphereSet spheres;             // all of them, a view
  SphereOrigin origin = SphereOrigin::records;
  HostArray<UnitAtom> atoms;     // of the file of an assembly, once on every host
  std::vector<UnitCopy> copies;  // of it, on all ranks
};

// Whether the first rank needs the records of all atoms, for names, serial numbers or groups.
enum class AtomRecords : std::uint8_t { needless, needed };

// Reads the structure on the first rank and gives its spheres to all. Throws as load() does, on all
// ranks. Collective.
SharedStructure load_together(const Ranks& ranks, const InputOptions& options, AtomRecords records,
                              Session& session);

// The colour of every sphere, on all ranks. Collective.
HostArray<RgbColor> share_colors(const Ranks& ranks, const SharedStructure& structure);

}  // namespace vdwmesh::apps
