// The processes of a parallel run, called ranks, and what they tell each other. MPI stays behind
// this header.
//
// Functions marked "collective" must be called by all ranks, in the same order. If a rank leaves
// that order because of an exception, the others wait for it in vain. Work that may throw is
// therefore done inside of together(), which makes all ranks throw.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace vdwmesh {

struct HostCommunicators;

class Ranks {
 public:
  // Starts MPI, which may take options of its own off the command line, and ends it. A process has
  // one object of this class, made before it starts threads. All calls are made by the thread that
  // made the object.
  Ranks(int& argc, char**& argv);
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  // The number of this rank, from 0, and how many there are.
  int number() const { return number_; }
  int count() const { return count_; }
  bool is_first() const { return number_ == 0; }
  // The same for the ranks that run on this host.
  int number_on_host() const { return number_on_host_; }
  int count_on_host() const { return count_on_host_; }
  // Whether it is the lowest rank of its host. The first rank is.
  bool leads_host() const { return number_on_host_ == 0; }

  // Whether MPI grants that a rank starts threads, of which one makes all calls.
  bool allows_threads() const { return allows_threads_; }
  // Does `work` on every rank. If it throws on one or more, all ranks throw the exception of the
  // lowest of these: the same class of core/errors.hpp with the same message, preceded by "rank N:
  // " unless N is 0. Foreign exceptions become InternalError, std::bad_alloc stays what it is.
  // `work` must not call collective functions. Collective.
  void together(const std::function<void()>& work) const;
  // Whether an exception left the last together(). If it was not caught, all ranks are on their way
  // out.
  bool all_failed() const { return all_failed_; }
  // How long this rank has worked inside of together(), by the clock. The rest of its time it waits
  // for other ranks, or tells them something.
  double seconds_of_work() const { return seconds_of_work_; }

  // The text of the lowest rank whose text is not empty, preceded by "rank N: " unless N is 0;
  // empty if there is none. Collective.
  std::string first_text(const std::string& mine) const;

  // The sum over all ranks, and over the ranks before this one. Collective.
  std::uint64_t sum(std::uint64_t mine) const;
  std::int64_t sum(std::int64_t mine) const;
  std::uint64_t sum_before(std::uint64_t mine) const;
  // The sum over the ranks on this host. Collective.
  std::uint64_t sum_on_host(std::uint64_t mine) const;
  // Replaces each element of the array by its sum over all ranks, or over the ranks before this
  // one. Collective.
  void add_up(std::span<std::uint64_t> array) const;
  void add_up_before(std::span<std::uint64_t> array) const;

  // Gives all ranks the contents that the array has on the first one. Collective.
  template <class T>
  void share(std::vector<T>& array) const {
    static_assert(std::is_trivially_copyable_v<T>);
    array.resize(shared_size(array.size()));
    share_bytes(std::as_writable_bytes(std::span(array)));
  }

  // Returns the value that the first rank passes. Collective.
  template <class T>
  T shared(T value) const {
    static_assert(std::is_trivially_copyable_v<T>);
    share_bytes(std::as_writable_bytes(std::span(&value, 1)));
    return value;
  }

  // The value of the rank that leads the host. Collective.
  std::int64_t shared_on_host(std::int64_t value) const;
  // Gives all ranks of a host the bytes that its leader has; no rank goes on before the leader has
  // called it. Collective.
  void share_on_host(std::span<std::byte> bytes) const;
  // Gives the leaders of all hosts the bytes of the first rank. All leaders call it, and no others.
  void share_among_hosts(std::span<std::byte> bytes) const;

  // Returns the arrays of all ranks one behind the other to the first rank, and nothing to the
  // others. Collective.
  template <class T>
  std::vector<T> collect(std::span<const T> mine) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> all(sizes_sum(mine.size()));
    collect_bytes(std::as_bytes(mine), std::as_writable_bytes(std::span(all)));
    return all;
  }

  // The values of all ranks, on all of them: [r] is of rank r. Collective.
  template <class T>
  std::vector<T> of_all(const T& mine) const {
    std::vector<T> all = collect(std::span<const T>(&mine, 1));
    share(all);
    return all;
  }

  // Sends the array to_each[r] to rank r, and returns what came from the ranks: [r] is from rank r.
  // Precondition: one array for each rank. Collective.
  template <class T>
  std::vector<std::vector<T>> exchange(const std::vector<std::vector<T>>& to_each) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<std::uint64_t> sizes;
    for (const std::vector<T>& array : to_each) sizes.push_back(array.size());
    std::vector<std::vector<T>> from_each;
    std::vector<std::span<const std::byte>> sent;
    std::vector<std::span<std::byte>> received;
    for (const std::uint64_t size : exchange_sizes(sizes)) from_each.emplace_back(size);
    for (const std::vector<T>& array : to_each) sent.push_back(std::as_bytes(std::span(array)));
    for (std::vector<T>& array : from_each) {
      received.push_back(std::as_writable_bytes(std::span(array)));
    }
    exchange_bytes(sent, received);
    return from_each;
  }

  // Ends all ranks at once, with this exit status, for a failure outside of together().
  [[noreturn]] void abort(int status) const;

 private:
  std::size_t shared_size(std::size_t mine) const;
  void share_bytes(std::span<std::byte> bytes) const;
  std::size_t sizes_sum(std::size_t mine) const;  // on the first rank; 0 on the others
  void collect_bytes(std::span<const std::byte> mine, std::span<std::byte> all) const;
  std::vector<std::uint64_t> exchange_sizes(std::span<const std::uint64_t> to_each) const;
  void exchange_bytes(std::span<const std::span<const std::byte>> sent,
                      std::span<const std::span<std::byte>> received) const;

  bool allows_threads_ = false;
  int number_ = 0, count_ = 1, number_on_host_ = 0, count_on_host_ = 1;
  HostCommunicators* host_ = nullptr;  // communicators of the ranks on this host, and of leaders
  mutable bool all_failed_ = false;
  mutable double seconds_of_work_ = 0;
};

}  // namespace vdwmesh
