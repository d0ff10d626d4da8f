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
namespace {

// Early versions of gemmi (0.5.7 for one) read "A/10" like "A/10-", as residue 10 and all that
// follow. A minus before the conditions, which follow a semicolon, always means a range.
void end_single_residue(gemmi::Selection& selection, const std::string& text) {
  const bool is_range = text.substr(0, text.find(';')).find('-') != std::string::npos;
  if (!is_range && !selection.from_seqid.empty()) selection.to_seqid = selection.from_seqid;
}

}  // namespace

SiteSelection::SiteSelection(const std::string& text, gemmi::Structure& structure) {
  try {
    selection_ = std::make_unique<gemmi::Selection>(text);
  } catch (const std::exception& error) {
    throw InvalidInput(
        fmt::format("selection {} is not understood ({}); for example A/10-40/CA or /1/A,B",
                    in_quotes(text), one_line(error.what())));
  }
  end_single_residue(*selection_, text);
  if (!selection_->entity_types.all) gemmi::setup_entities(structure);
}

SiteSelection::~SiteSelection() = default;

bool SiteSelection::contains(const Site& site) const {
  return selection_->matches(*site.model) && selection_->matches(*site.chain) &&
         selection_->matches(*site.residue) && selection_->matches(*site.atom);
}

}  // namespace vdwmesh
