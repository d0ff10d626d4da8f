// What the readers of mmCIF, of CIF files of small molecules and of BinaryCIF share beside
// atom_site.hpp. Internal header of this folder.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "structure/read/parsed_file.hpp"

namespace vdwmesh {

// Reads the atoms of a small molecule: a file with fractional coordinates, or one that describes a
// chemical component.
void read_small_molecule(std::string_view text, ParsedFile& file);

// The message about a file with atoms in two data blocks, which have these names.
std::string two_blocks_with_atoms(std::string_view first, std::string_view second);

// Makes a ParsedFile with that path and an empty structure, and calls `read` to fill it. Turns the
// exceptions of gemmi, which are of the standard library, into FileFormatErrors of one line.
ParsedFile parse_with_gemmi(const std::string& path, const std::function<void(ParsedFile&)>& read);

}  // namespace vdwmesh
