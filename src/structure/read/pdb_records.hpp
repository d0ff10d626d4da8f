// What the parsers of PDB and PQR files share: the names of records, and the records that separate
// models. Names match in capitals and in small letters. Internal header of this folder.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace vdwmesh {

// Whether the line begins with `name`, whatever follows. `name` must be in capitals.
bool starts_with_record(std::string_view line, std::string_view name);

// Whether the record is called `name` and nothing longer: "END" does not match "ENDMDL", and
// "MODEL" does not match "MODELLED". A digit may follow without a blank ("ATOM100000").
bool is_record(std::string_view line, std::string_view name);

// Whether the record is ATOM or HETATM. The serial number may follow without a blank.
bool is_atom_record(std::string_view line);

// Divides the atoms of a file into models. Pass each line to take() or, if it is an atom record,
// call begins_model(). A model begins with the first atom after a MODEL, ENDMDL or END record, or
// with the first atom of the file. This rule reads all that occurs in real files: models without
// ENDMDL, trajectory frames that end with END, atoms before the first MODEL. Models without atoms
// do not count. A model without a number, or with a number that another model has, gets a free one.
class ModelRecords {
 public:
  // Returns true if the line is a MODEL, ENDMDL or END record; the current model ends then.
  bool take(std::string_view line);

  // Call this once for every atom. Returns true if the atom is the first of a model; the model then
  // begins, and its name is appended to names().
  bool begins_model();

  // The names of the models begun so far, in the order of the file. No two are the same.
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::string unused_name();

  bool open_ = false;      // the current model has an atom
  std::string announced_;  // number in the last MODEL record; empty if it has none
  std::vector<std::string> names_;
  std::set<std::string> taken_;  // the same names, for searching
  std::size_t next_ = 1;         // the search for a free number starts here; it never decreases
};

}  // namespace vdwmesh
