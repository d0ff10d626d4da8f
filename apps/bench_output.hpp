// Where the tables of a benchmark go: text, CSV, JSON.
#pragma once

#include <functional>
#include <string>

#include "options.hpp"

namespace vdwmesh::apps {

struct BenchTexts {
  std::function<std::string()> text, csv, json;  // made where they are asked for
};

class BenchOutputFlags {
 public:
  void add_to(CLI::App& verb);
  // Checks that the files can be made.
  void check() const;
  // Text goes to standard output unless one of the others does.
  void deliver(const BenchTexts& texts, Verbosity verbosity) const;

 private:
  std::string csv_;
  OutputFlags output_;
};

}  // namespace vdwmesh::apps
