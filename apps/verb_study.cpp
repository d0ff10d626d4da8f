#include <fmt/format.h>

#include "output.hpp"
#include "study/progress.hpp"
#include "study/study_flags.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

std::uint64_t count_refused(const Study& study) {
  std::uint64_t count = 0;
  for (const StudyFindings& f : study.findings) count += f.refused.size();
  return count;
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
    const Study study = make_study(input_.resolve_all(), options);
    write_file(options.folder / "study.csv", study_csv(study));
    write_file(options.folder / "study.json", study_json(study));
    write_file(options.folder / "index.html", study_html(study));
    if (options.machine.verbosity == Verbosity::quiet) return;
    const std::uint64_t refused = count_refused(study);
    write_standard_output(fmt::format(
        "{} runs made, {} found finished{}{}; {}; see {}\n", study.runs_made, study.runs_found,
        refused > 0 ? fmt::format(", {} refused (study.json says why)", refused) : "",
        study.runs_left > 0 ? fmt::format(", {} left for the next call", study.runs_left) : "",
        duration_text(study.seconds), (options.folder / "index.html").string()));
  }

 private:
  InputFlags input_;
  StudyFlags study_;
};

}  // namespace

std::unique_ptr<Verb> make_study_verb() { return std::make_unique<StudyVerb>(); }

}  // namespace vdwmesh::apps
