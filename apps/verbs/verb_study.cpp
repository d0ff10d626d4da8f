// `vdwmesh study`: a sweep over ways of making meshes, kept in a folder as a table, a document and
// a page. Runs that the folder holds already are not made again. The page comes last, because its
// meshes are made anew and may be left out.
#include <fmt/format.h>

#include "command_line/command_line.hpp"
#include "report/output.hpp"
#include "report/printable.hpp"
#include "steps/session.hpp"
#include "study/study.hpp"
#include "study/study_progress.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {
namespace {

std::uint64_t count_refused(const Study& study) {
  std::uint64_t count = 0;
  for (const StudyFindings& f : study.findings) count += f.refused.size();
  return count;
}

// With the name of the input, because a study has several.
std::vector<std::string> warnings_of(const Study& study) {
  std::vector<std::string> all;
  for (const StudyFindings& f : study.findings) {
    for (const std::string& warning : f.input.warnings) {
      all.push_back(fmt::format("{}: {}", f.input.name, warning));
    }
  }
  return all;
}

std::string summary_of(const Study& study) {
  const std::uint64_t refused = count_refused(study);
  return fmt::format(
      "{} runs made, {} found finished{}{}; {}; see {}\n", study.runs_made, study.runs_found,
      refused > 0 ? fmt::format(", {} refused (study.json says why)", refused) : "",
      study.runs_left > 0 ? fmt::format(", {} left for the next call", study.runs_left) : "",
      duration_text(study.seconds), printable((study.options.folder / kStudyPage).string()));
}

}  // namespace

void run_study(const Options& options) {
  MachineOptions threads_only = options.machine;
  threads_only.progress = Progress::never;  // a study has a line of its own
  const VerbSession session(threads_only);
  const std::filesystem::path& folder = options.study.folder;
  const Study study = make_study(options.inputs, options.study);
  std::vector<std::string> warnings = warnings_of(study);
  write_file(folder / kStudyTable, study_csv(study));
  write_file(folder / kStudyDocument, study_json(study));
  write_file(folder / kStudyPage, study_html(study, warnings));
  print_warnings(warnings);
  session.deliver_text(options.output, [&] { return summary_of(study); });
}

}  // namespace vdwmesh::apps
