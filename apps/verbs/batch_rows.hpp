// Rows of `vdwmesh batch` as text, and files of them that are continued.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "batch/batch.hpp"
#include "command_line/command_line.hpp"
#include "verbs/batch_pockets.hpp"
#include "verbs/batch_report.hpp"

namespace vdwmesh::apps {

// Writes rows of one kind. Each ends with a line break and holds no other.
class RowWriter {
 public:
  // The options say what rows are made of; settings_key() of them is part of each.
  explicit RowWriter(const Options& options);

  // The line before the first row; empty if there is none.
  std::string header() const;
  std::string text(const BatchRow& row) const;
  std::string text(const ExcludedRow& row) const;
  std::string text(const ReportRow& row) const;
  std::string text(const InterfaceRow& row) const;
  std::string text(const PocketsRow& row) const;
  // What text() begins with for a structure of that name, and with that content() behind it.
  std::string beginning(const std::string& name) const;
  std::string content(const std::optional<std::string>& content) const;
  // Whether a line of text() says that its structure was refused.
  bool is_refusal(std::string_view line) const;

 private:
  BatchVerb verb_;
  ExactSurface surface_;
  RowFormat format_;
  Switch fit_;  // whether rows of interfaces have shape complementarity
  std::string settings_;
};

// 16 digits that depend on everything that rows depend on beside the structures: the program, the
// choice of atoms, radii, with what a file of them holds, probe and method, and of rows of reports
// how the mesh is made.
std::string settings_key(const Options& options);

}  // namespace vdwmesh::apps
