// The choice of atoms by any text: the lines of the input are a selection, an alternate location,
// a model and an assembly. The molecule is small but has some of everything.
#include "fuzz/memory_file.hpp"
#include "fuzz/molecule_checks.hpp"
#include "structure/reader.hpp"

namespace vdwmesh::fuzz {
namespace {

constexpr std::string_view kMolecule =
    "REMARK 350 BIOMOLECULE: 1\n"
    "REMARK 350 APPLY THE FOLLOWING TO CHAINS: A, B\n"
    "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n"
    "REMARK 350   BIOMT1   2 -1.000000  0.000000  0.000000       10.00000\n"
    "REMARK 350   BIOMT2   2  0.000000 -1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000        0.00000\n"
    "MODEL        1\n"
    "ATOM      1  N   ALA A   1       0.000   0.000   0.000  1.00 10.00           N\n"
    "ATOM      2  CA AALA A   1       1.400   0.000   0.000  0.60 10.00           C\n"
    "ATOM      3  CA BALA A   1       1.500   0.300   0.000  0.40 10.00           C\n"
    "ATOM      4  HA  ALA A   1       1.800  -0.900   0.000  1.00 10.00           H\n"
    "ATOM      5  P    DA B  52A      6.000   0.000   0.000  1.00 10.00           P\n"
    "HETATM    6 ZN    ZN B 101       0.000   6.000   0.000  1.00 10.00          ZN\n"
    "HETATM    7  O   HOH B 201       6.000   6.000   0.000  1.00 10.00           O\n"
    "ENDMDL\n"
    "MODEL        2\n"
    "ATOM      1  N   ALA A   1       0.100   0.000   0.000  1.00 10.00           N\n"
    "ENDMDL\n"
    "END\n";

std::string take_line(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  const std::string line(rest.substr(0, end));
  rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
  return line;
}

}  // namespace

void run_input(const std::uint8_t* data, std::size_t size) {
  static const MemoryFile file(kMolecule);
  std::string_view rest = as_text(data, size);
  ReadOptions options;
  options.format = StructureFormat::pdb;
  options.waters = Inclusion::keep;
  options.select = take_line(rest);
  for (std::string* option : {&options.altloc, &options.model, &options.assembly}) {
    if (!rest.empty()) *option = take_line(rest);
  }
  allow_refusal([&] { check_molecule(read_structure(file.path(), options)); });
}

}  // namespace vdwmesh::fuzz
