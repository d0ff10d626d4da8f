// A library that test_ranks.py loads before a program: one allocation of the second rank fails, the
// one whose number the environment gives (FAIL_ALLOCATION). Without the number, it says at the end
// how many there were. Only one process of a run should have memory that ends, so that the test
// sees whether the others hear of it, wherever they wait.
//
// The program has its own operator new, which no library can replace, so malloc() is. Of its calls
// those count that come from the program's code, by operator new. Libraries, which may call it in
// C and not expect a failure, have the memory that they want.
#include <link.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

extern "C" void* __libc_malloc(
    std::size_t size);  // of glibc: what malloc() is without this library

namespace {

class Allocations {
 public:
  Allocations() {
    const char* const rank = std::getenv("OMPI_COMM_WORLD_RANK");
    if (rank == nullptr || std::strcmp(rank, "1") != 0) return;
    if (const char* const number = std::getenv("FAIL_ALLOCATION")) {
      failing_ = std::strtol(number, nullptr, 10);
    }
    // The first object is the program.
    dl_iterate_phdr(
        [](dl_phdr_info* info, std::size_t, void* self) {
          static_cast<Allocations*>(self)->find_code(*info);
          return 1;
        },
        this);
  }
  ~Allocations() {
    if (begin_ != 0 && failing_ == 0) std::fprintf(stderr, "allocations: %ld\n", count_.load());
  }

  bool fails(const void* caller) {
    const auto address = reinterpret_cast<std::uintptr_t>(caller);
    return address >= begin_ && address < end_ && ++count_ == failing_;
  }

 private:
  void find_code(const dl_phdr_info& info) {
    for (int i = 0; i < info.dlpi_phnum; ++i) {
      const auto& part = info.dlpi_phdr[i];
      if (part.p_type != PT_LOAD || (part.p_flags & PF_X) == 0) continue;
      begin_ = info.dlpi_addr + part.p_vaddr;
      end_ = begin_ + part.p_memsz;
    }
  }

  std::uintptr_t begin_ = 0, end_ = 0;  // of the program's code; empty on other ranks
  long failing_ = 0;
  std::atomic<long> count_ = 0;
};

Allocations& allocations() {
  static Allocations all;
  return all;
}

}  // namespace

extern "C" void* malloc(std::size_t size) {
  return allocations().fails(__builtin_return_address(0)) ? nullptr : __libc_malloc(size);
}
