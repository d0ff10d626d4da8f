// HostMemory: the lowest rank of a host, its leader, makes an anonymous file in memory, and the
// others map it by the name that it has among the leader's open files in /proc. The leaders send
// each other the contents, so these are sent once to each host and not once to each rank; or the
// ranks of each host write them together.
//
// Shared windows of MPI would do the same, but Open MPI keeps them in /dev/shm, which containers
// often limit to 64 MB, and ends the run if that does not suffice. If a mapping fails here on any
// rank of a host, all its ranks take copies instead.
#include "distributed/host_memory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

namespace vdwmesh {
namespace {

// An open file, which a process has for as long as the object lives. Negative: there is none.
class MemoryDescriptor {
 public:
  explicit MemoryDescriptor(int number) : number_(number) {}
  ~MemoryDescriptor() {
    if (number_ >= 0) ::close(number_);
  }
  MemoryDescriptor(const MemoryDescriptor&) = delete;
  MemoryDescriptor& operator=(const MemoryDescriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

// Null where it fails.
void* map(int descriptor, std::size_t size) {
  if (descriptor < 0) return nullptr;
  void* const place = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  return place == MAP_FAILED ? nullptr : place;
}

// Reserves the memory, so that a lack of it fails here, and not by a signal at the first write.
int make_file(std::size_t size) {
  const int descriptor = ::memfd_create("vdwmesh", MFD_CLOEXEC);
  if (descriptor < 0) return -1;
  if (::posix_fallocate(descriptor, 0, static_cast<off_t>(size)) == 0) return descriptor;
  ::close(descriptor);
  return -1;
}

// Where the leader's file is found, and what tells it from others.
struct FileName {
  std::int64_t process, number, device, node;
};

std::pair<std::int64_t, std::int64_t> identity_of(int descriptor) {
  struct stat status {};
  if (descriptor < 0 || ::fstat(descriptor, &status) != 0) return {-1, -1};
  return {static_cast<std::int64_t>(status.st_dev), static_cast<std::int64_t>(status.st_ino)};
}

// Collective.
FileName share_name(const Ranks& ranks, int descriptor) {
  const auto [device, node] = identity_of(descriptor);
  return {ranks.shared_on_host(std::int64_t{::getpid()}),
          ranks.shared_on_host(std::int64_t{descriptor}), ranks.shared_on_host(device),
          ranks.shared_on_host(node)};
}

// Null if it fails. If ranks run in containers of their own, the number of the leader's process may
// here be that of another process; its file differs from the leader's, and is refused.
void* map_named(const FileName& file, std::size_t size) {
  if (file.number < 0) return nullptr;
  const std::string name = fmt::format("/proc/{}/fd/{}", file.process, file.number);
  const MemoryDescriptor opened(::open(name.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (identity_of(opened.number()) != std::pair(file.device, file.node)) return nullptr;
  return map(opened.number(), size);
}

}  // namespace

// Returns the bytes, which the caller fills. Collective.
std::span<std::byte> HostMemory::make_room(const Ranks& ranks, std::uint64_t size) {
  const bool leads = ranks.leads_host();
  const MemoryDescriptor made(leads ? make_file(size) : -1);
  if (leads) mapping_ = map(made.number(), size);
  const FileName name = share_name(ranks, made.number());
  if (!leads) mapping_ = map_named(name, size);
  if (ranks.sum_on_host(std::uint64_t{mapping_ == nullptr}) > 0) {
    if (mapping_ != nullptr) ::munmap(mapping_, size);
    mapping_ = nullptr;
  }
  ranks.together([&] {
    if (mapping_ == nullptr) own_.resize(size);
  });
  const std::span<std::byte> room =
      mapping_ != nullptr ? std::span(static_cast<std::byte*>(mapping_), size) : own_;
  bytes_ = room;
  return room;
}

HostMemory::HostMemory(const Ranks& ranks, std::span<const std::byte> contents) {
  const std::uint64_t size = ranks.shared(std::uint64_t{contents.size()});
  if (size == 0) return;
  const std::span<std::byte> to_fill = make_room(ranks, size);
  if (ranks.is_first()) std::ranges::copy(contents, to_fill.begin());
  if (ranks.leads_host()) ranks.share_among_hosts(to_fill);
  // Copies are filled; of a mapping, the ranks that only read it hear that it is full.
  ranks.share_on_host(mapping_ == nullptr ? to_fill : std::span<std::byte>());
}

// A rank whose bytes are its own makes all of them. No rank returns from together() before all have
// made theirs.
HostMemory::HostMemory(const Ranks& ranks, std::uint64_t size, const Fill& fill) : HostMemory() {
  if (size == 0) return;
  const std::span<std::byte> to_fill = make_room(ranks, size);
  const ShareOfArray share = mapping_ == nullptr
                                 ? ShareOfArray{0, 1}
                                 : ShareOfArray{static_cast<std::uint64_t>(ranks.number_on_host()),
                                                static_cast<std::uint64_t>(ranks.count_on_host())};
  ranks.together([&] { fill(share, to_fill); });
}

HostMemory::~HostMemory() {
  if (mapping_ != nullptr) ::munmap(mapping_, bytes_.size());
}

void HostMemory::swap(HostMemory& other) noexcept {
  std::swap(bytes_, other.bytes_);
  std::swap(own_, other.own_);
  std::swap(mapping_, other.mapping_);
}

}  // namespace vdwmesh
