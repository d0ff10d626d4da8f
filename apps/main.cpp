// The program: reads the command line, runs a verb, and turns exceptions into exit codes and one
// line on standard error. Which cause has which code is part of the contract with scripts, and so
// is that nothing but the line is printed.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>

#include "command_line/command_line.hpp"
#include "core/errors.hpp"
#include "interrupt.hpp"
#include "memory.hpp"

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

// One line on standard error, whatever the message quotes: Error sees to that.
int fail(ExitCode code, const Error& error) {
  std::fprintf(stderr, "vdwmesh: %s\n", error.what());
  return code;
}

// The order matters: what derives from another cause is caught before it.
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

int run(int argc, char** argv) {
  if (const auto command = read_command_line(argc, argv)) command->verb->run(command->options);
  return kDone;
}

}  // namespace
}  // namespace vdwmesh::apps

int main(int argc, char** argv) {
  using namespace vdwmesh::apps;
  install_signal_handlers();
  keep_freed_memory();
  const int code = exit_code_of([&] { return run(argc, argv); });
  const int signal = pending_signal();
  return signal != 0 ? kSignalBase + signal : code;
}
