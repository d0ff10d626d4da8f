// Translates exceptions into a number and a message, and back. A class is looked for before the
// class that it derives from.
#include "distributed/failure.hpp"

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <new>

#include "core/errors.hpp"

namespace vdwmesh {

Failure current_failure() {
  try {
    throw;
  } catch (const Cancelled& error) {
    return {Cause::cancelled, error.what()};
  } catch (const InvalidInput& error) {
    return {Cause::invalid_input, error.what()};
  } catch (const FileFormatError& error) {
    return {Cause::file_format, error.what()};
  } catch (const BackendUnavailable& error) {
    return {Cause::backend_unavailable, error.what()};
  } catch (const LimitExceeded& error) {
    return {Cause::limit_exceeded, error.what()};
  } catch (const std::bad_alloc&) {
    return {Cause::out_of_memory, ""};
  } catch (const std::filesystem::filesystem_error& error) {
    return {Cause::invalid_input,
            fmt::format("{}: {}", error.path1().string(), error.code().message())};
  } catch (const std::exception& error) {
    return {Cause::internal, error.what()};
  } catch (...) {
    return {Cause::internal, "an exception of an unknown class"};
  }
}

void throw_failure(const Failure& failure) {
  switch (failure.cause) {
    case Cause::cancelled:
      throw Cancelled(failure.message);
    case Cause::invalid_input:
      throw InvalidInput(failure.message);
    case Cause::file_format:
      throw FileFormatError(failure.message);
    case Cause::backend_unavailable:
      throw BackendUnavailable(failure.message);
    case Cause::limit_exceeded:
      throw LimitExceeded(failure.message);
    case Cause::out_of_memory:
      throw std::bad_alloc();
    case Cause::none:
    case Cause::internal:
      break;
  }
  throw InternalError(failure.message);
}

}  // namespace vdwmesh
