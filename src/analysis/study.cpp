// find_series(): groups the runs of a study into series and fits each series.
//
// Ordered maps sort the runs by their setting, so a series lists its runs by increasing resolution.
// Each fit reads one figure of every run as a column of numbers; a run without the figure has NaN,
// which fit_power_law() and extrapolate() leave out.
#include "analysis/study.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace vdwmesh {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Returns one figure (a number that `read` takes from a run) of every picked run; `picked` are
// indices into `runs`. `read` returns NaN if a run does not have the figure.
template <class Read>
std::vector<double> column(std::span<const StudyRun> runs, const std::vector<std::size_t>& picked,
                           Read&& read) {
  std::vector<double> values;
  values.reserve(picked.size());
  for (const std::size_t i : picked) values.push_back(read(runs[i]));
  return values;
}

// Turns a reader of MeshDistances into a reader of runs, which returns NaN for runs without
// distances.
template <class Read>
auto of_distances(Read read) {
  return [read](const StudyRun& run) {
    return run.comparison.distances ? read(*run.comparison.distances) : kNone;
  };
}

double area_error(const StudyRun& run) { return run.comparison.area_relative_error; }
double volume_error(const StudyRun& run) {
  return run.comparison.volume_relative_error.value_or(kNone);
}

// Fits the order of every error against the given sizes, one size per picked run.
StudyOrders fit_orders(std::span<const StudyRun> runs, const std::vector<std::size_t>& picked,
                       const std::vector<double>& sizes) {
  const auto fit = [&](auto read) { return fit_power_law(sizes, column(runs, picked, read)); };
  using D = MeshDistances;
  return {fit(area_error), fit(volume_error),
          fit(of_distances([](const D& d) { return d.mesh_to_surface.rms; })),
          fit(of_distances([](const D& d) { return d.surface_to_mesh.rms; })),
          fit(of_distances([](const D& d) { return d.hausdorff_lower_bound; }))};
}

StudySeries make_series(std::span<const StudyRun> runs, const StudyKey& key,
                        std::vector<std::size_t> picked) {
  StudySeries series;
  series.key = key;
  series.runs = std::move(picked);
  const auto read = [&](auto figure) { return column(runs, series.runs, figure); };
  const std::vector<double> sizes = read([](const StudyRun& r) { return r.setting.resolution; });
  series.by_resolution = fit_orders(runs, series.runs, sizes);
  series.by_triangles =
      fit_orders(runs, series.runs,
                 read([](const StudyRun& r) { return static_cast<double>(r.topology.triangles); }));
  series.area = extrapolate(sizes, read([](const StudyRun& r) { return r.measures.area; }));
  series.volume =
      extrapolate(sizes, read([](const StudyRun& r) { return r.measures.volume.value_or(kNone); }));
  return series;
}

}  // namespace

std::vector<StudySeries> find_series(std::span<const StudyRun> runs) {
  std::map<StudySetting, std::size_t> by_setting;
  for (std::size_t i = 0; i < runs.size(); ++i) by_setting[runs[i].setting] = i;
  std::map<StudyKey, std::vector<std::size_t>> by_key;
  for (const auto& [setting, run] : by_setting) by_key[setting.key].push_back(run);
  std::vector<StudySeries> result;
  result.reserve(by_key.size());
  for (auto& [key, picked] : by_key) result.push_back(make_series(runs, key, std::move(picked)));
  return result;
}

}  // namespace vdwmesh
