// The assemblies of an mmCIF file. Inside the room only.
#pragma once

#include "structure/assembly.hpp"

namespace gemmi::cif {
struct Block;
}

namespace vdwmesh {

// From the tables _pdbx_struct_assembly_gen and _pdbx_struct_oper_list, whatever other tables say
// or leave out. Takes these tables out of `block`, because gemmi would follow their expressions
// too.
AssemblyTables take_assembly_tables(gemmi::cif::Block& block);

}  // namespace vdwmesh
