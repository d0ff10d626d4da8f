// Parses a selection with gemmi and asks it about model, chain, residue and atom of a site. A site
// is selected if all four are.
#include "structure/site_selection.hpp"

#include <fmt/format.h>

#include <exception>
#include <gemmi/polyheur.hpp>
#include <gemmi/select.hpp>

#include "core/errors.hpp"
#include "structure/hierarchy.hpp"
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

SiteSelection::SiteSelection(const std::string& text, ParsedFile& file) {
  try {
    selection_ = std::make_unique<gemmi::Selection>(text);
  } catch (const std::exception& error) {
    throw InvalidInput(
        fmt::format("selection {} is not understood ({}); for example A/10-40/CA or /1/A,B",
                    in_quotes(text), one_line(error.what())));
  }
  end_single_residue(*selection_, text);
  if (selection_->entity_types.all) return;
  give_gemmi_atoms(file);
  gemmi::setup_entities(*file.structure);
}

SiteSelection::~SiteSelection() = default;

bool SiteSelection::contains(const Site& site) const {
  if (!selection_->matches(*site.place->model) || !selection_->matches(*site.place->chain) ||
      !selection_->matches(*site.place->residue))
    return false;
  gemmi::Atom atom;
  copy_to_gemmi(*site.atom, atom);
  return selection_->matches(atom);
}

}  // namespace vdwmesh
