// Reads REMARK 350 of PDB files, which describes the biological assemblies ("biomolecules"): which
// chains an assembly holds, and which matrices move them. Internal header of this folder.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "structure/read/assembly.hpp"

namespace vdwmesh {

// Collects the records of REMARK 350 one by one into assembly tables. Broken records throw nothing:
// the fault is noted with the operator, and make_recipe() reports it if the assembly is asked for.
class BiomoleculeReader {
 public:
  // Reads the next record of REMARK 350. `number` is its line in the file, from 1, for messages.
  void take(std::string_view record, std::uint32_t number);

  // Returns the tables. Call this once, after the last record.
  AssemblyTables finish();

 private:
  void take_names(std::string_view list);
  void take_chains(std::string_view list, bool first, std::uint32_t number);
  void take_matrix_row(std::string_view record, std::uint32_t number);
  void close_operator();
  void close_group();

  AssemblyTables tables_;
  std::vector<std::string> names_;  // the biomolecules that the current records describe
  AssemblyRow group_;               // the current chains, with the operators read so far
  SymmetryOperator operator_;       // the current matrix
  std::size_t matrix_rows_ = 0;     // rows read into operator_: at most 3 in a sound file
};

}  // namespace vdwmesh
