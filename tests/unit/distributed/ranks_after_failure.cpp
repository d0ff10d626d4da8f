// A program for three ranks, which test_ranks.py starts. Rank 1 fails, which all of them catch, as
// a mesher does that has another way; then rank 2 fails alone, while the others wait for it. The
// earlier failure must not be taken for one that all know of: the others would wait for ever.
#include <cstdio>
#include <string>

#include "core/errors.hpp"
#include "distributed/ranks.hpp"

namespace {

using namespace vdwmesh;

// Exit codes, so that the test says what went wrong.
constexpr int kNotThrown = 10, kOtherMessage = 11, kNotKnown = 12, kRemembered = 13;

int fail_together_and_go_on(const Ranks& ranks) {
  try {
    ranks.together([&] {
      if (ranks.number() == 1) throw LimitExceeded("no room");
    });
    return kNotThrown;
  } catch (const LimitExceeded& error) {
    if (error.what() != std::string("rank 1: no room")) return kOtherMessage;
  }
  if (!ranks.all_failed()) return kNotKnown;
  ranks.together([] {});
  return ranks.all_failed() ? kRemembered : 0;
}

}  // namespace

int main(int argc, char** argv) {
  const Ranks ranks(argc, argv);
  const int status = fail_together_and_go_on(ranks);
  if (status != 0) ranks.abort(status);
  if (ranks.number() == 2) {
    std::fputs("rank 2 ends all\n", stderr);
    ranks.abort(3);
  }
  ranks.sum(std::uint64_t{1});  // rank 2 never comes
  return 0;
}
