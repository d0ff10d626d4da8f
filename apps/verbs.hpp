// The verbs of the program. Each adds itself to the command line and runs when it was chosen.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "steps.hpp"

namespace vdwmesh::apps {

class Verb {
 public:
  virtual ~Verb() = default;
  virtual std::string name() const = 0;
  virtual std::string summary() const = 0;
  virtual void add_options(CLI::App& app) = 0;
  // Checks the options, then works. Throws the exceptions of core/errors.hpp.
  virtual void run() const = 0;
};

std::unique_ptr<Verb> make_mesh_verb();
std::unique_ptr<Verb> make_report_verb();
std::unique_ptr<Verb> make_exact_verb();
std::unique_ptr<Verb> make_compare_verb();
std::unique_ptr<Verb> make_render_verb();
std::unique_ptr<Verb> make_study_verb();
std::unique_ptr<Verb> make_bench_verb();
std::unique_ptr<Verb> make_info_verb();

// Of `vdwmesh bench`.
std::unique_ptr<Verb> make_thesis_bench_verb();
std::unique_ptr<Verb> make_pipeline_bench_verb();

}  // namespace vdwmesh::apps
