// Makes rows of pockets, and lays them out for people.
#include "report/pockets/pocket_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <utility>

#include "report/atom_names.hpp"
#include "report/csv.hpp"
#include "report/report_text_parts.hpp"

namespace vdwmesh::apps {
namespace {

Cells cells_of(const PocketRow& row) {
  Cells cells(csv_number);
  describe(cells, row);
  return cells;
}

std::uint64_t count_of(const PocketReport& report, PocketKind kind) {
  return static_cast<std::uint64_t>(std::ranges::count(report.pockets, kind, &PocketRow::kind));
}

std::vector<LiningResidue> residues_of(const std::vector<LiningSphere>& lining,
                                       const Molecule& molecule) {
  std::map<std::pair<std::string, std::uint32_t>, LiningResidue>
      residues;  // of each copy of a chain
  for (const LiningSphere& sphere : lining) {
    const Atom& atom = molecule.atoms[sphere.id];
    if (atom.residue_name.empty()) continue;
    const auto name = fmt::format("{}/{} {}", atom.chain.view(), atom.residue_name.view(),
                                  atom.residue_number.view());
    const std::pair key(std::string(atom.chain.view()), atom.residue);
    residues.try_emplace(key, LiningResidue{name, 0}).first->second.area += sphere.area;
  }
  std::vector<LiningResidue> out;
  for (const auto& [key, residue] : residues) out.push_back(residue);
  std::ranges::stable_sort(out, std::greater<>(), &LiningResidue::area);
  return out;
}

}  // namespace

std::string set_name(const std::string& path) {
  std::filesystem::path name = std::filesystem::path(path).filename();
  if (name.extension() == ".gz") name = name.stem();
  return name.stem().string();
}

PocketReport pocket_report(const PocketTable& table, const Molecule& molecule, double probe,
                           PocketMeasures measures) {
  PocketReport report{{}, table.empty_tetrahedra, table.face_ties, table.cell_ties};
  for (const Pocket& pocket : table.pockets) {
    std::string lining;
    for (const LiningSphere& sphere : pocket.lining) {
      if (!lining.empty()) lining += ' ';
      lining += name_of_atom(molecule, sphere.id);
    }
    PocketRow& row = report.pockets.emplace_back();
    static_cast<Pocket&>(row) = pocket;
    row.set = set_name(molecule.path);
    row.probe = probe;
    row.rank = report.pockets.size();
    row.lining_text = lining;
    row.lining_residues = residues_of(pocket.lining, molecule);
    row.measures = measures;
  }
  return report;
}

std::string pocket_csv(const PocketReport& report) {
  std::vector<Cells> rows;
  for (const PocketRow& row : report.pockets) rows.push_back(cells_of(row));
  return csv_table(cells_of({}).names(), rows);
}

// The largest rows; the table has all. "fits" is the largest probe in the pocket, "exit"
// the largest that leaves it.
std::string pocket_text(const PocketReport& report) {
  constexpr std::size_t kShown = 20;
  std::string text;
  const Text out = std::back_inserter(text);
  line(out, "Pockets",
       fmt::format("{}: with one mouth: {}, channels: {}, voids: {}; ties: {}",
                   report.pockets.size(), count_of(report, PocketKind::pocket),
                   count_of(report, PocketKind::channel), count_of(report, PocketKind::enclosed),
                   report.face_ties));
  if (report.pockets.empty()) return text;
  if (report.pockets.front().measures == PocketMeasures::sums)
    line(out, "Measures", "CASTp's sums, which are exact for voids alone");
  fmt::format_to(out, "\n{:>6}  {:<8}{:>12}{:>12}{:>8}{:>12}{:>8}{:>8}{:>10}{:>7}  {}\n", "",
                 "kind", "volume Å³", "area Å²", "mouths", "open Å²", "fits Å", "exit Å",
                 "margin Å", "atoms", "deepest place");
  for (const PocketRow& p : report.pockets) {
    if (p.rank > kShown) break;
    const auto radius = [&](std::optional<double> clearance) {
      return clearance ? fmt::format("{:.3f}", *clearance + p.probe) : "–";
    };
    const auto margin = probe_margin(p);
    fmt::format_to(
        out,
        "{:>6}  {:<8}{:>12.3f}{:>12.3f}{:>8}{:>12.3f}{:>8}{:>8}{:>10}{:>7}  {:.2f} {:.2f} "
        "{:.2f}\n",
        p.rank, kind_name(p.kind), p.volume, p.area, p.mouths.size(),
        sum_over_mouths(p, &Mouth::area), radius(p.clearance), radius(p.bottleneck_clearance),
        margin ? fmt::format("{:.4f}", *margin) : "–", p.spheres, p.clear_place.x, p.clear_place.y,
        p.clear_place.z);
  }
  if (report.pockets.size() > kShown) {
    fmt::format_to(out, "{:>6}  {} more; -o FILE.csv has all\n", "",
                   report.pockets.size() - kShown);
  }
  return text;
}

}  // namespace vdwmesh::apps
