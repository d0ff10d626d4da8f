// Parses the command line, runs a verb and turns exceptions into exit codes.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "build_id.hpp"
#include "core/errors.hpp"
#include "interrupt.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

enum ExitCode : int {
  kDone = 0,
  kBadInput = 1,
  kNoBackend = 2,
  kLimitHit = 3,
  kOwnFault = 4,
  kSignalBase = 128
};

std::vector<std::unique_ptr<Verb>> make_verbs() {
  std::vector<std::unique_ptr<Verb>> verbs;
  verbs.push_back(make_mesh_verb());
  verbs.push_back(make_report_verb());
  verbs.push_back(make_exact_verb());
  verbs.push_back(make_compare_verb());
  verbs.push_back(make_render_verb());
  verbs.push_back(make_study_verb());
  verbs.push_back(make_bench_verb());
  verbs.push_back(make_info_verb());
  return verbs;
}

// One line on standard error, whatever the message quotes: Error sees to that.
int fail(ExitCode code, const Error& error) {
  std::fprintf(stderr, "vdwmesh: %s\n", error.what());
  return code;
}

template <class Work>
int exit_code_of(Work&& work) {
  try {
    return work();
  } catch (const Cancelled& error) {
    return fail(kOwnFault, error);
  } catch (const InvalidInput& error) {
    return fail(kBadInput, error);
  } catch (const FileFormatError& error) {
    return fail(kBadInput, error);
  } catch (const BackendUnavailable& error) {
    return fail(kNoBackend, error);
  } catch (const LimitExceeded& error) {
    return fail(kLimitHit, error);
  } catch (const std::bad_alloc&) {
    return fail(kLimitHit,
                LimitExceeded("out of memory; a larger --spacing or fewer --subdivide needs less"));
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(kBadInput, InvalidInput(fmt::format("{}: {}", error.path1().string(),
                                                    error.code().message())));
  } catch (const std::exception& error) {
    return fail(kOwnFault, Error(fmt::format("internal error: {}", error.what())));
  }
}

std::string no_verb_message(int argc, char** argv, const std::string& names) {
  const std::string_view given = argc > 1 ? argv[1] : "";
  return fmt::format("{}: {}; the verbs are{}; vdwmesh VERB --help says more",
                     given.empty() ? "VERB" : given, given.empty() ? "missing" : "not a verb",
                     names);
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("Van der Waals surface meshes of molecules, and proof of how good they are",
               "vdwmesh");
  app.set_version_flag("--version", fmt::format("vdwmesh {} ({})", kVersion, kRevision));
  app.require_subcommand(1);
  const std::vector<std::unique_ptr<Verb>> verbs = make_verbs();
  std::string names;
  for (const auto& verb : verbs) {
    verb->add_options(*app.add_subcommand(verb->name(), verb->summary()));
    names += ' ' + verb->name();
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return app.exit(version);
  } catch (const CLI::ParseError& error) {
    if (app.get_subcommands().empty()) {
      return fail(kBadInput, InvalidInput(no_verb_message(argc, argv, names)));
    }
    return fail(kBadInput,
                InvalidInput(fmt::format("{}; vdwmesh {} --help lists the options", error.what(),
                                         app.get_subcommands().front()->get_name())));
  }
  for (const auto& verb : verbs) {
    if (app.got_subcommand(verb->name())) verb->run();
  }
  return kDone;
}

}  // namespace
}  // namespace vdwmesh::apps

int main(int argc, char** argv) {
  using namespace vdwmesh::apps;
  install_signal_handlers();
  const int code = exit_code_of([&] { return parse_and_run(argc, argv); });
  const int signal = pending_signal();
  return signal != 0 ? kSignalBase + signal : code;
}
