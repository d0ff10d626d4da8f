// Structure files and radii for Python. A molecule is handed over as a dict of columns: one array
// for each member of its atoms, and what the reader says about the file.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <gemmi/model.hpp>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "arrays.hpp"
#include "call.hpp"
#include "core/errors.hpp"
#include "core/letters.hpp"
#include "errors.hpp"
#include "requests.hpp"
#include "structure/molecule/elements.hpp"
#include "structure/molecule/residue_elements.hpp"
#include "structure/molecule/site.hpp"
#include "structure/radii.hpp"
#include "structure/read/hierarchy.hpp"
#include "structure/read/parsed_file.hpp"
#include "structure/reader.hpp"
#include "structure/reference_areas.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

Array column(const Molecule& molecule, ShortText Atom::*member) {
  std::vector<std::string_view> texts;
  texts.reserve(molecule.atoms.size());
  for (const Atom& atom : molecule.atoms) texts.push_back(atom.*member);
  return array_of_text(texts);
}

Array coordinates(const Molecule& molecule) {
  auto rows = std::make_shared<std::vector<Vec3d>>();
  rows->reserve(molecule.atoms.size());
  for (const Atom& atom : molecule.atoms) rows->push_back(atom.position);
  const auto* first = reinterpret_cast<const double*>(rows->data());
  return array_of(rows, first, rows->size(), 3);
}

Array radii(const Molecule& molecule) {
  std::vector<double> list;
  list.reserve(molecule.atoms.size());
  for (const Atom& atom : molecule.atoms) list.push_back(atom.radius);
  return array_of(std::move(list));
}

Array residues(const Molecule& molecule) {
  std::vector<std::uint32_t> list;
  list.reserve(molecule.atoms.size());
  for (const Atom& atom : molecule.atoms) list.push_back(atom.residue);
  return array_of(std::move(list));
}

py::dict columns_of(const Molecule& molecule) {
  py::dict assumed;
  for (const AssumedRadius& a : molecule.radii_assumed) {
    assumed[text_of(a.atom_name.empty() ? a.element : a.residue_name + " " + a.atom_name)] =
        a.radius;
  }
  using namespace py::literals;
  return py::dict(
      "coords"_a = coordinates(molecule), "radii"_a = radii(molecule),
      "elements"_a = column(molecule, &Atom::element), "names"_a = column(molecule, &Atom::name),
      "resnames"_a = column(molecule, &Atom::residue_name),
      "resids"_a = column(molecule, &Atom::residue_number),
      "chains"_a = column(molecule, &Atom::chain), "left_out"_a = molecule.skipped,
      "assumed_radii"_a = assumed, "notes"_a = messages_of(molecule.notes),
      "warnings"_a = messages_of(molecule.warnings), "path"_a = text_of(molecule.path),
      "format"_a = molecule.format, "model"_a = text_of(molecule.model),
      "assembly"_a = text_of(molecule.assembly), "segments"_a = column(molecule, &Atom::segment),
      "residues"_a = residues(molecule), "radius_set"_a = molecule.radius_set);
}

// Reads by read(options), which stops at Ctrl-C.
template <class Read>
py::dict read_freely(const py::kwargs& given, const Read& read) {
  ReadOptions options = read_options_of(given);
  return columns_of(call({}, [&](Monitor& monitor) {
    options.monitor = &monitor;
    return read(options);
  }));
}

py::dict read_file(const std::string& path, const py::kwargs& given) {
  return read_freely(given,
                     [&](const ReadOptions& options) { return read_structure(path, options); });
}

py::dict read_bytes(const std::string& name, std::string_view bytes, const py::kwargs& given) {
  return read_freely(
      given, [&](const ReadOptions& options) { return read_structure(name, bytes, options); });
}

py::dict read_builtin(const std::string& name, const py::kwargs& given) {
  return read_freely(given, [&](const ReadOptions& options) { return read_sample(name, options); });
}

// The radius by element as users write it ("ZN", "zn", "Zn2+"); nothing if it is not known.
std::optional<double> radius(const RadiusTable& table, const std::string& residue,
                             const std::string& atom, const std::string& element) {
  const auto entry = table.find(residue, atom, element_of_symbol(element));
  return entry ? std::optional(entry->radius) : std::nullopt;
}

// The element that the names tell; "X" if they do not. Files of coordinates alone name atoms by
// their symbols, of which the second letter is small: "Ca" is calcium, and "CA" a carbon.
gemmi::Element named_element(const std::string& residue, const std::string& atom) {
  const bool is_symbol = atom.size() == 2 && is_capital(atom[0]) && is_small_letter(atom[1]);
  const char* symbol = is_symbol ? element_of_symbol(atom) : "X";
  const bool is_known = symbol != std::string_view("X");
  return gemmi::Element(is_known ? symbol : element_of_bare_name(atom, residue));
}

// The most hydrogens that an atom of the element carries in a force field that gives their mass to
// it, or takes mass from it for them; no other elements do either.
int most_hydrogens(gemmi::El element) {
  switch (element) {
    case gemmi::El::C:
    case gemmi::El::N:
      return 4;
    case gemmi::El::O:
      return 2;
    case gemmi::El::S:
      return 1;
    default:
      return 0;
  }
}

// Whether an atom of the element may have the mass in a force field: its own; that of a united atom
// with its hydrogens; or, where masses of hydrogens are three or four times their own, what is left
// beside them.
bool may_weigh(gemmi::Element element, double mass) {
  constexpr double kHydrogen = 1.008;  // u
  const double own = element.weight(), tolerance = 0.004 + 0.002 * own;
  const auto is_near = [&](double other) { return std::abs(mass - other) <= tolerance; };
  if (is_near(own)) return true;
  if (element.is_hydrogen())
    return is_near(2 * kHydrogen) || is_near(3 * kHydrogen) || is_near(4 * kHydrogen);
  for (int count = 1; count <= most_hydrogens(element.elem); ++count) {
    const double hydrogens = count * kHydrogen;
    if (is_near(own + hydrogens) || is_near(own - 2 * hydrogens) || is_near(own - 3 * hydrogens))
      return true;
  }
  return false;
}

// The symbol of an atom's element in an object of another package, and whether it is another than
// the one that the object has: symbol and names are weighed as those of a file are, which may be
// where the object has them from. "" for what is no atom.
std::pair<std::string, bool> weighed_element(const std::string& residue, const std::string& atom,
                                             const std::string& symbol) {
  AtomRecord record;
  record.hetero = true;  // may be of any residue
  record.element = gemmi::find_element(element_of_symbol(symbol));
  read_element(symbol, atom, NamePlace::word, residue, record);
  const bool is_known = record.element != gemmi::El::X;
  return {is_known ? gemmi::element_name(record.element) : "", bool{record.symbol_overruled}};
}

// The symbol of an atom's element, told by its names and its mass (u), of which any may be missing;
// "" if they tell none, or contradict each other and the mass is of no element.
std::string told_element(const std::string& residue, const std::string& atom,
                         std::optional<double> mass) {
  const gemmi::Element named = named_element(residue, atom);
  if (!mass || (named != gemmi::El::X && may_weigh(named, *mass)))
    return named == gemmi::El::X ? "" : named.name();
  for (int i = 1; i < static_cast<int>(gemmi::El::END); ++i) {
    const gemmi::Element element(static_cast<gemmi::El>(i));
    const double own = element.weight();
    if (own > 0 && std::abs(*mass - own) <= 0.004 + 0.002 * own) return element.name();
  }
  return "";
}

// An atom of a structure that another package read: chain and segment, residue number, residue
// name, atom name, label, occupancy.
using ForeignAtom =
    std::tuple<std::string, std::string, std::string, std::string, std::string, double>;

// The residue of the name at the last position of the chain; opens it if there is none. Atoms of
// residues that share a position may take turns. `first` is the index of the position's first.
std::size_t residue_at_end(std::vector<gemmi::Residue>& own, std::size_t first, int position,
                           const std::string& name) {
  for (std::size_t i = first; i < own.size(); ++i)
    if (own[i].name == name) return i;
  gemmi::Residue& added = own.emplace_back();
  added.name = name;
  added.seqid.num = position;
  return own.size() - 1;
}

// The indices of the atoms that stay where each has one location, as read() chooses them.
std::vector<std::size_t> highest_locations(const std::vector<ForeignAtom>& atoms) {
  ParsedFile file;
  file.structure = std::make_shared<gemmi::Structure>();
  file.structure->models.emplace_back("1");
  std::vector<gemmi::Chain>& chains = file.structure->models[0].chains;
  // Numbers of positions take the place of residue numbers, which may be of any kind. `before` are
  // the residues of the chains before, and `first` the first residue of the position in its chain.
  std::size_t before = 0, first = 0;
  int position = 0;
  std::string last_number;
  file.atoms.reserve(atoms.size());
  for (const auto& [chain, number, residue, name, label, occupancy] : atoms) {
    const bool opens_chain = chains.empty() || chains.back().name != chain;
    if (opens_chain && !chains.empty()) before += chains.back().residues.size();
    if (opens_chain) chains.emplace_back(chain);
    std::vector<gemmi::Residue>& own = chains.back().residues;
    if (opens_chain || number != last_number) first = own.size(), ++position;
    last_number = number;
    AtomRecord& record = file.atoms.emplace_back();
    record.name = name;
    record.residue =
        static_cast<std::uint32_t>(before + residue_at_end(own, first, position, residue));
    record.altloc = label.empty() || label == " " ? '\0' : label[0];
    record.occupancy = static_cast<float>(occupancy);
  }
  const std::vector<ResiduePlace> places = numbered_residues(*file.structure);
  Sites sites = all_sites(file, places);
  Molecule account;
  account.path = "coords";
  choose_alternate_locations(sites, "highest", account);
  std::vector<std::size_t> kept;
  for (const Site& site : sites)
    kept.push_back(static_cast<std::size_t>(site.atom - file.atoms.data()));
  std::ranges::sort(kept);
  return kept;
}

bool is_water(const std::string& residue) { return kind_of_residue(residue) == ResidueKind::water; }

// The reference for the relative area of a residue, Å²; nothing if the set has none.
std::optional<double> reference_area(const std::string& radius_set, const std::string& residue) {
  const auto areas = reference_areas(radius_set, residue);
  return areas ? std::optional(areas->total) : std::nullopt;
}

}  // namespace

void bind_structures(py::module_& module) {
  module.def("read_file", &read_file);
  module.def("read_bytes", &read_bytes);
  module.def("read_sample", &read_builtin);
  module.def("told_element", &told_element);
  module.def("weighed_element", &weighed_element);
  module.def("highest_locations", &highest_locations);
  module.def("is_water", &is_water);
  module.def("reference_area", &reference_area);
  module.attr("reference_probe") = kReferenceProbe;
  py::class_<RadiusTable>(module, "RadiusTable")
      .def(py::init(&RadiusTable::from_list))
      .def("find", &radius)
      .def("is_united", &RadiusTable::has_united_atoms);
}

}  // namespace vdwmesh::python
