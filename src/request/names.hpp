// The names of values: the command line and Python take them, and reports print them. One table per
// enumeration serves all three, so that they cannot drift apart.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/letters.hpp"
#include "cuda/backend_choice.hpp"
#include "extract/field.hpp"
#include "measures/exact_union.hpp"
#include "refine/refiner.hpp"
#include "request/measure_request.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {

// Whether help and refusals show a name. The others are older ones, which scripts may have.
enum class NameUse { shown, accepted };

// Where a value has several names, the first is printed.
template <class T>
struct Name {
  std::string_view name;
  T value;
  NameUse use = NameUse::shown;
};
template <class T, std::size_t count>
constexpr auto names(const Name<T> (&all)[count]) {
  return std::to_array(all);
}

template <class T>
inline constexpr auto kNames = nullptr;
template <>
inline constexpr auto kNames<SurfaceChoice> =
    names<SurfaceChoice>({{"vdw", SurfaceChoice::vdw},
                          {"sas", SurfaceChoice::sas},
                          {"ses", SurfaceChoice::ses},
                          {"excluded", SurfaceChoice::ses, NameUse::accepted},
                          {"sasa", SurfaceChoice::sas, NameUse::accepted},
                          {"accessible", SurfaceChoice::sas, NameUse::accepted},
                          {"solvent-accessible", SurfaceChoice::sas, NameUse::accepted},
                          {"sesa", SurfaceChoice::ses, NameUse::accepted},
                          {"solvent-excluded", SurfaceChoice::ses, NameUse::accepted},
                          {"molecular", SurfaceChoice::ses, NameUse::accepted},
                          {"connolly", SurfaceChoice::ses, NameUse::accepted},
                          {"van-der-waals", SurfaceChoice::vdw, NameUse::accepted}});
template <>
inline constexpr auto kNames<ExactSurface> =
    names<ExactSurface>({{"vdw", ExactSurface::vdw}, {"excluded", ExactSurface::excluded}});
template <>
inline constexpr auto kNames<Mesher> = names<Mesher>({{"marching-cubes", Mesher::marching_cubes},
                                                      {"exact", Mesher::exact}});
template <>
inline constexpr auto kNames<FieldKind> = names<FieldKind>({{"vdw", FieldKind::vdw},
                                                            {"blinn", FieldKind::blinn},
                                                            {"soft", FieldKind::soft_object},
                                                            {"inverse-squared",
                                                             FieldKind::inverse_squared}});
template <>
inline constexpr auto kNames<FieldPreset> =
    names<FieldPreset>({{"radius-aware", FieldPreset::radius_aware},
                        {"thesis", FieldPreset::thesis},
                        {"thesis-vdw", FieldPreset::thesis_vdw}});
template <>
inline constexpr auto kNames<Projection> = names<Projection>({{"vdw", Projection::vdw},
                                                              {"field", Projection::field},
                                                              {"none", Projection::none}});
template <>
inline constexpr auto kNames<Crossings> = names<Crossings>({{"undo", Crossings::undo},
                                                            {"allow", Crossings::allow}});
template <>
inline constexpr auto kNames<Backend> =
    names<Backend>({{"auto", Backend::automatic}, {"cpu", Backend::cpu}, {"cuda", Backend::cuda}});
template <>
inline constexpr auto kNames<UnionMethod> = names<UnionMethod>({{"auto", UnionMethod::automatic},
                                                                {"cgal", UnionMethod::cgal},
                                                                {"arcs", UnionMethod::arcs},
                                                                {"both", UnionMethod::both}});
template <>
inline constexpr auto kNames<TopologyRequest> =
    names<TopologyRequest>({{"full", TopologyRequest::full},
                            {"counts", TopologyRequest::counts},
                            {"off", TopologyRequest::none},
                            {"on", TopologyRequest::full, NameUse::accepted}});
template <>
inline constexpr auto kNames<StructureFormat> =
    names<StructureFormat>({{"pdb", StructureFormat::pdb},
                            {"mmcif", StructureFormat::mmcif},
                            {"bcif", StructureFormat::bcif},
                            {"pqr", StructureFormat::pqr},
                            {"xyzr", StructureFormat::xyzr},
                            {"gro", StructureFormat::gro},
                            {"mol2", StructureFormat::mol2},
                            {"sdf", StructureFormat::sdf},
                            {"xyz", StructureFormat::xyz},
                            {"mol", StructureFormat::sdf},
                            {"ent", StructureFormat::pdb},
                            {"cif", StructureFormat::mmcif}});
template <>
inline constexpr auto kNames<LengthUnit> =
    names<LengthUnit>({{"angstrom", LengthUnit::angstrom},
                       {"nm", LengthUnit::nanometre},
                       {"pm", LengthUnit::picometre},
                       {"a", LengthUnit::angstrom, NameUse::accepted},
                       {"å", LengthUnit::angstrom, NameUse::accepted},
                       {"Å", LengthUnit::angstrom, NameUse::accepted}});

template <class T>
std::string_view name_of(T value) {
  for (const auto& known : kNames<T>) {
    if (known.value == value) return known.name;
  }
  return "unknown";
}

// The names that are shown.
template <class T>
std::vector<std::string_view> all_names() {
  std::vector<std::string_view> names;
  for (const auto& known : kNames<T>) {
    if (known.use == NameUse::shown) names.push_back(known.name);
  }
  return names;
}

// "a, b or c".
std::string list_names(std::span<const std::string_view> names);

// "; did you mean NAME?" with the known name that is closest to `given`; empty where none is close.
// A name of the field for a known one is taken first ("connolly" for "ses").
// Close is one slip of the fingers, two in names of more than five letters: a letter that is wrong,
// missing, too many, or swapped with its neighbour.
std::string suggestion(std::string_view given, std::span<const std::string_view> known);

// For a name that is not among the `known` ones: lists them, and says which may have been meant.
[[noreturn]] void throw_unknown_name(std::string_view option, std::string_view text,
                                     std::span<const std::string_view> known);

// The inverse of name_of(); capitals do not matter. Throws InvalidInput that begins with `option`
// and lists the names.
template <class T>
T value_named(std::string_view option, std::string_view text) {
  const std::string small = lower_case(text);
  for (const auto& known : kNames<T>) {
    if (known.name == small) return known.value;
  }
  throw_unknown_name(option, text, all_names<T>());
}

}  // namespace vdwmesh
