// A tiny reader of what the reference code needs from structure files.
#pragma once

#include <filesystem>
#include <vector>

#include "reference/point.hpp"

namespace vdwmesh::reference {

// Positions of the ATOM records (not HETATM) of the first model, alternate locations and all, as
// the thesis used them. PDB columns 31-54, or the _atom_site loop of mmCIF (by the extension).
std::vector<Point> read_atom_records(const std::filesystem::path& path);

// "x y z r" per line.
std::vector<Ball> read_xyzr(const std::filesystem::path& path);

}  // namespace vdwmesh::reference
