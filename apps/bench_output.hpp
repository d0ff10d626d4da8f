// Where the tables of a benchmark go: text, CSV, JSON.
#pragma once

#include <functional>
#include <string>

#include "options.hpp"

namespace vdwmesh::apps {

struct BenchTexts {
  std::function<std::string()> text, csv, json;  // made where they are asked for
};

struct BenchOutputs {
  std::string csv, json;  // empty: none; "-": standard output
};

class BenchOutputFlags {
 public:
  void add_to(CLI::App& verb);
  // Checks that the files can be made.
  BenchOutputs resolve(NamedFiles& files) const;

 private:
  std::string csv_;
  OutputFlags output_;
};

// Text goes to standard output unless one of the others does.
void deliver(const BenchOutputs& outputs, const BenchTexts& texts, Verbosity verbosity);

}  // namespace vdwmesh::apps
