#include <CLI/CLI.hpp>
#include <vector>

#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

// A verb of verbs: each table is one.
class BenchVerb : public Verb {
 public:
  BenchVerb() {
    tables_.push_back(make_thesis_bench_verb());
    tables_.push_back(make_pipeline_bench_verb());
  }
  std::string name() const override { return "bench"; }
  std::string summary() const override { return "the timing tables: bench thesis, bench pipeline"; }

  void add_options(CLI::App& app) override {
    app_ = &app;
    for (const auto& table : tables_) {
      table->add_options(*app.add_subcommand(table->name(), table->summary()));
    }
  }

  void run() const override {
    for (const auto& table : tables_) {
      if (app_->got_subcommand(table->name())) return table->run();
    }
    throw InvalidInput("bench: name the table, thesis or pipeline");
  }

 private:
  std::vector<std::unique_ptr<Verb>> tables_;
  const CLI::App* app_ = nullptr;
};

}  // namespace

std::unique_ptr<Verb> make_bench_verb() { return std::make_unique<BenchVerb>(); }

}  // namespace vdwmesh::apps
