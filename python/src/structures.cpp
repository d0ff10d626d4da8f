// Structure files and radii for Python. A molecule is handed over as a dict of columns: one array
// for each member of its atoms, and what the reader says about the file.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "arrays.hpp"
#include "call.hpp"
#include "core/errors.hpp"
#include "options.hpp"
#include "structure/elements.hpp"
#include "structure/radii.hpp"
#include "structure/reader.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

StructureFormat format_of(const std::string& name) {
  static const std::map<std::string, StructureFormat, std::less<>> formats{
      {"", StructureFormat::by_extension}, {"pdb", StructureFormat::pdb},
      {"mmcif", StructureFormat::mmcif},   {"cif", StructureFormat::mmcif},
      {"bcif", StructureFormat::bcif},     {"pqr", StructureFormat::pqr},
      {"xyzr", StructureFormat::xyzr}};
  const auto found = formats.find(name);
  if (found != formats.end()) return found->second;
  throw InvalidInput(fmt::format("format: {}; there are pdb, mmcif, bcif, pqr and xyzr", name));
}

Inclusion inclusion_of(bool kept) { return kept ? Inclusion::keep : Inclusion::drop; }

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
  std::map<std::string, double> assumed;
  for (const AssumedRadius& a : molecule.radii_assumed) {
    assumed[a.atom_name.empty() ? a.element : a.residue_name + " " + a.atom_name] = a.radius;
  }
  using namespace py::literals;
  return py::dict(
      "coords"_a = coordinates(molecule), "radii"_a = radii(molecule),
      "elements"_a = column(molecule, &Atom::element), "names"_a = column(molecule, &Atom::name),
      "resnames"_a = column(molecule, &Atom::residue_name),
      "resids"_a = column(molecule, &Atom::residue_number),
      "chains"_a = column(molecule, &Atom::chain), "left_out"_a = molecule.skipped,
      "assumed_radii"_a = assumed, "notes"_a = molecule.notes, "warnings"_a = molecule.warnings,
      "path"_a = molecule.path, "format"_a = molecule.format, "model"_a = molecule.model,
      "assembly"_a = molecule.assembly, "segments"_a = column(molecule, &Atom::segment),
      "residues"_a = residues(molecule));
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

}  // namespace

ReadOptions read_options_of(const py::kwargs& given) {
  ReadOptions options;
  options.format = format_of(given["format"].cast<std::string>());
  options.model = given["model"].cast<std::string>();
  options.assembly = given["assembly"].cast<std::string>();
  options.radii = given["radii"].cast<std::string>();
  options.select = given["select"].cast<std::string>();
  options.altloc = given["altloc"].cast<std::string>();
  options.waters = inclusion_of(given["waters"].cast<bool>());
  options.hydrogens = inclusion_of(given["hydrogens"].cast<bool>());
  options.hetero_atoms = inclusion_of(given["hetatm"].cast<bool>());
  return options;
}

void bind_structures(py::module_& module) {
  module.def("read_file", &read_file);
  module.def("read_bytes", &read_bytes);
  module.def("read_sample", &read_builtin);
  py::class_<RadiusTable>(module, "RadiusTable")
      .def(py::init(&RadiusTable::from_list))
      .def("find", &radius);
}

}  // namespace vdwmesh::python
