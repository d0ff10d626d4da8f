// What the report says of pockets: text, JSON, and a table.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pockets/pockets.hpp"
#include "report/describe.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh::apps {

struct LiningResidue {
  std::string residue;  // "A/LEU 50"
  double area;          // Å²
};

// A pocket as a row: with its place in the table and the names of its atoms.
struct PocketRow : Pocket {
  std::string set;                             // what was read, without folder and extension
  double probe = 0;                            // Å
  std::uint64_t rank = 0;                      // from 1, by falling volume
  std::string lining_text;                     // names of lining atoms, with blanks between
  std::vector<LiningResidue> lining_residues;  // by falling area; none if the file has no residues
  PocketMeasures measures = PocketMeasures::exact;
};

// A mouth with what of it was measured.
struct MouthRow : Mouth {
  PocketMeasures measures = PocketMeasures::exact;
};

struct PocketReport {
  std::vector<PocketRow> pockets;
  std::uint64_t empty_tetrahedra = 0, face_ties = 0, cell_ties = 0;  // as in PocketTable
};

// The warning of so many ties.
inline constexpr const char* kPocketTies =
    "{} orthogonal centres lie exactly in a face: the pockets depend on how such ties are broken; "
    "move the atoms a little to see how much";

PocketReport pocket_report(const PocketTable& table, const Molecule& molecule, double probe,
                           PocketMeasures measures = PocketMeasures::exact);

// "4HHB" of "folder/4HHB.cif.gz".
std::string set_name(const std::string& path);

std::string pocket_text(const PocketReport& report);
// One row per pocket, the largest first.
std::string pocket_csv(const PocketReport& report);

// Where only sums were taken, there is no exact figure.
inline std::optional<double> if_exact(PocketMeasures measures, double figure) {
  return measures == PocketMeasures::exact ? std::optional(figure) : std::nullopt;
}

template <class A>
void describe(A& a, const MouthRow& mouth) {
  a("area", if_exact(mouth.measures, mouth.area)), a("rim", if_exact(mouth.measures, mouth.rim));
  a("area_sum", mouth.area_sum), a("rim_sum", mouth.rim_sum);
  a("center", std::vector{mouth.center.x, mouth.center.y, mouth.center.z});
  a("faces", mouth.faces);
}

template <class A>
void describe(A& a, const LiningResidue& r) {
  a("residue", r.residue), a("area", r.area);
}

// The sum of a figure over all mouths.
template <class Member>
Member sum_over_mouths(const Pocket& pocket, Member Mouth::*member) {
  Member sum = 0;
  for (const Mouth& mouth : pocket.mouths) sum += mouth.*member;
  return sum;
}

// One description makes the columns of the table and the members of the JSON, which alone has
// lists.
template <class A>
void describe(A& a, const PocketRow& p) {
  a("set", p.set), a("probe", p.probe), a("rank", p.rank), a("kind", kind_name(p.kind));
  a("volume", if_exact(p.measures, p.volume)), a("area", if_exact(p.measures, p.area));
  a("mouths", p.mouths.size());
  a("mouth_area", if_exact(p.measures, sum_over_mouths(p, &Mouth::area)));
  a("mouth_rim", if_exact(p.measures, sum_over_mouths(p, &Mouth::rim)));
  a("atoms", p.spheres), a("tetrahedra", p.tetrahedra), a("sinks", p.sinks);
  const auto grown = [&](std::optional<double> clearance) {
    return clearance ? std::optional(*clearance + p.probe) : std::nullopt;
  };
  a("depth_alpha", p.depth_alpha), a("depth_probe", grown(p.clearance));
  a("depth_radius", p.clearance), a("bottleneck_alpha", p.bottleneck_alpha);
  a("bottleneck_radius", grown(p.bottleneck_clearance));
  a("margin", probe_margin(p));
  a("depth_x", p.clear_place.x), a("depth_y", p.clear_place.y), a("depth_z", p.clear_place.z);
  // Room of the excluded surface, by pocket, is not computed.
  a("ms_volume", std::optional<double>()), a("ms_area", std::optional<double>());
  a("mouth_faces", sum_over_mouths(p, &Mouth::faces)), a("poked_faces", p.poked_faces);
  a("volume_sum", p.volume_sum), a("area_sum", p.area_sum);
  a("mouth_area_sum", sum_over_mouths(p, &Mouth::area_sum));
  a("mouth_rim_sum", sum_over_mouths(p, &Mouth::rim_sum));
  a("lining", p.lining_text);
  std::vector<double> areas;
  for (const LiningSphere& s : p.lining) areas.push_back(s.area);
  std::vector<MouthRow> mouths;
  for (const Mouth& m : p.mouths) mouths.push_back({m, p.measures});
  a("lining_areas", areas), a("lining_residues", p.lining_residues), a("mouth_table", mouths);
}

template <class A>
void describe(A& a, const PocketReport& report) {
  a("empty_tetrahedra", report.empty_tetrahedra);
  a("face_ties", report.face_ties), a("cell_ties", report.cell_ties);
  a("pockets", report.pockets);
}

}  // namespace vdwmesh::apps
