// What visitors of described types need. A type is described once, by a function
//
//   void describe(A& a, T& value);   // a("key", value.member) for each member, in order
//
// and A decides what becomes of the members: JSON text (json_text.hpp), cells of a table (csv.hpp),
// or members that are read back (study/records.cpp). The functions stand in this namespace, where
// visitors find them by their argument.
#pragma once

#include <concepts>
#include <string_view>
#include <type_traits>

#include "analysis/distances.hpp"
#include "analysis/mesh_measures.hpp"

namespace vdwmesh::apps {

// T or const T: the same description serves writing and reading.
template <class U, class T>
concept Of = std::same_as<std::remove_const_t<U>, T>;

// Values that have names on the command line have the same ones in every output.
template <class T>
concept Named = std::is_enum_v<T>;

template <class T>
concept Textual = std::convertible_to<T, std::string_view>;

template <class T>
concept Number = std::is_arithmetic_v<T> && !std::same_as<T, bool>;

template <class A, Of<Distribution> T>
void describe(A& a, T& d) {
  a("min", d.min), a("p01", d.p01), a("median", d.median);
  a("p99", d.p99), a("max", d.max), a("mean", d.mean);
}

template <class A, Of<DistanceStatistics> T>
void describe(A& a, T& d) {
  a("mean", d.mean), a("rms", d.rms), a("max", d.max);
  a("p50", d.p50), a("p95", d.p95), a("p99", d.p99);
  a("mean_error", d.mean_error), a("rms_error", d.rms_error), a("samples", d.samples);
}

}  // namespace vdwmesh::apps
