// Which models and sets of radii there can be. Papers write the names of sets with capitals.
#include "request/read_request.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "core/letters.hpp"
#include "structure/radii.hpp"

namespace vdwmesh {
namespace {

// Whether the file has the model is known when it is read; that this is no number is known now.
void check_model(const std::string& model, Door door) {
  const bool is_number = !model.empty() && model.size() < 10 &&
                         model.find_first_not_of("0123456789") == std::string::npos;
  refuse_if(model != "first" && model != "all" && !is_number,
            "{}: needs a model number of the file, first or all",
            refused_option(door, "model", model));
}

bool is_set(const std::string& name) { return std::ranges::count(RadiusTable::names(), name) > 0; }

}  // namespace

std::vector<std::string> settle(ReadOptions& options, Door door) {
  check_model(options.model, door);
  std::vector<std::string> files;
  if (options.radii.empty()) return files;
  std::vector<std::string> parts = RadiusTable::parts_of(options.radii);
  for (std::string& part : parts) {
    std::error_code error;
    if (is_set(lower_case(part)) && !std::filesystem::exists(part, error)) part = lower_case(part);
    if (!is_set(part)) files.push_back(part);
  }
  options.radii = fmt::format("{}", fmt::join(parts, ","));
  return files;
}

}  // namespace vdwmesh
