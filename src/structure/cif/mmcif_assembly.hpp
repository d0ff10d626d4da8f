// Reads the biological assemblies of an mmCIF file. Internal header of this folder.
#pragma once

#include "structure/read/assembly.hpp"

namespace gemmi::cif {
struct Block;
}

namespace vdwmesh {

// Reads the tables _pdbx_struct_assembly_gen (chains and operator expressions) and
// _pdbx_struct_oper_list (matrices). No other table is needed. Removes these tables and the other
// tables of assemblies from `block`: gemmi would expand their expressions too, by its own rules.
AssemblyTables take_assembly_tables(gemmi::cif::Block& block);

}  // namespace vdwmesh
