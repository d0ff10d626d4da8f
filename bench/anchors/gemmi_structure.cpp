#include <gemmi/gz.hpp>
#include <gemmi/mmread.hpp>

#include "anchors/anchors.hpp"

namespace vdwmesh::anchors {

std::uint64_t gemmi_structure(const std::filesystem::path& path) {
  const gemmi::Structure structure = gemmi::read_structure(gemmi::MaybeGzipped(path.string()));
  std::uint64_t atoms = 0;
  for (const gemmi::Model& model : structure.models)
    for (const gemmi::Chain& chain : model.chains)
      for (const gemmi::Residue& residue : chain.residues) atoms += residue.atoms.size();
  return atoms;
}

}  // namespace vdwmesh::anchors
