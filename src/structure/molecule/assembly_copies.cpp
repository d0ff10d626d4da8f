// A part of a recipe copies some chains by some products of operators, in every model of the file
// alike.
#include "structure/molecule/assembly_copies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <gemmi/model.hpp>
#include <span>

#include "core/errors.hpp"
#include "structure/read/copy_chain_names.hpp"

namespace vdwmesh {
namespace {

constexpr double kMostAtoms = 4294967294;  // 2^32 - 2, the most spheres that a SphereSet holds

// Whether the part of the recipe copies the chain of this site. The recipe names chains by author
// id or, from mmCIF, by label_asym_id, which gemmi keeps in Residue::subchain.
bool copies_chain_of(const ChainCopies& part, const ParsedFile& file, const Site& site) {
  const bool by_author = file.assemblies.chain_names == AssemblyTables::ChainNames::author;
  return part.chains.contains(by_author ? site.place->chain->name : site.place->residue->subchain);
}

// The runs of sites that the part copies. The sites of a run follow each other and are of one
// chain.
std::vector<std::span<const Site>> runs_of(const ChainCopies& part, const ParsedFile& file,
                                           std::span<const Site> sites) {
  std::vector<std::span<const Site>> runs;
  auto first = sites.begin();
  while (first != sites.end()) {
    const auto begin = first;
    const bool is_copied = copies_chain_of(part, file, *begin);
    do {
      ++first;
    } while (first != sites.end() && first->place->chain == begin->place->chain &&
             copies_chain_of(part, file, *first) == is_copied);
    if (is_copied) runs.emplace_back(begin, first);
  }
  return runs;
}

// Adds the copies of one part, for the sites of one model. Indices count from `begin`.
void add_copies(const ChainCopies& part, const ParsedFile& file, std::span<const Site> model,
                const Site* begin, CopyChainNames& names, std::vector<ChainCopy>& copies) {
  const std::vector<std::span<const Site>> runs = runs_of(part, file, model);
  // A part without atoms has no share in the number of atoms, so refuse_if_too_many() has not
  // bounded its combinations. There may be more than 2^64 of them.
  if (runs.empty()) return;
  for (const OperatorProduct& product : part.products)
    for_each_combination(product, [&](const OperatorCombination& combination) {
      const AffineMap map = map_of(file.assemblies, combination);
      const std::string operators = name_of(file.assemblies, combination);
      for (const std::span<const Site> run : runs)
        copies.push_back({static_cast<std::uint64_t>(run.data() - begin), run.size(), map,
                          names.of(*run.front().place->chain, combination), operators});
    });
}

}  // namespace

AssemblyRecipe recipe_of(const ParsedFile& file, const std::string& assembly) {
  const std::vector<std::string> names = assembly_names(file.assemblies);
  if (std::ranges::find(names, assembly) != names.end())
    return make_recipe(file.assemblies, assembly, file.path);
  constexpr std::size_t kMostListed = 20;
  std::string known;
  for (std::size_t i = 0; i < std::min(names.size(), kMostListed); ++i) known += " " + names[i];
  if (names.size() > kMostListed) known += fmt::format(" and {} more", names.size() - kMostListed);
  throw InvalidInput(fmt::format("{}: has no assembly {}; there is asymmetric{}{}", file.path,
                                 assembly, known.empty() ? " only" : " and", known));
}

double count_copies(const AssemblyRecipe& recipe, const ParsedFile& file, const Sites& sites,
                    std::vector<bool>& used) {
  double total = 0;
  for (const ChainCopies& part : recipe.parts) {
    double held = 0;
    for (const Site& site : sites) {
      if (!copies_chain_of(part, file, site)) continue;
      used[index_in(file, site)] = true;
      ++held;
    }
    total += held * static_cast<double>(combination_count(part.products));
  }
  return total;
}

void refuse_if_too_many(double atoms, const std::string& path, const ReadOptions& options) {
  const double bytes = atoms * static_cast<double>(sizeof(Atom));
  const double allowed = static_cast<double>(options.memory_limit);
  if (bytes <= allowed && atoms <= kMostAtoms) return;
  throw LimitExceeded(fmt::format(
      "{}: assembly {} has {:.0f} atoms, which take {:.3g} GiB of memory; {:.3g} GiB and {:.0f} "
      "atoms are allowed: choose a part of the atoms, or allow more memory",
      path, options.assembly, atoms, bytes / 0x1p30, allowed / 0x1p30, kMostAtoms));
}

std::vector<ChainCopy> list_copies(const AssemblyRecipe& recipe, const ParsedFile& file,
                                   const Sites& sites) {
  std::vector<ChainCopy> copies;
  for (auto first = sites.begin(); first != sites.end();) {
    const auto last = std::find_if(first, sites.end(), [first](const Site& site) {
      return site.place->model != first->place->model;
    });
    CopyChainNames names;  // each model begins with A1 again
    for (const ChainCopies& part : recipe.parts)
      add_copies(part, file, {first, last}, sites.data(), names, copies);
    first = last;
  }
  return copies;
}

}  // namespace vdwmesh
