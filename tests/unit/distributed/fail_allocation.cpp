// A library that test_ranks.py loads before a program: one allocation of the second rank fails, the
// one whose number the environment gives (FAIL_ALLOCATION). Without the number, it says at the end
// how many there were. Only one process of a run should have memory that ends, so that the test
// sees whether the others hear of it, wherever they wait.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

class Allocations {
 public:
  Allocations() {
    const char* const rank = std::getenv("OMPI_COMM_WORLD_RANK");
    is_watched_ = rank != nullptr && std::strcmp(rank, "1") == 0;
    if (const char* const number = std::getenv("FAIL_ALLOCATION")) {
      failing_ = std::strtol(number, nullptr, 10);
    }
  }
  ~Allocations() {
    if (is_watched_ && failing_ == 0) std::fprintf(stderr, "allocations: %ld\n", count_.load());
  }
  bool next_fails() { return is_watched_ && ++count_ == failing_; }

 private:
  bool is_watched_ = false;
  long failing_ = 0;
  std::atomic<long> count_ = 0;
};

Allocations& allocations() {
  static Allocations all;
  return all;
}

}  // namespace

void* operator new(std::size_t size) {
  void* const memory = allocations().next_fails() ? nullptr : std::malloc(size > 0 ? size : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
