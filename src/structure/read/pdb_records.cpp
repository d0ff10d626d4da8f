// Recognises records by their names, and numbers models. A model opens with its first atom, not
// with its MODEL record, because files have empty models and models without any MODEL record.
#include "structure/read/pdb_records.hpp"

#include <algorithm>

#include "core/letters.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {

bool starts_with_record(std::string_view line, std::string_view name) {
  return line.size() >= name.size() &&
         std::equal(name.begin(), name.end(), line.begin(),
                    [](char a, char b) { return a == upper_case(b); });
}

bool is_record(std::string_view line, std::string_view name) {
  if (!starts_with_record(line, name)) return false;
  if (line.size() == name.size()) return true;
  const char next = line[name.size()];
  return next == ' ' || next == '\t' || is_digit(next);
}

bool is_atom_record(std::string_view line) {
  return starts_with_record(line, "HETATM") || is_record(line, "ATOM");
}

bool ModelRecords::take(std::string_view line) {
  const bool begins = is_record(line, "MODEL");
  if (!begins && !is_record(line, "ENDMDL") && !is_record(line, "END")) return false;
  open_ = false;
  const auto number = begins ? whole_number(line.substr(5)) : std::nullopt;
  announced_ = number ? std::to_string(*number) : "";
  return true;
}

bool ModelRecords::begins_model() {
  if (open_) return false;
  open_ = true;
  names_.push_back(unused_name());
  taken_.insert(names_.back());
  return true;
}

// The number in the MODEL record if no earlier model has it. Otherwise the number of models so far
// plus one, or the next free number above it. next_ never decreases, so naming n models takes O(n)
// look-ups in total even if every number is missing.
std::string ModelRecords::unused_name() {
  if (!announced_.empty() && taken_.count(announced_) == 0) return announced_;
  next_ = std::max(next_, names_.size() + 1);
  while (taken_.count(std::to_string(next_)) != 0) ++next_;
  return std::to_string(next_);
}

}  // namespace vdwmesh
