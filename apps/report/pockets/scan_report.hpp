// What the report says of places for probes of all radii, of a way out, and of a shell between two
// probes: text, JSON, and tables.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "excluded/two_probe_shell.hpp"
#include "pockets/probe_scan.hpp"
#include "report/describe.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh::apps {

// Each has the names of its atoms, with blanks between.
struct ScanRow : ScanPlace {
  std::uint64_t rank = 0;  // from 1
  std::string gate_atoms;
};
struct GateRow : ProbeGate {
  std::string atoms;
};
struct WayRow : WayPoint {
  std::string atom;
};

struct ScanReport {
  double lowest = 0, highest = 0;  // Å
  bool is_complete = true;
  std::vector<double> probes;
  std::vector<std::uint64_t> voids;  // for each of the probes
  std::vector<ScanRow> places;
};

struct WayReport {
  std::string from;  // as it was asked for
  double length = 0, bottleneck = 0;
  std::string atoms;
  std::vector<GateRow> gates;
  std::vector<WayRow> points;
};

struct ShellRow : ShellPocket {
  std::uint64_t rank = 0;   // from 1, by falling volume
  std::string lining_text;  // names of lining atoms
};

// Volumes (Å³) of the excluded solids of two probes, and the pockets between them.
struct ShellReport {
  std::string set;
  double small_probe = 0, large_probe = 0;  // Å
  double complete_small = 0, exterior_small = 0, complete_large = 0, exterior_large = 0;
  std::optional<std::vector<ShellRow>> pockets = {};  // nothing if TwoProbeShell::doubt says why
};

ScanReport scan_report(const ProbeScan& scan, double lowest, double highest,
                       const Molecule& molecule);
WayReport way_report(const WayOut& way, const std::string& from, const Molecule& molecule);
ShellReport shell_report(const TwoProbeShell& shell, const Molecule& molecule);

std::string scan_text(const ScanReport& report);
std::string way_text(const WayReport& report);
std::string shell_text(const ShellReport& report);
// One row per place, per point of the way, and per pocket of the shell, with the shell's figures in
// each row; if there are no pockets, the shell's alone.
std::string scan_csv(const ScanReport& report);
std::string way_csv(const WayReport& report);
std::string shell_csv(const ShellReport& report);

template <class A>
void describe(A& a, const ScanRow& p) {
  a("place", p.rank), a("radius", p.radius);
  a("joins_at", p.gate ? std::optional(p.gate->radius) : std::nullopt);
  // 0 is the outside.
  const std::uint64_t other = p.joins ? *p.joins + 1 : 0;
  a("joins", p.gate ? std::optional(other) : std::nullopt);
  a("opens_at", p.opens_at);
  a("x", p.center.x), a("y", p.center.y), a("z", p.center.z);
  a("gate_atoms", p.gate_atoms);
}

template <class A>
void describe(A& a, const ScanReport& report) {
  a("lowest", report.lowest), a("highest", report.highest);
  a("is_complete", report.is_complete);
  a("probes", report.probes), a("voids", report.voids), a("places", report.places);
}

template <class A>
void describe(A& a, const GateRow& g) {
  a("radius", g.radius), a("x", g.center.x), a("y", g.center.y), a("z", g.center.z);
  a("atoms", g.atoms);
}

template <class A>
void describe(A& a, const WayRow& p) {
  a("along", p.along), a("radius", p.radius);
  a("x", p.center.x), a("y", p.center.y), a("z", p.center.z);
  a("atom", p.atom), a("gate", p.is_gate);
}

template <class A>
void describe(A& a, const WayReport& report) {
  a("from", report.from), a("length", report.length), a("bottleneck", report.bottleneck);
  a("atoms", report.atoms), a("gates", report.gates), a("points", report.points);
}

template <class A>
void describe(A& a, const ShellRow& p) {
  a("rank", p.rank), a("volume", p.volume), a("area", p.area);
  a("mouths", p.mouths), a("mouth_area", p.mouth_area);
  a("islands", p.islands), a("atoms", p.lining.size()), a("lining", p.lining_text);
}

template <class A>
void describe(A& a, const ShellReport& s) {
  a("set", s.set), a("small_probe", s.small_probe), a("large_probe", s.large_probe);
  a("complete_small", s.complete_small), a("exterior_small", s.exterior_small);
  a("complete_large", s.complete_large), a("exterior_large", s.exterior_large);
  a("shell_exterior", s.exterior_large - s.exterior_small);
  a("shell_complete", s.exterior_large - s.complete_small);
  a("pockets", s.pockets);
}

}  // namespace vdwmesh::apps
