// Which names were meant by slips of the fingers: an edit distance that counts a swap of neighbours
// as one slip. And how options are written in refusals.
#include <algorithm>
#include <numeric>
#include <utility>

#include "request/names.hpp"
#include "request/refuse.hpp"

namespace vdwmesh {
namespace {

// What the field, or another program, calls something that has another name here.
constexpr std::pair<std::string_view, std::string_view> kSynonyms[] = {
    {"msms", "ses"}, {"gpu", "cuda"}, {"mc", "marching-cubes"}};

using Distances = std::vector<std::size_t>;

// Three rows of the usual table are enough: a swap looks two rows back.
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

std::string list_names(std::span<const std::string_view> names) {
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) list += i + 1 == names.size() ? " or " : ", ";
    list += names[i];
  }
  return list;
}

std::string suggestion(std::string_view given, std::span<const std::string_view> known) {
  for (const auto& [synonym, here] : kSynonyms) {
    const bool is_meant = synonym == given && std::ranges::find(known, here) != known.end();
    if (is_meant) return fmt::format("; did you mean {}?", here);
  }
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

void throw_unknown_name(std::string_view option, std::string_view text,
                        std::span<const std::string_view> known) {
  throw InvalidInput(fmt::format("{} {}: not known; choose {}{}", option, text, list_names(known),
                                 suggestion(text, known)));
}

std::string option_name(Door door, std::string_view name) {
  if (door == Door::program) return fmt::format("--{}", name);
  std::string written(name);
  std::ranges::replace(written, '-', '_');
  return written;
}

std::string option_with(Door door, std::string_view name, std::string_view value) {
  const std::string option = option_name(door, name);
  return door == Door::program ? fmt::format("{} {}", option, value)
                               : fmt::format("{}=\"{}\"", option, value);
}

std::string refused_option(Door door, std::string_view name, std::string_view value) {
  return fmt::format("{}{} {}", option_name(door, name), door == Door::program ? "" : ":", value);
}

}  // namespace vdwmesh
