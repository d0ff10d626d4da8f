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

struct ListedRadius {
  const char* element;
  double radius;  // Å
};

// Tables I and XIV of Bondi's paper of 1964. His paper of 1966 revises Cd, Hg and Zn; these
// revisions are not adopted.
constexpr std::array kBondi{
    ListedRadius{"H", 1.20},  ListedRadius{"He", 1.40}, ListedRadius{"Li", 1.82},
    ListedRadius{"C", 1.70},  ListedRadius{"N", 1.55},  ListedRadius{"O", 1.52},
    ListedRadius{"F", 1.47},  ListedRadius{"Ne", 1.54}, ListedRadius{"Na", 2.27},
    ListedRadius{"Mg", 1.73}, ListedRadius{"Si", 2.10}, ListedRadius{"P", 1.80},
    ListedRadius{"S", 1.80},  ListedRadius{"Cl", 1.75}, ListedRadius{"Ar", 1.88},
    ListedRadius{"K", 2.75},  ListedRadius{"Ni", 1.63}, ListedRadius{"Cu", 1.40},
    ListedRadius{"Zn", 1.39}, ListedRadius{"Ga", 1.87}, ListedRadius{"As", 1.85},
    ListedRadius{"Se", 1.90}, ListedRadius{"Br", 1.85}, ListedRadius{"Kr", 2.02},
    ListedRadius{"Pd", 1.63}, ListedRadius{"Ag", 1.72}, ListedRadius{"Cd", 1.58},
    ListedRadius{"In", 1.93}, ListedRadius{"Sn", 2.17}, ListedRadius{"Te", 2.06},
    ListedRadius{"I", 1.98},  ListedRadius{"Xe", 2.16}, ListedRadius{"Pt", 1.72},
    ListedRadius{"Au", 1.66}, ListedRadius{"Hg", 1.55}, ListedRadius{"Tl", 1.96},
    ListedRadius{"Pb", 2.02}, ListedRadius{"U", 1.86},
};

// Table 1 of Alvarez's paper, 93 elements. It lacks Pm, Po, At, Rn, Fr, Ra and all elements after
// Es.
constexpr std::array kAlvarez{
    ListedRadius{"H", 1.20},  ListedRadius{"He", 1.43}, ListedRadius{"Li", 2.12},
    ListedRadius{"Be", 1.98}, ListedRadius{"B", 1.91},  ListedRadius{"C", 1.77},
    ListedRadius{"N", 1.66},  ListedRadius{"O", 1.50},  ListedRadius{"F", 1.46},
    ListedRadius{"Ne", 1.58}, ListedRadius{"Na", 2.50}, ListedRadius{"Mg", 2.51},
    ListedRadius{"Al", 2.25}, ListedRadius{"Si", 2.19}, ListedRadius{"P", 1.90},
    ListedRadius{"S", 1.89},  ListedRadius{"Cl", 1.82}, ListedRadius{"Ar", 1.83},
    ListedRadius{"K", 2.73},  ListedRadius{"Ca", 2.62}, ListedRadius{"Sc", 2.58},
    ListedRadius{"Ti", 2.46}, ListedRadius{"V", 2.42},  ListedRadius{"Cr", 2.45},
    ListedRadius{"Mn", 2.45}, ListedRadius{"Fe", 2.44}, ListedRadius{"Co", 2.40},
    ListedRadius{"Ni", 2.40}, ListedRadius{"Cu", 2.38}, ListedRadius{"Zn", 2.39},
    ListedRadius{"Ga", 2.32}, ListedRadius{"Ge", 2.29}, ListedRadius{"As", 1.88},
    ListedRadius{"Se", 1.82}, ListedRadius{"Br", 1.86}, ListedRadius{"Kr", 2.25},
    ListedRadius{"Rb", 3.21}, ListedRadius{"Sr", 2.84}, ListedRadius{"Y", 2.75},
    ListedRadius{"Zr", 2.52}, ListedRadius{"Nb", 2.56}, ListedRadius{"Mo", 2.45},
    ListedRadius{"Tc", 2.44}, ListedRadius{"Ru", 2.46}, ListedRadius{"Rh", 2.44},
    ListedRadius{"Pd", 2.15}, ListedRadius{"Ag", 2.53}, ListedRadius{"Cd", 2.49},
    ListedRadius{"In", 2.43}, ListedRadius{"Sn", 2.42}, ListedRadius{"Sb", 2.47},
    ListedRadius{"Te", 1.99}, ListedRadius{"I", 2.04},  ListedRadius{"Xe", 2.06},
    ListedRadius{"Cs", 3.48}, ListedRadius{"Ba", 3.03}, ListedRadius{"La", 2.98},
    ListedRadius{"Ce", 2.88}, ListedRadius{"Pr", 2.92}, ListedRadius{"Nd", 2.95},
    ListedRadius{"Sm", 2.90}, ListedRadius{"Eu", 2.87}, ListedRadius{"Gd", 2.83},
    ListedRadius{"Tb", 2.79}, ListedRadius{"Dy", 2.87}, ListedRadius{"Ho", 2.81},
    ListedRadius{"Er", 2.83}, ListedRadius{"Tm", 2.79}, ListedRadius{"Yb", 2.80},
    ListedRadius{"Lu", 2.74}, ListedRadius{"Hf", 2.63}, ListedRadius{"Ta", 2.53},
    ListedRadius{"W", 2.57},  ListedRadius{"Re", 2.49}, ListedRadius{"Os", 2.48},
    ListedRadius{"Ir", 2.41}, ListedRadius{"Pt", 2.29}, ListedRadius{"Au", 2.32},
    ListedRadius{"Hg", 2.45}, ListedRadius{"Tl", 2.47}, ListedRadius{"Pb", 2.60},
    ListedRadius{"Bi", 2.54}, ListedRadius{"Ac", 2.80}, ListedRadius{"Th", 2.93},
    ListedRadius{"Pa", 2.88}, ListedRadius{"U", 2.71},  ListedRadius{"Np", 2.82},
    ListedRadius{"Pu", 2.81}, ListedRadius{"Am", 2.83}, ListedRadius{"Cm", 3.05},
    ListedRadius{"Bk", 3.40}, ListedRadius{"Cf", 3.05}, ListedRadius{"Es", 2.70},
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

// Remembers which line of the file gave which radius, in order to find contradictions.
class GivenRadii {
 public:
  explicit GivenRadii(const std::filesystem::path& path) : path_(path) {}

  // `name` is an element, or residue and atom. Throws if an earlier line gave it a different
  // radius. The same radius twice does no harm. `first`: no earlier line gave the name a radius.
  void add(const std::string& name, double radius, int line) {
    const auto [entry, first] = given_.try_emplace(name, radius, line);
    const auto [earlier, earlier_line] = entry->second;
    if (first || earlier == radius) return;
    refuse(path_, line,
           fmt::format("{} has radius {} here and {} in line {}; keep one of them", name, radius,
                       earlier, earlier_line));
  }

 private:
  const std::filesystem::path& path_;
  std::map<std::string, std::pair<double, int>> given_;  // name -> (radius in Å, line)
};

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
  const auto add = [&table](std::span<const ListedRadius> elements, bool assumed) {
    for (const ListedRadius& entry : elements)
      table.by_element_.try_emplace(entry.element, Entry{entry.radius, assumed});
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
  GivenRadii given(path);
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
    given.add(name, radius, number);
    const Entry entry{radius, false, Polarity::unknown, false, static_cast<int>(lines_.size())};
    if (!entries.try_emplace(name, entry).second) continue;
    lines_.push_back(fmt::format("{}:{} ({})", path.string(), number, name));
    has_atoms_ = has_atoms_ || is_atom;
  }
  if (entries.empty())
    throw FileFormatError(
        fmt::format("{}: has no radii; a line is ELEMENT RADIUS or RESIDUE ATOM "
                    "RADIUS",
                    path.string()));
}

std::optional<RadiusTable::Entry> RadiusTable::find(std::string_view residue, std::string_view atom,
                                                    std::string_view element) const {
  const auto find_element = [element](const Entries& entries) -> std::optional<Entry> {
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
    if (const auto match = united_->find(residue, atom, element))
      return Entry{match->type->radius, false, match->type->polarity, match->renamed};
  }
  return find_element(by_element_);
}

}  // namespace vdwmesh
