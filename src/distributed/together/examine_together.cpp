// examine_together(): every rank measures its part of the mesh (border_mesh.hpp). Counts and exact
// sums add up. Shells are sets of connected vertices: each rank finds those of its part, and the
// first one joins them over the borders. The area and volume of a shell that lies in one part are
// summed there; the terms of all other shells are sent to the first rank.
#include "distributed/together/examine_together.hpp"

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/distances/distribution.hpp"
#include "analysis/survey/quality_parts.hpp"
#include "analysis/survey/shell_sums.hpp"
#include "analysis/survey/vertex_survey.hpp"
#include "core/disjoint_sets.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/large_pages.hpp"
#include "distributed/ranks.hpp"
#include "distributed/together/border_mesh.hpp"
#include "distributed/together/joined_sets.hpp"
#include "distributed/together/sorted_numbers.hpp"
#include "spheres/box.hpp"

namespace vdwmesh {
namespace {

constexpr int kBitsAtATime = 12;

// The value of rank `rank`, from 0, among those of all ranks, sorted. `values` are those of this
// rank. Precondition: no value has a sign bit, so that the values are in the order of their bits.
// Collective.
double value_of_rank(const Ranks& ranks, Buffer<double> values, std::uint64_t rank) {
  constexpr int kBits = 63;
  std::uint64_t found = 0;
  for (int left = kBits; left > 0;) {
    const int taken = std::min(left, kBitsAtATime);
    left -= taken;
    const auto digit_of = [=](double value) {
      return std::bit_cast<std::uint64_t>(value) >> left & ((std::uint64_t{1} << taken) - 1);
    };
    std::vector<std::uint64_t> counts(std::size_t{1} << taken);
    for (const double value : values) ++counts[digit_of(value)];
    ranks.add_up(counts);
    std::uint64_t digit = 0;
    for (; rank >= counts[digit]; ++digit) rank -= counts[digit];
    std::erase_if(values, [&](double value) { return digit_of(value) != digit; });
    found = found << taken | digit;
  }
  return std::bit_cast<double>(found);
}

// The sum of the summaries of all ranks, on all of them. Collective.
ValueSummary sum_together(const Ranks& ranks, const ValueSummary& mine) {
  const std::vector<ValueSummary> each = ranks.collect(std::span<const ValueSummary>(&mine, 1));
  ValueSummary all;
  for (const ValueSummary& theirs : each) add(all, theirs);
  return ranks.shared(all);
}

// The brackets from the samples of all ranks; the same on all ranks. Collective.
Brackets brackets_together(const Ranks& ranks, const std::vector<double>& sample) {
  std::vector<double> all = ranks.collect(std::span<const double>(sample));
  Brackets brackets;
  ranks.together([&] {
    if (ranks.is_first()) brackets = brackets_from_sample(std::move(all));
  });
  return ranks.shared(brackets);
}

// What distribution_of() says of the values of all ranks, bit for bit; the same on all ranks, and
// nothing where it says nothing. Precondition: all ranks have the same brackets. Collective.
// The ranks add up their sums and the numbers of values below each bracket. These say which of the
// values inside of a bracket the percentile is. Its bits are found a few at a time, from the
// highest on: the ranks count their values by these bits, and keep the values that agree with the
// percentile so far. So no values are sent.
std::optional<Distribution> distribution_together(const Ranks& ranks,
                                                  const BracketedValues& values) {
  ValueSummary mine;
  ranks.together([&] { mine = values.summary(); });
  const ValueSummary all = sum_together(ranks, mine);
  const auto value_inside = [&](std::size_t i, std::uint64_t rank) -> std::optional<double> {
    Buffer<double> inside;
    ranks.together([&] { inside = values.inside(i); });
    if (rank >= ranks.sum(std::uint64_t{inside.size()})) return std::nullopt;
    return value_of_rank(ranks, std::move(inside), rank);
  };
  return distribution_of(all, values.brackets(), value_inside);
}

// The name of a set of a rank, among those of all ranks.
std::uint64_t name_of_set(const Ranks& ranks, std::uint32_t set) {
  return static_cast<std::uint64_t>(ranks.number()) << 32 | set;
}

Box box_together(const Ranks& ranks, const IndexedMesh& mesh) {
  const Box mine = box_of_vertices(mesh);
  const std::vector<Box> each = ranks.collect(std::span<const Box>(&mine, 1));
  Box all = empty_box();
  for (const Box& box : each) include(all, box);
  return ranks.shared(all);
}

// The connected vertices of a part. The survey has joined the ends of its own edges already.
class VertexSets {
 public:
  // An edge that is not own has a vertex of another rank, and so have its triangles: these are some
  // of the own ones and all others.
  VertexSets(const BorderMesh& part, DisjointSets sets) : sets_(std::move(sets)) {
    const auto join_corners = [&](std::size_t t) {
      const auto& [a, b, c] = part.mesh.triangles[t];
      sets_.join(a, b);
      sets_.join(b, c);
    };
    for (const std::size_t t : part.border_triangles) join_corners(t);
    for (std::size_t t = part.triangles; t < part.mesh.triangle_count(); ++t) join_corners(t);
    for (const auto* by_rank : {&part.halo.elsewhere, &part.halo.asked_for}) {
      for (const std::vector<std::uint32_t>& vertices : *by_rank) {
        for (const std::uint32_t v : vertices) on_border_.push_back(sets_.find(v));
      }
    }
    sort_without_repeats(on_border_);
  }

  std::uint32_t set_of(std::uint32_t vertex) { return sets_.find(vertex); }
  std::uint64_t count() const { return sets_.count(); }
  bool is_border(std::uint64_t set) const { return std::ranges::binary_search(on_border_, set); }

 private:
  DisjointSets sets_;
  std::vector<std::uint64_t> on_border_;  // representatives of sets, ascending
};

// The sets of different ranks that have a vertex in common. Every rank tells the owners of vertices
// elsewhere which of its sets these are in. The result is that of the first rank. Collective.
std::vector<BorderElement> border_of_sets(const Ranks& ranks, const BorderMesh& part,
                                          VertexSets& sets) {
  const auto& [elsewhere, asked_for] = part.halo;
  std::vector<std::vector<std::uint64_t>> told(elsewhere.size());
  ranks.together([&] {
    for (std::size_t rank = 0; rank < told.size(); ++rank) {
      for (const std::uint32_t v : elsewhere[rank]) {
        told[rank].push_back(name_of_set(ranks, sets.set_of(v)));
      }
    }
  });
  const std::vector<std::vector<std::uint64_t>> heard = ranks.exchange(told);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> pairs;
  ranks.together([&] {
    for (std::size_t rank = 0; rank < heard.size(); ++rank) {
      for (std::size_t i = 0; i < heard[rank].size(); ++i) {
        const std::uint32_t set = sets.set_of(asked_for[rank][i]);
        pairs.emplace_back(heard[rank][i], name_of_set(ranks, set));
      }
    }
    std::ranges::sort(pairs);
    pairs.erase(std::ranges::unique(pairs).begin(), pairs.end());
  });
  std::vector<BorderElement> border;
  for (const auto& [theirs, mine] : pairs) {
    const std::uint64_t name = name_of_set(ranks, static_cast<std::uint32_t>(border.size()));
    border.push_back({name, theirs});
    border.push_back({name, mine});
  }
  return ranks.collect(std::span<const BorderElement>(border));
}

// The terms of the own triangles, by the sets that they are in.
std::vector<ShellTerm> terms_of(const BorderMesh& part, VertexSets& sets, const Vec3d& origin) {
  Buffer<std::uint32_t> set_of;
  resize_untouched(set_of, part.triangles);
  for_each_index(part.triangles,
                 [&](std::size_t t) { set_of[t] = sets.set_of(part.mesh.triangles[t][0]); });
  return shell_terms(part.mesh, set_of, origin);
}

struct Shells {
  ShellTotals totals;
  std::uint64_t count = 0;
};

// Collective; the result is that of the first rank.
Shells sum_shells(const Ranks& ranks, const BorderMesh& part, DisjointSets connected) {
  const Vec3d origin = middle(box_together(ranks, part.mesh));
  std::optional<VertexSets> sets;
  std::vector<ShellTerm> inside, across;
  Shells shells;
  ranks.together([&] {
    sets.emplace(part, std::move(connected));
    inside = terms_of(part, *sets, origin);
    const auto of_border = std::ranges::partition(
        inside, [&](const ShellTerm& term) { return !sets->is_border(term.shell); });
    across.assign(of_border.begin(), of_border.end());
    inside.erase(of_border.begin(), of_border.end());
    for (ShellTerm& term : across) {
      term.shell = name_of_set(ranks, static_cast<std::uint32_t>(term.shell));
    }
    add_shells(shells.totals, std::move(inside));
  });
  std::vector<BorderElement> border = border_of_sets(ranks, part, *sets);
  const std::uint64_t all_sets = ranks.sum(sets->count());
  across = ranks.collect(std::span<const ShellTerm>(across));
  const auto totals = ranks.collect(std::span<const ShellTotals>(&shells.totals, 1));
  ranks.together([&] {
    if (!ranks.is_first()) return;
    JoinedSets joined(std::move(border));
    shells = {};
    shells.count = joined.count(all_sets);
    for (ShellTerm& term : across) term.shell = joined.number_of(term.shell).value();
    for (const ShellTotals& theirs : totals) add(shells.totals, theirs);
    add_shells(shells.totals, std::move(across));
  });
  return shells;
}

PartSurvey survey_together(const Ranks& ranks, const PartSurvey& mine) {
  const auto all = [&](bool holds) { return ranks.sum(std::uint64_t{!holds}) == 0; };
  return {all(mine.closed),      all(mine.manifold),
          all(mine.oriented),    all(mine.at_most_two_sides),
          ranks.sum(mine.edges), ranks.sum(mine.used_vertices)};
}

// Brackets of each distribution of a mesh.
struct QualityBrackets {
  Brackets min_angles_deg, aspect_ratios, edge_lengths;
};

// Surveys the part, joins the ends of its own edges in `connected` and fills the quality of the
// whole mesh, which is that of all ranks. Returns nothing if a percentile was outside of its
// bracket. Collective.
std::optional<MeshQuality> quality_together(const Ranks& ranks, const BorderMesh& part,
                                            const QualityBrackets& brackets, PartSurvey& survey,
                                            DisjointSets& connected) {
  BracketedValues lengths(brackets.edge_lengths), angles(brackets.min_angles_deg),
      ratios(brackets.aspect_ratios);
  ranks.together([&] {
    survey = survey_part(part.part(), {&lengths, &connected});
    visit_shapes(part.part(), [&](std::size_t, const TriangleShapes& shapes) {
      angles.add(shapes.min_angles_deg);
      ratios.add(shapes.aspect_ratios);
    });
  });
  const auto edge_length = distribution_together(ranks, lengths);
  const auto min_angle_deg = distribution_together(ranks, angles);
  const auto aspect_ratio = distribution_together(ranks, ratios);
  const std::uint64_t degenerate =
      ranks.sum(std::uint64_t{part.triangles} - ratios.summary().count);
  if (!edge_length || !min_angle_deg || !aspect_ratio) return std::nullopt;
  return MeshQuality{*min_angle_deg, *aspect_ratio, *edge_length, degenerate};
}

// Collective.
QualityBrackets brackets_of_quality(const Ranks& ranks, const BorderMesh& part,
                                    std::uint64_t all_triangles) {
  QualitySample sample;
  ranks.together([&] { sample = sample_quality(part.part(), usual_sample_step(all_triangles)); });
  return {brackets_together(ranks, sample.min_angles_deg),
          brackets_together(ranks, sample.aspect_ratios),
          brackets_together(ranks, sample.edge_lengths)};
}

}  // namespace

MeshExamination examine_together(const Ranks& ranks, SurfacePiece& piece) {
  BorderMesh part = take_border_mesh(ranks, piece);
  PartSurvey survey{};
  std::optional<DisjointSets> connected;
  ranks.together([&] { connected.emplace(part.mesh.vertex_count()); });
  std::optional<MeshQuality> quality = quality_together(
      ranks, part, brackets_of_quality(ranks, part, piece.whole.triangles), survey, *connected);
  if (!quality) {
    const Brackets all = bracket_of_everything();
    quality = quality_together(ranks, part, {all, all, all}, survey, *connected);
  }
  survey = survey_together(ranks, survey);
  ranks.together([&] {
    if (survey.closed && survey.manifold && survey.oriented) return;
    throw InternalError("the mesh of all ranks is no closed, oriented 2-manifold");
  });
  const Shells shells = sum_shells(ranks, part, std::move(*connected));
  give_back(part, piece);
  const MeshCounts counts{survey.closed,         survey.manifold,      survey.oriented,
                          piece.whole.vertices,  survey.used_vertices, survey.edges,
                          piece.whole.triangles, shells.count};
  return {topology_of(counts, shells.totals), measures_of(counts, shells.totals), quality.value()};
}

}  // namespace vdwmesh
