// Parses a selection with gemmi and asks it about model, chain, residue and atom of a site. A site
// is selected if all four are.
#include "structure/site_selection.hpp"

#include <fmt/format.h>

#include <exception>
#include <gemmi/polyheur.hpp>
#include <gemmi/select.hpp>

#include "core/errors.hpp"
#include "structure/lines.hpp"

namespace vdwmesh {

SiteSelection::SiteSelection(const std::string& text, gemmi::Structure& structure) {
  try {
    selection_ = std::make_unique<gemmi::Selection>(text);
  } catch (const std::exception& error) {
    throw InvalidInput(
        fmt::format("selection {} is not understood ({}); for example A/10-40/CA or /1/A,B",
                    in_quotes(text), one_line(error.what())));
  }
  if (!selection_->entity_types.all) gemmi::setup_entities(structure);
}

SiteSelection::~SiteSelection() = default;

bool SiteSelection::contains(const Site& site) const {
  return selection_->matches(*site.model) && selection_->matches(*site.chain) &&
         selection_->matches(*site.residue) && selection_->matches(*site.atom);
}

}  // namespace vdwmesh
