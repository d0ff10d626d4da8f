// Makes rows of places, ways and shells, and lays them out for people.
#include "report/pockets/scan_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "report/atom_names.hpp"
#include "report/csv.hpp"
#include "report/pockets/pocket_report.hpp"
#include "report/report_text_parts.hpp"

namespace vdwmesh::apps {
namespace {

template <class Ids>
std::string names_of(const Ids& ids, const Molecule& molecule) {
  std::string text;
  for (const SphereId id : ids) {
    if (!text.empty()) text += ' ';
    text += name_of_atom(molecule, id);
  }
  return text;
}

template <class Row>
std::string table_of(const std::vector<Row>& rows) {
  const auto cells_of = [](const Row& row) {
    Cells cells(csv_number);
    describe(cells, row);
    return cells;
  };
  std::vector<Cells> cells;
  for (const Row& row : rows) cells.push_back(cells_of(row));
  return csv_table(cells_of(Row{}).names(), cells);
}

}  // namespace

ScanReport scan_report(const ProbeScan& scan, double lowest, double highest,
                       const Molecule& molecule) {
  ScanReport report;
  report.lowest = lowest, report.highest = highest;
  report.is_complete = scan.is_complete;
  for (const auto& [probe, voids] : scan.voids) {
    report.probes.push_back(probe);
    report.voids.push_back(voids);
  }
  for (const ScanPlace& place : scan.places) {
    ScanRow& row = report.places.emplace_back();
    static_cast<ScanPlace&>(row) = place;
    row.rank = report.places.size();
    if (place.gate) row.gate_atoms = names_of(place.gate->spheres, molecule);
  }
  return report;
}

WayReport way_report(const WayOut& way, const std::string& from, const Molecule& molecule) {
  WayReport report;
  report.from = from;
  report.length = way.length, report.bottleneck = way.bottleneck;
  report.atoms = names_of(way.spheres, molecule);
  for (const ProbeGate& gate : way.gates) {
    report.gates.push_back({gate, names_of(gate.spheres, molecule)});
  }
  for (const WayPoint& point : way.points) {
    report.points.push_back({point, name_of_atom(molecule, point.nearest)});
  }
  return report;
}

ShellReport shell_report(const TwoProbeShell& shell, const Molecule& molecule) {
  ShellReport report{.set = set_name(molecule.path),
                     .small_probe = shell.small.probe,
                     .large_probe = shell.large.probe,
                     .complete_small = shell.small.complete.volume,
                     .exterior_small = shell.small.exterior->volume,
                     .complete_large = shell.large.complete.volume,
                     .exterior_large = shell.large.exterior->volume};
  if (!shell.doubt.empty()) return report;
  report.pockets.emplace();
  for (const ShellPocket& pocket : shell.pockets) {
    ShellRow& row = report.pockets->emplace_back();
    static_cast<ShellPocket&>(row) = pocket;
    row.rank = report.pockets->size();
    row.lining_text = names_of(pocket.lining, molecule);
  }
  return report;
}

// The places for the largest probes; the table has all.
std::string scan_text(const ScanReport& report) {
  constexpr std::size_t kShown = 20;
  std::string text;
  const Text out = std::back_inserter(text);
  line(out, "Places",
       fmt::format("{} for probes of {} to {} Å", report.places.size(), report.lowest,
                   report.highest));
  std::string voids;
  for (std::size_t i = 0; i < report.probes.size(); ++i) {
    voids += fmt::format("{}{:.3f} Å: {}", i == 0 ? "" : ", ", report.probes[i], report.voids[i]);
  }
  line(out, "Voids", voids);
  if (report.places.empty()) return text;
  fmt::format_to(out, "\n{:>6}{:>9}{:>12}{:>8}{:>12}  {:<24}  {}\n", "", "fits Å", "joins at Å",
                 "place", "opens at Å", "center", "gate");
  for (const ScanRow& p : report.places) {
    if (p.rank > kShown) break;
    const auto number = [](std::optional<double> x) { return x ? fmt::format("{:.4f}", *x) : "–"; };
    const std::string joins = p.joins ? fmt::format("{}", *p.joins + 1) : p.gate ? "outside" : "–";
    const auto gate = p.gate ? std::optional(p.gate->radius) : std::nullopt;
    fmt::format_to(out, "{:>6}{:>9.4f}{:>12}{:>8}{:>12}  {:<24}  {}\n", p.rank, p.radius,
                   number(gate), joins, number(p.opens_at),
                   fmt::format("{:.2f} {:.2f} {:.2f}", p.center.x, p.center.y, p.center.z),
                   p.gate_atoms);
  }
  if (report.places.size() > kShown) {
    fmt::format_to(out, "{:>6}  {} more; -o FILE.csv has all\n", "", report.places.size() - kShown);
  }
  return text;
}

std::string way_text(const WayReport& report) {
  std::string text;
  const Text out = std::back_inserter(text);
  line(out, "Way out",
       fmt::format("from {}: {:.2f} Å long, narrowest {:.4f} Å, {} gates", report.from,
                   report.length, report.bottleneck, report.gates.size()));
  for (const GateRow& g : report.gates) {
    line(out, "  gate",
         fmt::format("{:.4f} Å at {:.2f} {:.2f} {:.2f}: {}", g.radius, g.center.x, g.center.y,
                     g.center.z, g.atoms));
  }
  line(out, "  atoms", report.atoms);
  return text;
}

// The largest pockets; the table has all.
std::string shell_text(const ShellReport& s) {
  constexpr std::size_t kShown = 20;
  std::string text;
  const Text out = std::back_inserter(text);
  line(out, "Shell",
       fmt::format("{:.3f} Å³ for a probe of {} Å and not for one of {} Å, without cavities; with "
                   "those of the small probe {:.3f} Å³",
                   s.exterior_large - s.exterior_small, s.small_probe, s.large_probe,
                   s.exterior_large - s.complete_small));
  if (!s.pockets) return text;
  line(out, "Pockets",
       fmt::format("{}, which sum to the shell without cavities", s.pockets->size()));
  if (s.pockets->empty()) return text;
  fmt::format_to(out, "\n{:>6}{:>14}{:>12}{:>8}{:>12}{:>7}\n", "", "volume Å³", "walls Å²",
                 "mouths", "open Å²", "atoms");
  for (const ShellRow& p : *s.pockets) {
    if (p.rank > kShown) break;
    fmt::format_to(out, "{:>6}{:>14.3f}{:>12.3f}{:>8}{:>12.3f}{:>7}\n", p.rank, p.volume, p.area,
                   p.mouths, p.mouth_area, p.lining.size());
  }
  if (s.pockets->size() > kShown) {
    fmt::format_to(out, "{:>6}  {} more; -o FILE.csv has all\n", "", s.pockets->size() - kShown);
  }
  return text;
}

std::string scan_csv(const ScanReport& report) { return table_of(report.places); }
std::string way_csv(const WayReport& report) { return table_of(report.points); }
std::string shell_csv(const ShellReport& report) {
  const auto cells_of = [&](const std::optional<ShellRow>& pocket) {
    Cells cells(csv_number);
    describe(cells, report);
    cells("pocket", pocket);
    return cells;
  };
  std::vector<Cells> rows;
  for (const ShellRow& pocket : report.pockets.value_or(std::vector<ShellRow>{})) {
    rows.push_back(cells_of(pocket));
  }
  if (rows.empty()) rows.push_back(cells_of(std::nullopt));
  return csv_table(rows.front().names(), rows);
}

}  // namespace vdwmesh::apps
