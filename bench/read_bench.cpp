// What reading structure files costs: CPU seconds of this thread, the least and the median of
// several readings, and atoms per second by the least.
//
//   read_bench REPEAT FILE...
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "structure/reader.hpp"

namespace {

double cpu_seconds() {
  rusage used{};
  getrusage(RUSAGE_THREAD, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
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
