// Refusals of bad input, in one line of text each.
#pragma once

#include <fmt/format.h>

#include <utility>

#include "core/errors.hpp"

namespace vdwmesh::apps {

// Says what, where and what would work. Throws InvalidInput.
template <class... Values>
[[noreturn]] void refuse(fmt::format_string<Values...> message, Values&&... values) {
  throw InvalidInput(fmt::format(message, std::forward<Values>(values)...));
}

template <class... Values>
void refuse_if(bool wrong, fmt::format_string<Values...> message, Values&&... values) {
  if (wrong) refuse(message, std::forward<Values>(values)...);
}

}  // namespace vdwmesh::apps
