#include "anchors/apart.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>

namespace vdwmesh::anchors {
namespace {

rusage usage() {
  rusage result{};
  getrusage(RUSAGE_SELF, &result);
  return result;
}

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

std::uint64_t peak_bytes(const rusage& u) { return static_cast<std::uint64_t>(u.ru_maxrss) * 1024; }

Cost measure(const std::function<std::uint64_t()>& work) {
  const rusage before = usage();
  const auto start = std::chrono::steady_clock::now();
  Cost cost;
  cost.items = work();
  cost.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const rusage after = usage();
  cost.kernel = seconds(after.ru_stime) - seconds(before.ru_stime);
  cost.cpu = cost.kernel + seconds(after.ru_utime) - seconds(before.ru_utime);
  cost.memory = peak_bytes(after) - peak_bytes(before);
  return cost;
}

[[noreturn]] void run_child(int out, const std::string& name,
                            const std::function<std::uint64_t()>& work) {
  try {
    const Cost cost = measure(work);
    std::_Exit(::write(out, &cost, sizeof cost) == sizeof cost ? 0 : 1);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
    std::_Exit(1);
  }
}

}  // namespace

Cost run_apart(const std::string& name, const std::function<std::uint64_t()>& work) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error(name + ": no pipe");
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error(name + ": no process");
  if (child == 0) run_child(ends[1], name, work);
  ::close(ends[1]);
  Cost cost;
  const bool whole = ::read(ends[0], &cost, sizeof cost) == sizeof cost;
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (!whole || status != 0) throw std::runtime_error(name + " failed");
  return cost;
}

Cost least(const Cost& a, const Cost& b) {
  return {std::min(a.cpu, b.cpu), std::min(a.wall, b.wall), std::min(a.kernel, b.kernel),
          std::min(a.memory, b.memory), a.items};
}

}  // namespace vdwmesh::anchors
