// The answer of a report in about ten lines, in the order in which a reader asks: of which atoms,
// with which radii, how large is the surface and how is it connected, exactly and as a mesh. What
// was not computed has no line.
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "command_line/names.hpp"
#include "report/report_text_parts.hpp"

namespace vdwmesh::apps {
namespace {

std::string none_or(const std::vector<std::string>& parts) {
  return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", "));
}

// "4384 protein, 172 HEM, 2 PO4"; of atoms without residues their number.
std::string kept_text(const InputReport& input) {
  constexpr std::size_t kMostNamed = 8;
  if (input.kept.empty())
    return fmt::format("{} used of {} read", input.atoms_used, input.atoms_read);
  std::vector<std::string> parts;
  std::uint64_t others = 0;
  for (const KeptAtoms& kept : input.kept) {
    if (parts.size() < kMostNamed)
      parts.push_back(fmt::format("{} {}", kept.atoms, kept.kind));
    else
      others += kept.atoms;
  }
  if (others > 0)
    parts.push_back(fmt::format("{} of {} other residues", others, input.kept.size() - kMostNamed));
  return fmt::format("{}", fmt::join(parts, ", "));
}

// Reasons for which nothing was left out are not mentioned.
std::string atoms_text(const InputReport& input) {
  std::vector<std::string> skipped;
  for (const auto& [reason, count] : input.skipped) {
    std::string words = reason;
    std::ranges::replace(words, '_', ' ');
    if (count > 0) skipped.push_back(fmt::format("{} {}", count, words));
  }
  const std::string copies =
      input.spheres == input.atoms_used ? "" : fmt::format("; copied to {} spheres", input.spheres);
  return fmt::format("{}; left out: {}{}", kept_text(input), none_or(skipped), copies);
}

// By element, or by residue where the set goes by residue and atom; the JSON has every atom name.
std::vector<std::string> assumed_text(const std::vector<AssumedRadius>& assumed) {
  std::vector<std::string> parts;
  std::map<std::string, std::uint64_t> by_residue;
  for (const AssumedRadius& radius : assumed) {
    if (!radius.residue_name.empty() || !radius.atom_name.empty()) {
      by_residue[radius.residue_name] += radius.count;
    } else {
      parts.push_back(fmt::format("{} {} Å ({})", radius.element, radius.radius,
                                  counted(radius.count, "atom")));
    }
  }
  for (const auto& [residue, count] : by_residue) {
    parts.push_back(fmt::format("{} by element ({})", residue, counted(count, "atom")));
  }
  return parts;
}

// What the probe makes of the balls.
std::string surface_name(const Report& report) {
  const auto& made = report.parameters;
  if (made && made->surface.mesher == Mesher::marching_cubes &&
      made->surface.field.kind != FieldKind::vdw)
    return fmt::format("isosurface of the field {}", name_of(made->surface.field.kind));
  if (report.excluded || (made && made->surface.kind == ExactSurface::excluded))
    return "solvent-excluded surface";
  if (report.input.probe < 0) return "surface of balls made smaller";
  return report.input.probe > 0 ? "solvent-accessible surface" : "van der Waals surface";
}

// The set, and why an atom has its radius.
std::string radii_text(const Report& report) {
  const InputReport& input = report.input;
  const std::string why = input.radius_set == "file" ? "as the file has them"
                          : input.has_polarity       ? "of atoms with their hydrogens"
                                                     : "by the element of each atom";
  const std::vector<std::string> assumed = assumed_text(input.radii_assumed);
  return fmt::format("{}, probe {} Å: {}; {}{}{}", input.radius_set, input.probe,
                     surface_name(report), why,
                     assumed.empty() ? "" : "; assumed: ", fmt::join(assumed, ", "));
}

std::string count_or_no(std::uint64_t count, std::string_view noun) {
  return count == 0 ? fmt::format("no {}s", noun) : counted(count, noun);
}

// "1 piece, 54 tunnels, no voids".
std::string shape_text(std::uint64_t pieces, std::uint64_t tunnels, std::uint64_t voids) {
  return fmt::format("{}, {}, {}", counted(pieces, "piece"), count_or_no(tunnels, "tunnel"),
                     count_or_no(voids, "void"));
}

std::string exact_shape_text(const ExactReport& exact) {
  if (const auto& t = exact.topology) return shape_text(t->components, t->tunnels, t->voids);
  if (const auto& c = exact.counts)
    return fmt::format("{}, Euler characteristic {}", counted(c->components, "piece"),
                       c->euler_characteristic);
  if (exact.doubtful_spheres.value_or(0) == 0) return "";
  return fmt::format(
      "not counted, because rounding might decide about {} atoms; --topology full is exact",
      *exact.doubtful_spheres);
}

std::string excluded_shape_text(const ExcludedSurface& surface) {
  if (surface.topology) {
    const ShellFigures f = shell_figures(*surface.topology);
    return shape_text(f.outer, static_cast<std::uint64_t>(f.genus), f.walls);
  }
  if (!surface.euler_characteristic) return "";
  return fmt::format("Euler characteristic {}", *surface.euler_characteristic);
}

std::string mesh_shape_text(const MeshTopology& mesh) {
  if (!mesh.components || !mesh.voids || !mesh.genus)
    return fmt::format("{}, Euler characteristic {}", counted(mesh.shells, "shell"),
                       mesh.euler_characteristic);
  return shape_text(*mesh.components, static_cast<std::uint64_t>(*mesh.genus), *mesh.voids);
}

// Area and volume; of the excluded surface also without its cavities.
std::pair<std::string, std::string> exact_sizes(const Report& report) {
  if (const auto& exact = report.exact) {
    std::string area = fmt::format("{} Å²", figure_text(exact->area));
    if (const auto& p = exact->by_polarity)
      area += fmt::format(" ({} polar, {} apolar{})", figure_text(p->polar), figure_text(p->apolar),
                          p->unclassified > 0
                              ? fmt::format(", {} unclassified", figure_text(p->unclassified))
                              : "");
    if (exact->topology && exact->topology->voids > 0)
      area += fmt::format(", {} of them walls of voids", figure_text(exact->topology->void_area));
    return {area, fmt::format("{} Å³", figure_text(exact->volume))};
  }
  const ExcludedSurface& s = report.excluded->complete;
  std::string area = fmt::format("{} Å²", figure_text(s.area)),
              volume = fmt::format("{} Å³", figure_text(s.volume));
  const auto& outside = report.excluded->exterior;
  if (outside && s.topology && s.topology->cavities > 0) {
    area += fmt::format(", {} without the walls of voids", figure_text(outside->area));
    volume += fmt::format(", {} with the voids filled", figure_text(outside->volume));
  }
  return {area, volume};
}

std::string in_brackets(const std::string& text) {
  return text.empty() ? "" : fmt::format(" ({})", text);
}

// The same of the mesh, with how far it is off.
std::pair<std::string, std::string> mesh_sizes(const Report& report) {
  const MeshMeasures& mesh = report.mesh->measures;
  const auto& c = report.comparison;
  const std::string area = c ? percent(c->area_relative_error) : "",
                    volume = c ? percent(c->volume_relative_error) : "";
  return {fmt::format("mesh {} Å²{}", figure_text(mesh.area), in_brackets(area)),
          mesh.volume ? fmt::format("mesh {} Å³{}", figure_text(*mesh.volume), in_brackets(volume))
                      : ""};
}

bool is_proven_alike(const Report& report) {
  const auto& c = report.comparison;
  return c && c->proof && c->proof->topology_is_exact.value_or(false);
}

std::string joined(const std::string& exact, const std::string& mesh) {
  return exact + (exact.empty() || mesh.empty() ? "" : "; ") + mesh;
}

// Exact figures first, those of the mesh beside them.
void sizes_text(Text out, const Report& report) {
  std::pair<std::string, std::string> exact, mesh;
  std::string shape;
  if (report.exact) shape = exact_shape_text(*report.exact);
  if (report.excluded) shape = excluded_shape_text(report.excluded->complete);
  if (report.exact || report.excluded) exact = exact_sizes(report);
  if (report.mesh) {
    mesh = mesh_sizes(report);
    const std::string of_mesh = mesh_shape_text(report.mesh->topology);
    const bool is_alike = !shape.empty() && (shape == of_mesh || is_proven_alike(report));
    shape = joined(shape, "mesh " + (is_alike ? "alike" : of_mesh));
  }
  if (const std::string area = joined(exact.first, mesh.first); !area.empty())
    line(out, "Area", area);
  if (const std::string volume = joined(exact.second, mesh.second); !volume.empty())
    line(out, "Volume", volume);
  if (!shape.empty()) line(out, "Topology", shape);
}

// The ends of the intervals with all their digits: rounded ones might not contain the value.
void certificate_text(Text out, const UnionCertificate& certificate) {
  line(out, "Certified",
       fmt::format("area {} to {} Å²", certificate.area.lower, certificate.area.upper));
  line(out, "",
       fmt::format("volume {} to {} Å³", certificate.volume.lower, certificate.volume.upper));
}

// Says which figures are of the chosen atoms, where --measure chose some.
void measured_text(Text out, const InputReport& input) {
  if (!input.measure) return;
  line(out, "Measured",
       fmt::format("exact area and volume of {} of {} spheres, those of {}; the others cover them, "
                   "and all else is of all spheres",
                   input.measured, input.spheres, *input.measure));
}

}  // namespace

std::string counted(std::uint64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

void answer_text(Text out, const Report& report) {
  const InputReport& input = report.input;
  line(out, "Structure",
       fmt::format(
           "{} ({}), model {}, {}", input.path, input.format, input.model,
           input.assembly == "asymmetric" ? "asymmetric unit" : "assembly " + input.assembly));
  line(out, "Atoms", atoms_text(input));
  line(out, "Radii", radii_text(report));
  measured_text(out, input);
  sizes_text(out, report);
  if (report.exact && report.exact->certificate) certificate_text(out, *report.exact->certificate);
  if (report.mesh) line(out, "Mesh", mesh_line(*report.mesh));
  if (report.comparison && report.comparison->distances) {
    const MeshDistances& d = *report.comparison->distances;
    line(out, "Distance",
         fmt::format("{:.5f} Å from mesh to surface on average; largest found {:.5f} Å",
                     d.mesh_to_surface.mean, d.hausdorff_lower_bound));
  }
}

}  // namespace vdwmesh::apps
