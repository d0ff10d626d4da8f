// Copies on the host that leave the caches to others: for what is too large to stay in them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace vdwmesh {

// Where a copy stores: a usual store first reads the line of memory that it writes, and leaves it
// in the caches for who reads it next. A store past the caches does neither.
enum class Stores : std::uint8_t { usual, past_caches };

// How to copy `bytes` in all, of which caches hold less than `beyond_caches`.
constexpr Stores stores_for(std::size_t bytes, std::size_t beyond_caches) {
  return bytes < beyond_caches ? Stores::usual : Stores::past_caches;
}

// As std::memcpy(). Memory of any alignment; whole lines of `to` are written past the caches, what
// is before and behind them as usual. Where the compiler knows no such stores, all of it is.
inline void copy_past_caches(void* to, const void* from, std::size_t bytes) {
#ifdef __SSE2__
  constexpr std::size_t kLine = 64, kWord = sizeof(__m128i);
  auto* out = static_cast<std::byte*>(to);
  const auto* in = static_cast<const std::byte*>(from);
  const std::size_t before = (kLine - reinterpret_cast<std::uintptr_t>(out) % kLine) % kLine;
  const std::size_t head = std::min(before, bytes), lines = (bytes - head) / kLine;
  std::memcpy(out, in, head);
  out += head;
  in += head;
  for (std::size_t line = 0; line < lines; ++line, out += kLine, in += kLine) {
    __m128i words[kLine / kWord];
    for (std::size_t i = 0; i < kLine / kWord; ++i) {
      words[i] = _mm_loadu_si128(reinterpret_cast<const __m128i*>(in + i * kWord));
    }
    for (std::size_t i = 0; i < kLine / kWord; ++i) {
      _mm_stream_si128(reinterpret_cast<__m128i*>(out + i * kWord), words[i]);
    }
  }
  std::memcpy(out, in, bytes - head - lines * kLine);
  _mm_sfence();  // other threads see these stores before what this one does next
#else
  std::memcpy(to, from, bytes);
#endif
}

inline void copy_bytes(void* to, const void* from, std::size_t bytes, Stores stores) {
  if (stores == Stores::past_caches) {
    copy_past_caches(to, from, bytes);
  } else {
    std::memcpy(to, from, bytes);
  }
}

}  // namespace vdwmesh
