// Finds the closest name by the edit distance in which a swap of two neighbours counts as one edit
// (optimal string alignment; F. J. Damerau 1964), because that is how people mistype. The distance
// is reckoned row by row of the usual table, of which the last three rows are needed.
#include "command_line/suggest.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace vdwmesh::apps {
namespace {

using Distances = std::vector<std::size_t>;

std::size_t edit_distance(std::string_view a, std::string_view b) {
  Distances before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row.back();
}

// The dashes of options are no letters that somebody mistypes.
std::size_t letters(std::string_view name) {
  return name.size() - static_cast<std::size_t>(std::ranges::count(name, '-'));
}

}  // namespace

std::string suggestion(std::string_view given, std::span<const std::string_view> known) {
  std::string_view closest;
  std::size_t least = letters(given) > 5 ? 3 : letters(given) > 1 ? 2 : 0;
  for (const std::string_view name : known) {
    // With one letter of three wrong it is another word ("gpu", "cpu") more often than a slip.
    if (letters(given) < 4 && !name.starts_with(given.substr(0, 1))) continue;
    const std::size_t distance = edit_distance(given, name);
    if (distance > least) continue;
    closest = distance < least ? name : "";  // which of two as close was meant, nobody knows
    least = distance;
  }
  return closest.empty() ? "" : "; did you mean " + std::string(closest) + "?";
}

}  // namespace vdwmesh::apps
