// Plots are lines in a frame with marks on both axes; units in the frame are those of the figures.
#include "report/pockets/scan_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "core/letters.hpp"

namespace vdwmesh::apps {
namespace {

// A range of figures, and where its ends lie on the page (pixels).
struct Axis {
  double low, high;
  double at_low, at_high;

  double at(double value) const {
    return at_low + (value - low) / (high - low) * (at_high - at_low);
  }
};

constexpr double kLeft = 60, kRight = 760, kTop = 20, kWidth = 800;

// 1, 2 or 5 times a power of ten, of which some five are in the range.
double step_of(const Axis& axis) {
  const double rough = (axis.high - axis.low) / 5,
               ten = std::pow(10, std::floor(std::log10(rough)));
  for (const double times : {1.0, 2.0, 5.0}) {
    if (rough <= times * ten) return times * ten;
  }
  return 10 * ten;
}

class Plot {
 public:
  Plot(const Axis& x, const Axis& y) : x_(x), y_(y) {
    fmt::format_to(out(),
                   "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
                   "viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" font-size=\"12\">\n"
                   "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
                   kWidth, y.at_low + 50);
  }

  void mark_x(std::string_view name) {
    const double step = step_of(x_);
    for (double k = std::ceil(x_.low / step); k * step <= x_.high; ++k) {
      stroke(k * step, y_.low, k * step, y_.high, "#dddddd");
      text(x_.at(k * step), y_.at_low + 18, fmt::format("{:.6g}", k * step));
    }
    text((x_.at_low + x_.at_high) / 2, y_.at_low + 38, name);
  }

  void mark_y(std::string_view name) {
    const double step = step_of(y_);
    for (double k = std::ceil(y_.low / step); k * step <= y_.high; ++k) {
      stroke(x_.low, k * step, x_.high, k * step, "#dddddd");
      text(kLeft / 2, y_.at(k * step) + 4, fmt::format("{:.6g}", k * step));
    }
    text(kLeft, kTop - 6, name);
  }

  void stroke(double x0, double y0, double x1, double y1, std::string_view color) {
    fmt::format_to(out(), "<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\" stroke=\"{}\"/>\n", x_.at(x0),
                   y_.at(y0), x_.at(x1), y_.at(y1), color);
  }

  void dot(double x, double y, std::string_view title) {
    fmt::format_to(out(),
                   "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"3\" fill=\"#d55e00\"><title>{}"
                   "</title></circle>\n",
                   x_.at(x), y_.at(y), title);
  }

  std::string take() && { return std::move(text_) + "</svg>\n"; }

 private:
  std::back_insert_iterator<std::string> out() { return std::back_inserter(text_); }

  void text(double x, double y, std::string_view words) {
    fmt::format_to(out(), "<text x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"middle\">{}</text>\n", x,
                   y, words);
  }

  Axis x_, y_;
  std::string text_;
};

// Places so that those which join one stand behind it: the row of each.
std::vector<double> rows_of(const std::vector<ScanRow>& places) {
  std::vector<std::vector<std::size_t>> joined(places.size());
  std::vector<std::size_t> open;
  for (std::size_t i = places.size(); i-- > 0;) {
    (places[i].joins ? joined[*places[i].joins] : open).push_back(i);
  }
  std::vector<double> rows(places.size());
  for (double row = 0; !open.empty(); ++row) {
    const std::size_t i = open.back();
    open.pop_back();
    rows[i] = row;
    open.insert(open.end(), joined[i].begin(), joined[i].end());
  }
  return rows;
}

// Names of atoms may hold what SVG has a meaning for.
std::string plain(const std::string& words) {
  std::string text;
  for (const char c : words) text += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return text;
}

constexpr const char* kLine = "#0072b2";

}  // namespace

bool is_plot(const std::filesystem::path& path) {
  return lower_case(path.extension().string()) == ".svg";
}

std::string plot_of(const ScanReport& report) {
  constexpr double kRow = 5;  // pixels
  const auto count = static_cast<double>(report.places.size());
  const double largest = report.places.empty() ? report.highest : report.places.front().radius;
  const Axis x{report.lowest, largest, kLeft, kRight};
  const Axis y{count, -1, kTop + kRow * (count + 1), kTop};
  Plot plot(x, y);
  plot.mark_x("radius of the probe, Å");
  const std::vector<double> rows = rows_of(report.places);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ScanRow& place = report.places[i];
    const double end = place.gate ? place.gate->radius : report.lowest;
    plot.stroke(end, rows[i], place.radius, rows[i], kLine);
    if (place.joins) plot.stroke(end, rows[i], end, rows[*place.joins], kLine);
    if (place.gate && !place.joins)
      plot.dot(end, rows[i],
               fmt::format("place {}: {:.4f} Å, {}", place.rank, end, plain(place.gate_atoms)));
  }
  return std::move(plot).take();
}

std::string plot_of(const WayReport& report) {
  constexpr double kHeight = 400, kLeast = 1e-3;  // Å: a way of one point has a length too
  double widest = kLeast;
  for (const WayRow& p : report.points) widest = std::max(widest, p.radius);
  Plot plot({0, std::max(report.length, kLeast), kLeft, kRight}, {0, widest, kHeight, kTop});
  plot.mark_x("along the way, Å");
  plot.mark_y("radius, Å");
  for (std::size_t i = 1; i < report.points.size(); ++i) {
    const WayRow &a = report.points[i - 1], &b = report.points[i];
    plot.stroke(a.along, a.radius, b.along, b.radius, kLine);
  }
  for (const WayRow& p : report.points) {
    if (p.is_gate)
      plot.dot(p.along, p.radius, fmt::format("{:.4f} Å, {}", p.radius, plain(p.atom)));
  }
  return std::move(plot).take();
}

}  // namespace vdwmesh::apps
