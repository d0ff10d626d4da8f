// A selection of atoms, in gemmi's syntax ("A/10-40/CA") or in words ("chain A and name CA";
// word_selection.hpp), applied to the sites of a file. Internal header of this folder.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "structure/molecule/site.hpp"
#include "structure/molecule/word_selection.hpp"
#include "structure/read/parsed_file.hpp"

namespace gemmi {
struct Selection;
}

namespace vdwmesh {

class SiteSelection {
 public:
  // A single number stands for one residue ("A/10", "A/-3"), "A/10-" for it and all that follow,
  // and "A/*-10" for it and all before, as "A/-10" does in a file without negative numbers, of
  // which file.warnings tells. The condition "A;segment=P1,P2" is one of this program; a chain
  // without an id goes by the id of its segment too. Throws InvalidInput, with examples, for a text
  // that is no selection. Selections by entity type ("polymer") make gemmi derive these types in
  // file.structure, for which it needs residues with their atoms.
  SiteSelection(const std::string& text, ParsedFile& file);
  ~SiteSelection();

  bool contains(const Site& site) const;

 private:
  std::string read_names(std::string_view text, ParsedFile& file, gemmi::Selection& names);
  bool contains_chain(const Site& site) const;

  SiteTest words_;  // empty for gemmi's syntax
  std::unique_ptr<gemmi::Selection> selection_;
  std::string segments_ = "*";  // a list of ids
};

}  // namespace vdwmesh
