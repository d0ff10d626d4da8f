// Plots of places for probes of all radii, and of ways out, as SVG.
#pragma once

#include <filesystem>
#include <string>

#include "report/pockets/scan_report.hpp"

namespace vdwmesh::apps {

bool is_plot(const std::filesystem::path& path);  // .svg

// The merge tree: a line for each place, from the radius of the largest probe down to that of the
// gate where it joins another one, to whose line it is led, or the outside, where it ends in a dot.
std::string plot_of(const ScanReport& report);
// The radius of the largest probe along the way, with dots at the gates.
std::string plot_of(const WayReport& report);

}  // namespace vdwmesh::apps
