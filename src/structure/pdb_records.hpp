// Names of records, and the records that part models, as PDB and PQR files share them. Inside the
// room only.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace vdwmesh {

// Whether the line begins with `name`, which is given in capitals, whatever follows.
bool starts_with_record(std::string_view line, std::string_view name);

// Whether the record is called `name` and nothing longer: "END" but not "ENDMDL", "MODEL" but not
// "MODELLED". A digit may follow at once.
bool is_record(std::string_view line, std::string_view name);

// ATOM and HETATM, also with a serial number that touches them.
bool is_atom_record(std::string_view line);

// Which atoms make up a model, however a file marks it: models without ENDMDL, frames ended by END,
// atoms before the first MODEL, models without atoms, which do not count, and numbers that are
// missing or repeated. A model whose number is taken gets the next that is free.
class ModelRecords {
 public:
  // Whether the line is a record that parts models: MODEL, ENDMDL or END.
  bool take(std::string_view line);

  // To be called for every atom: whether it is the first of a model.
  bool begins_model();

  // Of the models begun so far, in the order of the file; no two are the same.
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::string unused_name();

  bool open_ = false;
  std::string announced_;  // by the last MODEL record
  std::vector<std::string> names_;
  std::set<std::string> taken_;
  std::size_t next_ = 1;  // numbers below are not tried again, so that naming all takes linear time
};

}  // namespace vdwmesh
