// Members of a row stand in one order, and the error is the last, so that a row can be checked by
// its beginning and its end alone when a file is continued.
#include "batch_rows.hpp"

#include <fmt/format.h>

#include <numeric>

#include "build_id.hpp"
#include "csv.hpp"
#include "json_text.hpp"

namespace vdwmesh::apps {
namespace {

constexpr std::string_view kNoError = "\"error\":null}\n";

// In a table a row is a line, so names keep no line breaks.
std::string csv_name(std::string name) {
  for (char& c : name) {
    if (static_cast<unsigned char>(c) < ' ') c = '?';
  }
  return csv_field(name);
}

template <class T>
std::string csv_value(const std::optional<T>& value) {
  if (!value) return {};
  if constexpr (std::is_enum_v<T>)
    return std::string(name_of(*value));
  else
    return fmt::format("{}", *value);
}

std::optional<std::uint64_t> total(
    const std::optional<std::map<std::string, std::uint64_t>>& counts) {
  if (!counts) return std::nullopt;
  return std::accumulate(counts->begin(), counts->end(), std::uint64_t{0},
                         [](std::uint64_t sum, const auto& count) { return sum + count.second; });
}

std::string json_row(const BatchRow& row, const std::string& settings) {
  JsonText json(JsonText::Layout::compact);
  json("name", row.name), json("settings", settings), json("atoms", row.atoms);
  json("left_out", row.left_out), json("assumed_radii", row.assumed_radii);
  json("guessed_elements", row.guessed_elements), json("method", row.method);
  json("area", row.area), json("volume", row.volume), json("components", row.components);
  json("tunnels", row.tunnels), json("voids", row.voids);
  json("euler_characteristic", row.euler_characteristic);
  json("fallback_spheres", row.fallback_spheres), json("doubtful_spheres", row.doubtful_spheres);
  json("warnings", row.warnings), json("error", row.error);
  return std::move(json).take();
}

std::string csv_row(const BatchRow& row, const std::string& settings) {
  return fmt::format(
      "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", csv_name(row.name), settings,
      csv_value(row.atoms), csv_value(total(row.left_out)), csv_value(row.assumed_radii),
      csv_value(row.guessed_elements), csv_value(row.method), csv_value(row.area),
      csv_value(row.volume), csv_value(row.components), csv_value(row.tunnels),
      csv_value(row.voids), csv_value(row.euler_characteristic), csv_value(row.fallback_spheres),
      csv_value(row.doubtful_spheres), row.warnings.size(), csv_field(row.error.value_or("")));
}

}  // namespace

std::string RowWriter::header() const {
  if (format_ != RowFormat::csv) return {};
  return "name,settings,atoms,left_out,assumed_radii,guessed_elements,method,area,volume,"
         "components,"
         "tunnels,voids,euler_characteristic,fallback_spheres,doubtful_spheres,warnings,error\n";
}

std::string RowWriter::text(const BatchRow& row) const {
  std::string line = format_ == RowFormat::csv ? csv_row(row, settings_) : json_row(row, settings_);
  while (!line.empty() && line.back() == '\n') line.pop_back();
  return line + '\n';
}

std::string RowWriter::beginning(const std::string& name) const {
  if (format_ == RowFormat::csv) return csv_name(name) + ',' + settings_ + ',';
  BatchRow row;
  row.name = name;
  const std::string line = json_row(row, settings_);
  return line.substr(0, line.find("\"atoms\":", line.find(settings_)));
}

bool RowWriter::is_refusal(std::string_view line) const {
  return !line.ends_with(format_ == RowFormat::csv ? std::string_view(",\n") : kNoError);
}

std::string settings_key(const InputOptions& input, const ExactOptions& exact) {
  const ReadOptions& r = input.read;
  const std::string all = fmt::format(
      "{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", kRevision, name_of(r.format),
      r.model, r.assembly, r.select, r.measure, static_cast<int>(r.waters),
      static_cast<int>(r.hydrogens), static_cast<int>(r.hetero_atoms), r.altloc, r.radii,
      input.probe, name_of(exact.method), name_of(exact.topology));
  std::uint64_t key = 0xcbf29ce484222325;  // FNV-1a: offset and prime of 64 bits
  for (const char c : all) key = (key ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return fmt::format("{:016x}", key);
}

}  // namespace vdwmesh::apps
