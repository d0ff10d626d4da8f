// The two published radius sets by element as tables, and the parser of radius files. The set
// "bondi" consists of Bondi's 38 elements; Alvarez's table completes it, and entries from there are
// marked as assumed. The sets of united atoms stand in united_sets.cpp; they are completed by
// "bondi", all of whose entries are marked as assumed then.
#include "structure/radii.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/molecule/elements.hpp"
#include "structure/radii/united_atoms.hpp"
#include "structure/read/lines.hpp"
#include "structure/read/text_source.hpp"

namespace vdwmesh {
namespace {

// Å. Larger radii in radius files are refused as typing errors. The limit leaves room for the beads
// of coarse models, which are much larger than atoms.
constexpr double kLargestRadius = 1000;

constexpr const char *kBondiName = "bondi", *kAlvarezName = "alvarez";

using ElementRadius = std::pair<const char*, double>;  // symbol, Å

// Tables I and XIV of Bondi's paper of 1964. His paper of 1966 revises Cd, Hg and Zn; these
// revisions are not adopted.
constexpr std::array kBondi{
    ElementRadius{"H", 1.20},  ElementRadius{"He", 1.40}, ElementRadius{"Li", 1.82},
    ElementRadius{"C", 1.70},  ElementRadius{"N", 1.55},  ElementRadius{"O", 1.52},
    ElementRadius{"F", 1.47},  ElementRadius{"Ne", 1.54}, ElementRadius{"Na", 2.27},
    ElementRadius{"Mg", 1.73}, ElementRadius{"Si", 2.10}, ElementRadius{"P", 1.80},
    ElementRadius{"S", 1.80},  ElementRadius{"Cl", 1.75}, ElementRadius{"Ar", 1.88},
    ElementRadius{"K", 2.75},  ElementRadius{"Ni", 1.63}, ElementRadius{"Cu", 1.40},
    ElementRadius{"Zn", 1.39}, ElementRadius{"Ga", 1.87}, ElementRadius{"As", 1.85},
    ElementRadius{"Se", 1.90}, ElementRadius{"Br", 1.85}, ElementRadius{"Kr", 2.02},
    ElementRadius{"Pd", 1.63}, ElementRadius{"Ag", 1.72}, ElementRadius{"Cd", 1.58},
    ElementRadius{"In", 1.93}, ElementRadius{"Sn", 2.17}, ElementRadius{"Te", 2.06},
    ElementRadius{"I", 1.98},  ElementRadius{"Xe", 2.16}, ElementRadius{"Pt", 1.72},
    ElementRadius{"Au", 1.66}, ElementRadius{"Hg", 1.55}, ElementRadius{"Tl", 1.96},
    ElementRadius{"Pb", 2.02}, ElementRadius{"U", 1.86},
};

// Table 1 of Alvarez's paper, 93 elements. It lacks Pm, Po, At, Rn, Fr, Ra and all elements after
// Es.
constexpr std::array kAlvarez{
    ElementRadius{"H", 1.20},  ElementRadius{"He", 1.43}, ElementRadius{"Li", 2.12},
    ElementRadius{"Be", 1.98}, ElementRadius{"B", 1.91},  ElementRadius{"C", 1.77},
    ElementRadius{"N", 1.66},  ElementRadius{"O", 1.50},  ElementRadius{"F", 1.46},
    ElementRadius{"Ne", 1.58}, ElementRadius{"Na", 2.50}, ElementRadius{"Mg", 2.51},
    ElementRadius{"Al", 2.25}, ElementRadius{"Si", 2.19}, ElementRadius{"P", 1.90},
    ElementRadius{"S", 1.89},  ElementRadius{"Cl", 1.82}, ElementRadius{"Ar", 1.83},
    ElementRadius{"K", 2.73},  ElementRadius{"Ca", 2.62}, ElementRadius{"Sc", 2.58},
    ElementRadius{"Ti", 2.46}, ElementRadius{"V", 2.42},  ElementRadius{"Cr", 2.45},
    ElementRadius{"Mn", 2.45}, ElementRadius{"Fe", 2.44}, ElementRadius{"Co", 2.40},
    ElementRadius{"Ni", 2.40}, ElementRadius{"Cu", 2.38}, ElementRadius{"Zn", 2.39},
    ElementRadius{"Ga", 2.32}, ElementRadius{"Ge", 2.29}, ElementRadius{"As", 1.88},
    ElementRadius{"Se", 1.82}, ElementRadius{"Br", 1.86}, ElementRadius{"Kr", 2.25},
    ElementRadius{"Rb", 3.21}, ElementRadius{"Sr", 2.84}, ElementRadius{"Y", 2.75},
    ElementRadius{"Zr", 2.52}, ElementRadius{"Nb", 2.56}, ElementRadius{"Mo", 2.45},
    ElementRadius{"Tc", 2.44}, ElementRadius{"Ru", 2.46}, ElementRadius{"Rh", 2.44},
    ElementRadius{"Pd", 2.15}, ElementRadius{"Ag", 2.53}, ElementRadius{"Cd", 2.49},
    ElementRadius{"In", 2.43}, ElementRadius{"Sn", 2.42}, ElementRadius{"Sb", 2.47},
    ElementRadius{"Te", 1.99}, ElementRadius{"I", 2.04},  ElementRadius{"Xe", 2.06},
    ElementRadius{"Cs", 3.48}, ElementRadius{"Ba", 3.03}, ElementRadius{"La", 2.98},
    ElementRadius{"Ce", 2.88}, ElementRadius{"Pr", 2.92}, ElementRadius{"Nd", 2.95},
    ElementRadius{"Sm", 2.90}, ElementRadius{"Eu", 2.87}, ElementRadius{"Gd", 2.83},
    ElementRadius{"Tb", 2.79}, ElementRadius{"Dy", 2.87}, ElementRadius{"Ho", 2.81},
    ElementRadius{"Er", 2.83}, ElementRadius{"Tm", 2.79}, ElementRadius{"Yb", 2.80},
    ElementRadius{"Lu", 2.74}, ElementRadius{"Hf", 2.63}, ElementRadius{"Ta", 2.53},
    ElementRadius{"W", 2.57},  ElementRadius{"Re", 2.49}, ElementRadius{"Os", 2.48},
    ElementRadius{"Ir", 2.41}, ElementRadius{"Pt", 2.29}, ElementRadius{"Au", 2.32},
    ElementRadius{"Hg", 2.45}, ElementRadius{"Tl", 2.47}, ElementRadius{"Pb", 2.60},
    ElementRadius{"Bi", 2.54}, ElementRadius{"Ac", 2.80}, ElementRadius{"Th", 2.93},
    ElementRadius{"Pa", 2.88}, ElementRadius{"U", 2.71},  ElementRadius{"Np", 2.82},
    ElementRadius{"Pu", 2.81}, ElementRadius{"Am", 2.83}, ElementRadius{"Cm", 3.05},
    ElementRadius{"Bk", 3.40}, ElementRadius{"Cf", 3.05}, ElementRadius{"Es", 2.70},
};

[[noreturn]] void refuse(const std::filesystem::path& path, int line, const std::string& what) {
  throw FileFormatError(fmt::format("{}:{}: {}", path.string(), line, what));
}

// The field as a radius in Å. Throws if it is not a number from 0 to kLargestRadius.
double radius_or_refuse(std::string_view field, const std::filesystem::path& path, int line) {
  const std::optional<double> radius = finite_number(field);
  if (!radius || *radius < 0 || *radius > kLargestRadius)
    refuse(path, line,
           fmt::format("{} is not a radius in angstrom, which is a number from 0 to {}",
                       in_quotes(field), kLargestRadius));
  return *radius;
}

}  // namespace

const std::vector<std::string>& RadiusTable::names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{kBondiName, kAlvarezName};
    for (const UnitedSet& set : united_sets()) all.emplace_back(set.name);
    return all;
  }();
  return names;
}

RadiusTable RadiusTable::named(std::string_view name) {
  RadiusTable table;
  // Elements that the table has already keep their radii.
  const auto add = [&table](std::span<const ElementRadius> elements, bool assumed) {
    for (const auto& [element, radius] : elements)
      table.by_element_.try_emplace(element, AtomRadius{radius, assumed});
  };
  if (name != kAlvarezName) add(kBondi, name != kBondiName);
  add(kAlvarez, name != kAlvarezName);
  if (name == kBondiName || name == kAlvarezName) return table;
  for (const UnitedSet& set : united_sets()) {
    if (set.name != name) continue;
    table.united_ = std::make_shared<const UnitedAtoms>(set);
    return table;
  }
  throw InvalidInput(fmt::format("there is no radius set {}; there are {}, or give a file",
                                 in_quotes(name), fmt::join(names(), ", ")));
}

RadiusTable RadiusTable::from_file(const std::filesystem::path& path) {
  RadiusTable table;
  table.add_file(path);
  return table;
}

std::vector<std::string> RadiusTable::parts_of(const std::string& list) {
  std::error_code error;
  if (std::filesystem::exists(list, error)) return {list};
  std::vector<std::string> parts(1);
  for (const char c : list) {
    if (c == ',')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

RadiusTable RadiusTable::from_list(const std::string& list) {
  RadiusTable table;
  const std::vector<std::string> parts = parts_of(list);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string& part = parts[i];
    const std::string set = lower_case(part);
    const bool is_set = std::find(names().begin(), names().end(), set) != names().end();
    std::error_code error;
    if (is_set && i == 0)
      table = named(set);
    else if (is_set)
      throw InvalidInput(
          fmt::format("radii {}: the set {} comes first, files behind it", in_quotes(list), part));
    else if (std::filesystem::exists(part, error) || error)  // reading says what is wrong
      table.add_file(part);
    else
      throw InvalidInput(fmt::format("radii {}: neither a set ({}) nor a file that is there",
                                     in_quotes(part), fmt::join(names(), ", ")));
  }
  return table;
}

void RadiusTable::add_file(const std::filesystem::path& path) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  const Text text = read_text(path);
  std::string_view rest(text.data(), text.size()), line;
  if (rest.starts_with(kByteOrderMark)) rest.remove_prefix(kByteOrderMark.size());
  Entries& entries = files_.emplace_back();
  std::map<std::string, std::pair<double, int>> given;  // name -> its first radius, and the line
  for (int number = 1; next_line(rest, line); ++number) {
    const std::vector<std::string_view> fields = split_at_blanks(line.substr(0, line.find('#')));
    if (fields.empty()) continue;
    if (fields.size() != 2 && fields.size() != 3)
      refuse(path, number,
             fmt::format("has {} fields; a line is ELEMENT RADIUS or RESIDUE ATOM "
                         "RADIUS",
                         fields.size()));
    const double radius = radius_or_refuse(fields.back(), path, number);
    const bool is_atom = fields.size() == 3;
    // element_of_symbol() returns "X" for a text that is no symbol, and for "X" itself. A file may
    // name "X" to give atoms of unknown element a radius.
    const std::string_view element = is_atom ? "" : element_of_symbol(fields[0]);
    if (element == "X" && fields[0] != "X")
      refuse(path, number, fmt::format("{} is not an element", in_quotes(fields[0])));
    const std::string name =
        is_atom ? fmt::format("{} {}", fields[0], fields[1]) : std::string(element);
    // The same radius twice does no harm.
    const auto [first, is_new] = given.try_emplace(name, radius, number);
    if (first->second.first != radius)
      refuse(path, number,
             fmt::format("{} has radius {} here and {} in line {}; keep one of them", name, radius,
                         first->second.first, first->second.second));
    if (!is_new) continue;
    entries.try_emplace(
        name, AtomRadius{radius, false, Polarity::unknown, false, static_cast<int>(lines_.size())});
    lines_.push_back(fmt::format("{}:{} ({})", path.string(), number, name));
    has_atoms_ = has_atoms_ || is_atom;
  }
  if (entries.empty())
    throw FileFormatError(
        fmt::format("{}: has no radii; a line is ELEMENT RADIUS or RESIDUE ATOM "
                    "RADIUS",
                    path.string()));
}

std::optional<AtomRadius> RadiusTable::find(std::string_view residue, std::string_view atom,
                                            std::string_view element) const {
  const auto find_element = [element](const Entries& entries) -> std::optional<AtomRadius> {
    auto found = entries.find(element);
    if (found == entries.end() && element == "D") found = entries.find(std::string_view("H"));
    return found == entries.end() ? std::nullopt : std::optional(found->second);
  };
  const std::string name = has_atoms_ ? fmt::format("{} {}", residue, atom) : std::string();
  for (auto file = files_.rbegin(); file != files_.rend(); ++file) {
    const auto own = has_atoms_ ? file->find(name) : file->end();
    if (own != file->end()) return own->second;
    if (const auto entry = find_element(*file)) return entry;
  }
  if (united_) {
    // Hydrogens are part of the united atoms, and have no radius.
    if (element == "H" || element == "D") return std::nullopt;
    if (const auto match = united_->find(residue, atom, element)) {
      const auto& [type, is_renamed] = *match;
      return AtomRadius{type->radius, false, type->polarity, is_renamed};
    }
  }
  return find_element(by_element_);
}

}  // namespace vdwmesh
