// What reading structure files costs: CPU seconds of this thread, the least and the median of
// several readings, and atoms per second by the least.
//
//   read_bench REPEAT FILE...
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "structure/reader.hpp"

namespace {

// Of this thread, by a clock that does not count in the scheduler's ticks.
double cpu_seconds() {
  timespec used{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

}  // namespace

int main(int argc, char** argv) {
  const int repeat = argc > 2 ? std::max(1, std::atoi(argv[1])) : 0;
  if (repeat == 0) {
    std::fputs("read_bench REPEAT FILE...\n", stderr);
    return 1;
  }
  std::printf("%-40s %10s %10s %10s %14s\n", "file", "atoms", "least s", "median s", "atoms/s");
  for (int i = 2; i < argc; ++i) {
    std::vector<double> seconds;
    std::size_t atoms = 0;
    for (int run = 0; run < repeat; ++run) {
      const double start = cpu_seconds();
      atoms = vdwmesh::read_structure(argv[i]).atoms.size();
      seconds.push_back(cpu_seconds() - start);
    }
    std::sort(seconds.begin(), seconds.end());
    std::printf("%-40s %10zu %10.4f %10.4f %14.0f\n", argv[i], atoms, seconds.front(),
                seconds[seconds.size() / 2], static_cast<double>(atoms) / seconds.front());
  }
  return 0;
}
