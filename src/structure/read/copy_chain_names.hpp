// What the chains of an assembly's copies are called. Internal header of this folder.
#pragma once

#include <gemmi/model.hpp>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "structure/cif/operator_expression.hpp"

namespace vdwmesh {

// Names the chains of an assembly: A1, A2, ... are the copies of chain A, numbered in the order in
// which of() is first called for their combinations of operators. The same chain and combination
// always get the same name, even if several parts of the recipe hold pieces of that chain.
class CopyChainNames {
 public:
  const std::string& of(const gemmi::Chain& chain, const OperatorCombination& combination) {
    std::string& name = names_[{chain.name, combination}];
    if (name.empty()) name = unused(chain.name);
    return name;
  }

 private:
  // The next name that is free. A name may be taken already, because chain ids may end in digits:
  // copy 1 of chain A1 and copy 11 of chain A would both be A11.
  std::string unused(const std::string& chain) {
    for (int& count = counts_[chain];;) {
      std::string name = chain + std::to_string(++count);
      if (used_.insert(name).second) return name;
    }
  }

  std::map<std::pair<std::string, OperatorCombination>, std::string> names_;
  std::map<std::string, int> counts_;  // chain -> the number that was tried last
  std::set<std::string> used_;         // all names in names_
};

}  // namespace vdwmesh
