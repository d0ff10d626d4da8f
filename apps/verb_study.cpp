#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "machine.hpp"
#include "output.hpp"
#include "printable.hpp"
#include "study/progress.hpp"
#include "study/study_flags.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

constexpr const char *kTable = "study.csv", *kDocument = "study.json", *kPage = "index.html";

std::uint64_t count_refused(const Study& study) {
  std::uint64_t count = 0;
  for (const StudyFindings& f : study.findings) count += f.refused.size();
  return count;
}

std::vector<std::string> warnings_of(const Study& study) {
  std::vector<std::string> all;
  for (const StudyFindings& f : study.findings) {
    for (const std::string& warning : f.input.warnings) {
      all.push_back(fmt::format("{}: {}", f.input.name, warning));
    }
  }
  return all;
}

class StudyVerb : public Verb {
 public:
  std::string name() const override { return "study"; }
  std::string summary() const override {
    return "sweep of spacings x subdivisions x fields: CSV, JSON and a page with plots";
  }

  void add_options(CLI::App& app) override {
    input_.add_to(app, InputFlags::Inputs::several);
    study_.add_to(app);
  }

  void run() const override {
    const StudyOptions options = study_.resolve();
    NamedFiles files;
    for (const char* name : {kTable, kDocument, kPage}) {
      files.add_output_in("-o", options.folder, name);
    }
    const std::vector<InputOptions> inputs = input_.resolve_all(files);
    MachineOptions threads_only = options.machine;
    threads_only.progress = Progress::never;  // a study has a line of its own
    const Machine machine(threads_only);
    const Study study = make_study(inputs, options);
    std::vector<std::string> warnings = warnings_of(study);
    write_file(options.folder / kTable, study_csv(study));
    write_file(options.folder / kDocument, study_json(study));
    write_file(options.folder / kPage, study_html(study, warnings));
    print_warnings(warnings);
    if (options.machine.verbosity == Verbosity::quiet) return;
    const std::uint64_t refused = count_refused(study);
    write_standard_output(fmt::format(
        "{} runs made, {} found finished{}{}; {}; see {}\n", study.runs_made, study.runs_found,
        refused > 0 ? fmt::format(", {} refused (study.json says why)", refused) : "",
        study.runs_left > 0 ? fmt::format(", {} left for the next call", study.runs_left) : "",
        duration_text(study.seconds), printable((options.folder / kPage).string())));
  }

 private:
  InputFlags input_;
  StudyFlags study_;
};

}  // namespace

std::unique_ptr<Verb> make_study_verb() { return std::make_unique<StudyVerb>(); }

}  // namespace vdwmesh::apps
