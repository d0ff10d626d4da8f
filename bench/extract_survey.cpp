// extract_survey COUNT SEED [--first INDEX] [--backend cpu|cuda]
//
// Meshes COUNT random sets of balls from number INDEX (0) on and checks each as
// tests/support/extract_survey.hpp says; a line for each set that fails, and one in the end. Sets
// depend on SEED and their number alone, so that a survey can be shared among processes. Exit
// status 1 where a set fails.
#include "support/extract_survey.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/errors.hpp"

namespace vdwmesh::testing {
namespace {

struct Survey {
  std::uint32_t count, seed, first = 0;
  Backend backend = Backend::cpu;
};

std::uint32_t number(const std::string& text) {
  std::size_t end = 0;
  const unsigned long value = std::stoul(text, &end);
  if (end != text.size() || value > 0xffffffffu) throw InvalidInput(text + " is not a number");
  return static_cast<std::uint32_t>(value);
}

Survey parse(const std::vector<std::string>& arguments) {
  if (arguments.size() < 2 || arguments.size() % 2 != 0)
    throw InvalidInput("usage: extract_survey COUNT SEED [--first INDEX] [--backend cpu|cuda]");
  Survey survey{number(arguments[0]), number(arguments[1])};
  for (std::size_t i = 2; i < arguments.size(); i += 2) {
    const std::string &option = arguments[i], &value = arguments[i + 1];
    if (option == "--first") {
      survey.first = number(value);
    } else if (option == "--backend" && (value == "cpu" || value == "cuda")) {
      survey.backend = value == "cuda" ? Backend::cuda : Backend::cpu;
    } else {
      throw InvalidInput(option + " " + value + " is not an option");
    }
  }
  return survey;
}

int run(const Survey& survey) {
  SurveyCounts counts;
  std::uint64_t failed = 0;
  for (std::uint32_t i = survey.first; i < survey.first + survey.count; ++i) {
    const ExtractSet set = extract_set(survey.seed, i);
    const std::string wrong = complaint(set, survey.backend, counts);
    if (wrong.empty()) continue;
    ++failed;
    fmt::print("set {} ({}, {} balls, field {}, spacing {:.4g}): {}\n", i, set.name,
               set.spheres.size(), static_cast<int>(set.options.field.kind),
               set.options.grid.spacing, wrong);
  }
  fmt::print(
      "{} sets from {} of seed {}: {} failed; {} triangles; {} of balls apart, {} without "
      "any shortcut\n",
      survey.count, survey.first, survey.seed, failed, counts.triangles, counts.separated,
      counts.plain);
  return failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace vdwmesh::testing

int main(int argc, char** argv) {
  try {
    return vdwmesh::testing::run(vdwmesh::testing::parse({argv + 1, argv + argc}));
  } catch (const std::exception& error) {
    fmt::print(stderr, "extract_survey: {}\n", error.what());
    return 2;
  }
}
