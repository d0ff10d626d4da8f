// Turns exceptions into exit codes and messages of one line. Error makes one line of every message,
// whatever text from files it quotes.
#include "outcome.hpp"

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <new>

#include "core/errors.hpp"

namespace vdwmesh::apps {

// The order matters: what derives from another cause is caught before it.
Outcome outcome_of(const std::function<void()>& work) {
  const auto fail = [](ExitCode status, const Error& error) {
    return Outcome{status, error.what()};
  };
  try {
    work();
    return {};
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
                LimitExceeded("out of memory: a coarser mesh or fewer subdivisions need less"));
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(kBadInput, InvalidInput(fmt::format("{}: {}", error.path1().string(),
                                                    error.code().message())));
  } catch (const std::exception& error) {
    return fail(kOwnFault, Error(fmt::format("internal error: {}", error.what())));
  }
}

}  // namespace vdwmesh::apps
