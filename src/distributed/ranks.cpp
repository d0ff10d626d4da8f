// Ranks on MPI. Arrays travel as bytes, in pieces (pieces.hpp). Errors of MPI itself end the run:
// MPI's own handler says what happened, and there is nothing to be saved when messages are lost.
#include "distributed/ranks.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>

#include "distributed/failure.hpp"
#include "distributed/shares/pieces.hpp"

namespace vdwmesh {
namespace {

template <class T>
T reduced(T mine, MPI_Datatype type, MPI_Op operation, MPI_Comm ranks = MPI_COMM_WORLD) {
  T all{};
  MPI_Allreduce(&mine, &all, 1, type, operation, ranks);
  return all;
}

constexpr int kNobody = std::numeric_limits<int>::max();  // of the results of first_of()

// The lowest rank that this is true for.
int first_of(bool mine) {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return reduced(mine ? rank : kNobody, MPI_INT, MPI_MIN);
}

Cause cause_of(int rank, Cause mine) {
  int cause = static_cast<int>(mine);
  MPI_Bcast(&cause, 1, MPI_INT, rank, MPI_COMM_WORLD);
  return static_cast<Cause>(cause);
}

// The text of a rank, preceded by "rank N: " unless that is the first one.
std::string text_of(int rank, std::string text) {
  int length = static_cast<int>(text.size());
  MPI_Bcast(&length, 1, MPI_INT, rank, MPI_COMM_WORLD);
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), length, MPI_CHAR, rank, MPI_COMM_WORLD);
  return rank > 0 ? fmt::format("rank {}: {}", rank, text) : text;
}

void share_bytes_among(MPI_Comm ranks, std::span<std::byte> bytes) {
  in_pieces(bytes,
            [ranks](std::byte* first, int count) { MPI_Bcast(first, count, MPI_BYTE, 0, ranks); });
}

}  // namespace

struct HostCommunicators {
  MPI_Comm ranks = MPI_COMM_NULL;
  MPI_Comm leaders = MPI_COMM_NULL;  // of all hosts; null on other ranks
};

Ranks::Ranks(int& argc, char**& argv) : host_(new HostCommunicators) {
  int granted = MPI_THREAD_SINGLE;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &granted);
  allows_threads_ = granted >= MPI_THREAD_FUNNELED;
  MPI_Comm_rank(MPI_COMM_WORLD, &number_);
  MPI_Comm_size(MPI_COMM_WORLD, &count_);
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &host_->ranks);
  MPI_Comm_rank(host_->ranks, &number_on_host_);
  MPI_Comm_size(host_->ranks, &count_on_host_);
  MPI_Comm_split(MPI_COMM_WORLD, leads_host() ? 0 : MPI_UNDEFINED, number_, &host_->leaders);
}

Ranks::~Ranks() {
  if (leads_host()) MPI_Comm_free(&host_->leaders);
  MPI_Comm_free(&host_->ranks);
  delete host_;
  MPI_Finalize();
}

// A failure without a message counts too: running out of memory has none.
void Ranks::together(const std::function<void()>& work) const {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  Failure failure;
  try {
    work();
  } catch (...) {
    failure = current_failure();
  }
  seconds_of_work_ += std::chrono::duration<double>(Clock::now() - begin).count();
  const int first = first_of(failure.cause != Cause::none);
  all_failed_ = first != kNobody;
  if (!all_failed_) return;
  failure.cause = cause_of(first, failure.cause);
  failure.message = text_of(first, failure.message);
  throw_failure(failure);
}

std::string Ranks::first_text(const std::string& mine) const {
  const int first = first_of(!mine.empty());
  return first == kNobody ? std::string() : text_of(first, mine);
}

std::uint64_t Ranks::sum(std::uint64_t mine) const { return reduced(mine, MPI_UINT64_T, MPI_SUM); }
std::int64_t Ranks::sum(std::int64_t mine) const { return reduced(mine, MPI_INT64_T, MPI_SUM); }
std::uint64_t Ranks::sum_on_host(std::uint64_t mine) const {
  return reduced(mine, MPI_UINT64_T, MPI_SUM, host_->ranks);
}

std::uint64_t Ranks::sum_before(std::uint64_t mine) const {
  std::uint64_t before = 0;
  MPI_Exscan(&mine, &before, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
  return is_first() ? 0 : before;  // MPI leaves the result of the first rank undefined
}

std::size_t Ranks::shared_size(std::size_t mine) const {
  std::uint64_t size = mine;
  MPI_Bcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
  return size;
}

void Ranks::share_bytes(std::span<std::byte> bytes) const {
  share_bytes_among(MPI_COMM_WORLD, bytes);
}

std::int64_t Ranks::shared_on_host(std::int64_t value) const {
  MPI_Bcast(&value, 1, MPI_INT64_T, 0, host_->ranks);
  return value;
}

void Ranks::share_on_host(std::span<std::byte> bytes) const {
  share_bytes_among(host_->ranks, bytes);
  MPI_Barrier(host_->ranks);  // a broadcast of no bytes would not wait for the other ranks
}

void Ranks::share_among_hosts(std::span<std::byte> bytes) const {
  share_bytes_among(host_->leaders, bytes);
}

std::size_t Ranks::sizes_sum(std::size_t mine) const {
  const std::uint64_t all = sum(std::uint64_t{mine});
  return is_first() ? all : 0;
}

// The first rank takes the arrays in the order of the ranks, each after its size.
void Ranks::collect_bytes(std::span<const std::byte> mine, std::span<std::byte> all) const {
  constexpr int kSize = 0, kContents = 1;  // tags
  if (!is_first()) {
    const std::uint64_t size = mine.size();
    MPI_Send(&size, 1, MPI_UINT64_T, 0, kSize, MPI_COMM_WORLD);
    in_pieces(mine, [](const std::byte* first, int count) {
      MPI_Send(first, count, MPI_BYTE, 0, kContents, MPI_COMM_WORLD);
    });
    return;
  }
  std::copy(mine.begin(), mine.end(), all.begin());
  std::size_t done = mine.size();
  for (int rank = 1; rank < count_; ++rank) {
    std::uint64_t size = 0;
    MPI_Recv(&size, 1, MPI_UINT64_T, rank, kSize, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    in_pieces(all.subspan(done, size), [rank](std::byte* first, int count) {
      MPI_Recv(first, count, MPI_BYTE, rank, kContents, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    });
    done += size;
  }
}

void Ranks::add_up(std::span<std::uint64_t> array) const {
  in_pieces(std::as_writable_bytes(array), [](std::byte* first, int count) {
    MPI_Allreduce(MPI_IN_PLACE, first, count / static_cast<int>(sizeof(std::uint64_t)),
                  MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
  });
}

void Ranks::add_up_before(std::span<std::uint64_t> array) const {
  in_pieces(std::as_writable_bytes(array), [](std::byte* first, int count) {
    MPI_Exscan(MPI_IN_PLACE, first, count / static_cast<int>(sizeof(std::uint64_t)), MPI_UINT64_T,
               MPI_SUM, MPI_COMM_WORLD);
  });
  // MPI leaves the result of the first rank undefined.
  if (is_first()) std::ranges::fill(array, std::uint64_t{0});
}

std::vector<std::uint64_t> Ranks::exchange_sizes(std::span<const std::uint64_t> to_each) const {
  std::vector<std::uint64_t> from_each(to_each.size());
  MPI_Alltoall(to_each.data(), 1, MPI_UINT64_T, from_each.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD);
  return from_each;
}

// All messages are under way at the same time, so that no order of ranks can make them wait for
// each other. Those between two ranks arrive in the order in which they were sent.
void Ranks::exchange_bytes(std::span<const std::span<const std::byte>> sent,
                           std::span<const std::span<std::byte>> received) const {
  std::vector<MPI_Request> requests;
  const auto next = [&requests] { return &requests.emplace_back(MPI_REQUEST_NULL); };
  for (int rank = 0; rank < count_; ++rank) {
    in_pieces(received[static_cast<std::size_t>(rank)], [&](std::byte* first, int count) {
      MPI_Irecv(first, count, MPI_BYTE, rank, 0, MPI_COMM_WORLD, next());
    });
  }
  for (int rank = 0; rank < count_; ++rank) {
    in_pieces(sent[static_cast<std::size_t>(rank)], [&](const std::byte* first, int count) {
      MPI_Isend(first, count, MPI_BYTE, rank, 0, MPI_COMM_WORLD, next());
    });
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

void Ranks::abort(int status) const {
  MPI_Abort(MPI_COMM_WORLD, status);
  std::abort();  // not reached; MPI_Abort() is not declared as a function that does not return
}

}  // namespace vdwmesh
