// Writes what the page of a structure shows as one JSON object. Figures are described as in the
// report; atoms and residues stand in columns, which are short.
#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <tuple>

#include "build_id.hpp"
#include "core/sum.hpp"
#include "mesh/element_color.hpp"
#include "page/packed_mesh.hpp"
#include "report/describe_report.hpp"
#include "view/view.hpp"

namespace vdwmesh::apps {
namespace {

// Numbers texts in the order in which they are first met.
class NumberedTexts {
 public:
  std::size_t number_of(const std::string& value) {
    const auto [entry, is_new] = numbers_.try_emplace(value, values_.size());
    if (is_new) values_.push_back(value);
    return entry->second;
  }
  const std::vector<std::string>& values() const { return values_; }

 private:
  std::map<std::string, std::size_t> numbers_;
  std::vector<std::string> values_;
};

// A column of `of`, one value for each row.
template <class Rows, class Of>
auto column_of(const Rows& rows, const Of& of) {
  std::vector<std::decay_t<decltype(of(*rows.begin()))>> values;
  for (const auto& row : rows) values.push_back(of(row));
  return values;
}

// Thousandths of Å are finer than a pixel, and short.
double short_length(double length) { return std::round(length * 1000) / 1000; }

// The residues in the order of their first atoms, with the sums of the areas of their atoms.
struct ResidueColumns {
  std::vector<const Atom*> first;
  std::vector<WideSum> areas;
  std::vector<std::size_t> of_atom;
};

ResidueColumns residues_of(const StructureView& view) {
  ResidueColumns residues;
  std::map<std::tuple<std::int32_t, std::string_view, std::uint32_t>, std::size_t> known;
  for (std::size_t i = 0; i < view.molecule.atoms.size(); ++i) {
    const Atom& atom = view.molecule.atoms[i];
    const auto [entry, is_new] =
        known.try_emplace({atom.model, atom.chain.view(), atom.residue}, residues.first.size());
    if (is_new) residues.first.push_back(&atom), residues.areas.emplace_back();
    residues.areas[entry->second].add(view.areas[i]);
    residues.of_atom.push_back(entry->second);
  }
  return residues;
}

void write_atoms(JsonText& json, const StructureView& view, const ResidueColumns& residues) {
  const std::vector<Atom>& atoms = view.molecule.atoms;
  NumberedTexts elements;
  json.object("atoms", [&] {
    json("name", column_of(atoms, [](const Atom& a) { return a.name.str(); }));
    json("element", column_of(atoms, [&](const Atom& a) { return elements.number_of(a.element); }));
    json("serial", column_of(atoms, [](const Atom& a) { return a.serial; }));
    json("residue", residues.of_atom), json("area", view.areas);
    for (int axis = 0; axis < 3; ++axis) {
      json(std::string_view("xyz").substr(static_cast<std::size_t>(axis), 1),
           column_of(atoms, [&](const Atom& a) { return short_length(a.position[axis]); }));
    }
    json("radius", column_of(atoms, [](const Atom& a) { return a.radius; }));
  });
  json.object("residues", [&] {
    const auto& first = residues.first;
    json("chain", column_of(first, [&](const Atom* a) {
           return view.chains.of_atom[static_cast<std::size_t>(a - atoms.data())];
         }));
    json("number", column_of(first, [](const Atom* a) { return a->residue_number.str(); }));
    json("name", column_of(first, [](const Atom* a) { return a->residue_name.str(); }));
    json("area", column_of(residues.areas, [](const WideSum& sum) { return sum.value(); }));
  });
  json("chains", view.chains.names);
  json.list("elements", elements.values(), [&](const std::string& element) {
    const RgbColor color = element_color(element);
    json("element", element), json("color", std::vector<int>(color.begin(), color.end()));
  });
}

// Centres and radii of the spheres of a pocket, one after the other. Å.
std::vector<double> spheres_of(const PocketRow& pocket) {
  std::vector<double> numbers;
  for (const Sphere& s : pocket.alpha_spheres) {
    for (const double x : {s.center.x, s.center.y, s.center.z, s.radius + pocket.probe}) {
      numbers.push_back(short_length(x));
    }
  }
  return numbers;
}

void write_pockets_and_interfaces(JsonText& json, const StructureView& view) {
  json("pocket_probe", view.probe);
  json.list("pockets", view.report.pockets->pockets, [&](const PocketRow& pocket) {
    describe(json, pocket);
    json("lining_atoms", column_of(pocket.lining, [](const LiningSphere& s) { return s.id; }));
    json("spheres", spheres_of(pocket));
  });
  if (!view.report.interfaces) return;
  std::size_t number = 0;
  json.list("interfaces", *view.report.interfaces, [&](const InterfaceReport& interface) {
    describe(json, interface);
    json("buried_atoms_a", view.buried_a[number]);
    json("buried_atoms_b", view.buried_b[number++]);
  });
}

}  // namespace

std::string view_json(const StructureView& view, const std::string& name, const Box& box) {
  const Report& report = view.report;
  JsonText json(JsonText::Layout::compact);
  json("version", kVersion), json("name", name);
  json("input", report.input), json("exact", report.exact), json("excluded", report.excluded);
  write_atoms(json, view, residues_of(view));
  write_pockets_and_interfaces(json, view);
  json.object("mesh", [&] {
    describe_packed(json, view.display.mesh, box);
    json("has_kinds", !view.display.kinds.empty());
    json("follows_creases", !view.display.mesh.triangle_spheres.empty());
  });
  json("notes", report.notes), json("warnings", report.warnings);
  return std::move(json).take();
}

}  // namespace vdwmesh::apps
