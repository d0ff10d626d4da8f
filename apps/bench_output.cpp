#include "bench_output.hpp"

#include "output.hpp"

namespace vdwmesh::apps {
namespace {

void deliver_to(const std::string& where, const std::function<std::string()>& make) {
  if (where.empty()) return;
  if (where == "-") return write_standard_output(make());
  write_file(where, make());
}

}  // namespace

void BenchOutputFlags::add_to(CLI::App& verb) {
  verb.add_option("--csv", csv_, "CSV file (- is standard output)");
  output_.add_to(verb, OutputFlags::PerAtom::none);
}

void BenchOutputFlags::check() const {
  (void)output_.resolve();
  if (!csv_.empty() && csv_ != "-") check_writable("--csv", csv_);
}

void BenchOutputFlags::deliver(const BenchTexts& texts, Verbosity verbosity) const {
  const std::string json = output_.resolve().json;
  deliver_to(csv_, texts.csv);
  deliver_to(json, texts.json);
  const bool taken = csv_ == "-" || json == "-" || verbosity == Verbosity::quiet;
  if (!taken) write_standard_output(texts.text());
}

}  // namespace vdwmesh::apps
