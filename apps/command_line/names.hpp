// The names of the contract for values of the libraries: the command line takes them and reports
// print them. One table per enumeration serves both ways, so that they cannot drift apart.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "analysis/quality_histograms.hpp"
#include "command_line/parse.hpp"
#include "options.hpp"
#include "steps/picture_options.hpp"
#include "study/study_options.hpp"

namespace vdwmesh::apps {

// Where a value has several names, the first is printed.
template <class T>
struct Name {
  std::string_view name;
  T value;
};
template <class T, std::size_t count>
constexpr auto names(const Name<T> (&all)[count]) {
  return std::to_array(all);
}

template <class T>
inline constexpr auto kNames = nullptr;
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
inline constexpr auto kNames<StudyProjection> =
    names<StudyProjection>({{"own", StudyProjection::own},
                            {"vdw", StudyProjection::vdw},
                            {"field", StudyProjection::field},
                            {"none", StudyProjection::none}});
template <>
inline constexpr auto kNames<Backend> =
    names<Backend>({{"auto", Backend::automatic}, {"cpu", Backend::cpu}, {"cuda", Backend::cuda}});
template <>
inline constexpr auto kNames<UnionMethod> = names<UnionMethod>({{"auto", UnionMethod::automatic},
                                                                {"cgal", UnionMethod::cgal},
                                                                {"arcs", UnionMethod::arcs},
                                                                {"both", UnionMethod::both}});
template <>
inline constexpr auto kNames<ExactSurface> =
    names<ExactSurface>({{"vdw", ExactSurface::vdw}, {"excluded", ExactSurface::excluded}});
template <>
inline constexpr auto kNames<TopologyRequest> =
    names<TopologyRequest>({{"on", TopologyRequest::full},
                            {"counts", TopologyRequest::counts},
                            {"off", TopologyRequest::none}});
template <>
inline constexpr auto kNames<Switch> = names<Switch>({{"on", Switch::on}, {"off", Switch::off}});
template <>
inline constexpr auto kNames<SelfIntersections> =
    names<SelfIntersections>({{"on", SelfIntersections::count},
                              {"auto", SelfIntersections::count},
                              {"off", SelfIntersections::skip}});
template <>
inline constexpr auto kNames<CgalCheck> = names<CgalCheck>({{"auto", CgalCheck::small_meshes},
                                                            {"on", CgalCheck::run},
                                                            {"off", CgalCheck::skip}});
template <>
inline constexpr auto kNames<AtomGroup> = names<AtomGroup>({{"atom", AtomGroup::atom},
                                                            {"residue", AtomGroup::residue},
                                                            {"chain", AtomGroup::chain}});
template <>
inline constexpr auto kNames<StructureFormat> =
    names<StructureFormat>({{"pdb", StructureFormat::pdb},
                            {"mmcif", StructureFormat::mmcif},
                            {"bcif", StructureFormat::bcif},
                            {"pqr", StructureFormat::pqr},
                            {"xyzr", StructureFormat::xyzr},
                            {"ent", StructureFormat::pdb},
                            {"cif", StructureFormat::mmcif}});
template <>
inline constexpr auto kNames<BatchVerb> = names<BatchVerb>({{"exact", BatchVerb::exact},
                                                            {"report", BatchVerb::report}});
template <>
inline constexpr auto kNames<RowFormat> = names<RowFormat>({{"jsonl", RowFormat::jsonl},
                                                            {"csv", RowFormat::csv}});
template <>
inline constexpr auto kNames<CameraProjection> =
    names<CameraProjection>({{"orthographic", CameraProjection::orthographic},
                             {"perspective", CameraProjection::perspective}});
template <>
inline constexpr auto kNames<Shading> = names<Shading>({{"pixel", Shading::per_pixel},
                                                        {"gouraud", Shading::gouraud}});
template <>
inline constexpr auto kNames<ColorMap> = names<ColorMap>({{"viridis", ColorMap::viridis},
                                                          {"cividis", ColorMap::cividis},
                                                          {"cool-warm", ColorMap::cool_warm}});
template <>
inline constexpr auto kNames<BinScale> = names<BinScale>({{"linear", BinScale::linear},
                                                          {"logarithmic", BinScale::logarithmic}});

template <class T>
std::string_view name_of(T value) {
  for (const auto& [name, named] : kNames<T>) {
    if (named == value) return name;
  }
  return "unknown";
}

template <class T>
std::vector<std::string_view> all_names() {
  std::vector<std::string_view> names;
  for (const auto& [name, value] : kNames<T>) names.push_back(name);
  return names;
}

// The inverse of name_of(). Throws InvalidInput that names `option` and lists the known names.
template <class T>
T value_named(std::string_view option, std::string_view text) {
  for (const auto& [name, value] : kNames<T>) {
    if (name == text) return value;
  }
  throw_unknown_name(option, text, all_names<T>());
}

}  // namespace vdwmesh::apps
