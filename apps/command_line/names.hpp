// The names of values that the program alone has, in the manner of request/names.hpp.
#pragma once

#include "analysis/quality_histograms.hpp"
#include "command_line/parse.hpp"
#include "options.hpp"
#include "request/names.hpp"
#include "steps/picture_options.hpp"
#include "study/study_options.hpp"

namespace vdwmesh {

template <>
inline constexpr auto kNames<apps::StudyProjection> =
    names<apps::StudyProjection>({{"own", apps::StudyProjection::own},
                                  {"vdw", apps::StudyProjection::vdw},
                                  {"field", apps::StudyProjection::field},
                                  {"none", apps::StudyProjection::none}});
template <>
inline constexpr auto kNames<apps::Switch> = names<apps::Switch>({{"on", apps::Switch::on},
                                                                  {"off", apps::Switch::off}});
template <>
inline constexpr auto kNames<apps::SelfIntersections> =
    names<apps::SelfIntersections>({{"on", apps::SelfIntersections::count},
                                    {"auto", apps::SelfIntersections::count},
                                    {"off", apps::SelfIntersections::skip}});
template <>
inline constexpr auto kNames<apps::CgalCheck> =
    names<apps::CgalCheck>({{"auto", apps::CgalCheck::small_meshes},
                            {"on", apps::CgalCheck::run},
                            {"off", apps::CgalCheck::skip}});
template <>
inline constexpr auto kNames<apps::AtomGroup> =
    names<apps::AtomGroup>({{"atom", apps::AtomGroup::atom},
                            {"residue", apps::AtomGroup::residue},
                            {"chain", apps::AtomGroup::chain}});
template <>
inline constexpr auto kNames<apps::AtomFigure> =
    names<apps::AtomFigure>({{"area", apps::AtomFigure::area},
                             {"volume", apps::AtomFigure::volume},
                             {"exposure", apps::AtomFigure::exposure},
                             {"depth", apps::AtomFigure::depth}});
template <>
inline constexpr auto kNames<apps::InterfaceFigure> =
    names<apps::InterfaceFigure>({{"buried", apps::InterfaceFigure::buried},
                                  {"contact", apps::InterfaceFigure::contact},
                                  {"area", apps::InterfaceFigure::area}});
template <>
inline constexpr auto kNames<apps::BatchVerb> =
    names<apps::BatchVerb>({{"exact", apps::BatchVerb::exact},
                            {"report", apps::BatchVerb::report},
                            {"interface", apps::BatchVerb::interface},
                            {"pockets", apps::BatchVerb::pockets}});
template <>
inline constexpr auto kNames<apps::RowFormat> =
    names<apps::RowFormat>({{"jsonl", apps::RowFormat::jsonl}, {"csv", apps::RowFormat::csv}});
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

}  // namespace vdwmesh
