// REMARK 350 of PDB files: which chains a biomolecule holds, and moved by which matrices. Inside
// the room only.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "structure/assembly.hpp"

namespace vdwmesh {

class BiomoleculeReader {
 public:
  // Takes the next record of REMARK 350, which is line `number` of the file.
  void take(std::string_view record, std::uint32_t number);

  // Call once, after the last record.
  AssemblyTables finish();

 private:
  void take_names(std::string_view list);
  void take_chains(std::string_view list, bool first, std::uint32_t number);
  void take_matrix_row(std::string_view record, std::uint32_t number);
  void close_operator();
  void close_group();

  AssemblyTables tables_;
  std::vector<std::string> names_;  // of the biomolecules that are being described
  AssemblyRow group_;               // of chains; complete once its operators are known
  SymmetryOperator operator_;
  std::size_t matrix_rows_ = 0;  // how many of operator_ were read
};

}  // namespace vdwmesh
