// Exceptions that travel between processes: the class and the message arrive.
#include "distributed/failure.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <new>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

Failure failure_of(const std::function<void()>& work) {
  try {
    work();
  } catch (...) {
    return current_failure();
  }
  return {};
}

template <class Exception>
void travels() {
  const Failure failure = failure_of([] { throw Exception("what, where and what would work"); });
  try {
    throw_failure(failure);
  } catch (const Exception& error) {
    EXPECT_STREQ(error.what(), "what, where and what would work");
  }
}

TEST(Failure, EveryClassOfErrorArrives) {
  travels<InvalidInput>();
  travels<FileFormatError>();
  travels<BackendUnavailable>();
  travels<LimitExceeded>();
  travels<Cancelled>();
  travels<InternalError>();
  EXPECT_THROW(throw_failure(failure_of([] { throw std::bad_alloc(); })), std::bad_alloc);
}

TEST(Failure, WhatHasNoClassOfItsOwnArrivesAsOneThatItIs) {
  EXPECT_THROW(throw_failure(failure_of([] { throw DeviceMemoryExceeded("x"); })), LimitExceeded);
  EXPECT_THROW(throw_failure(failure_of([] { throw std::runtime_error("x"); })), InternalError);
  EXPECT_THROW(throw_failure(failure_of([] { throw 1; })), InternalError);
  EXPECT_EQ(failure_of([] {}).cause, Cause::none);
}

}  // namespace
}  // namespace vdwmesh
