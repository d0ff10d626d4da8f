// Asks the kernel how much memory the process has used at most.
#include "memory.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <fstream>
#include <string>

#include "core/large_pages.hpp"

namespace vdwmesh::apps {

void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 0);         // large blocks come from the heap as well
  mallopt(M_TRIM_THRESHOLD, -1);  // whose end is never given back
#endif
}

PeakMemory::PeakMemory() {
  return_freed_pages();
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;  // proc(5): resets the peak resident set size
  reset_ = file.good();
}

// The kernel keeps one high-water mark for the whole process. The peak of a part of a run is known
// only if the mark was reset before that part.
std::optional<std::uint64_t> PeakMemory::bytes() const {
  if (!reset_) return std::nullopt;
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) * 1024;
  }
  return std::nullopt;
}

}  // namespace vdwmesh::apps
