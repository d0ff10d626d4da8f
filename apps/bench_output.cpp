#include "bench_output.hpp"

#include <CLI/CLI.hpp>

#include "output.hpp"

namespace vdwmesh::apps {

void BenchOutputFlags::add_to(CLI::App& verb) {
  verb.add_option("--csv", csv_, "CSV file (- is standard output)");
  output_.add_to(verb, OutputFlags::PerAtom::none);
}

BenchOutputs BenchOutputFlags::resolve(NamedFiles& files) const {
  files.add_output("--csv", csv_);
  return {csv_, output_.resolve(files).json};
}

void deliver(const BenchOutputs& outputs, const BenchTexts& texts, Verbosity verbosity) {
  if (!outputs.csv.empty()) write_output(outputs.csv, texts.csv());
  if (!outputs.json.empty()) write_output(outputs.json, texts.json());
  const bool taken = outputs.csv == "-" || outputs.json == "-" || verbosity == Verbosity::quiet;
  if (!taken) write_standard_output(texts.text());
}

}  // namespace vdwmesh::apps
