// certify(): goes through balls, edges, triangles and tetrahedra of the dual complex, in parallel.
// Triangles need the terms of their edges, and tetrahedra those of both.
#include "measures/certificate/certify.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "measures/certificate/simplex_terms.hpp"
#include "measures/certificate/wide_interval.hpp"
#include "measures/exact_sum.hpp"

namespace vdwmesh {
namespace {

using namespace certificate;

// A simplex whose interval is wider than this is evaluated again with more bits, until it is not or
// has kMostBits. In these units the largest radius is at least 1/2, so area and volume of the whole
// union are at least π and π / 6. Well-shaped simplices have intervals of some 1e-15. The terms of
// triangles contain those of three edges, times angles up to π, and the terms of tetrahedra those
// of edges and triangles, so each limit leaves room for the one before it. If kMostBits are not
// enough, the interval is wide, but still true.
constexpr double kEdgeWidth = 0x1p-48, kTriangleWidth = 0x1p-43, kCellWidth = 0x1p-42;
constexpr int kLeastBits = 128, kMostBits = 4096, kBitsOfDouble = 53;

// What one thread has added up.
struct EndSums {
  ExactSum area_lower, area_upper, volume_lower, volume_upper;
  int bits = kBitsOfDouble;

  void add(const MeasureTerms& terms) {
    area_lower.add(terms.area.inf());
    area_upper.add(terms.area.sup());
    volume_lower.add(terms.volume.inf());
    volume_upper.add(terms.volume.sup());
  }
  void add(const EndSums& other) {
    area_lower.add(other.area_lower);
    area_upper.add(other.area_upper);
    volume_lower.add(other.volume_lower);
    volume_upper.add(other.volume_upper);
    bits = std::max(bits, other.bits);
  }
};

class Certifier {
 public:
  Certifier(const SphereSet& spheres, const PowerTriangulation& triangulation,
            const DualComplex& complex, const MeasuredSpheres& measured, Monitor* monitor,
            RoundingMode mode)
      : spheres_(spheres),
        t_(triangulation),
        k_(complex),
        measured_(measured),
        monitor_(monitor),
        mode_(mode) {}

  UnionCertificate run() && {
    require_exact_scaling();
    roles_.resize(t_.balls.size());
    is_wide_.assign(t_.balls.size(), 0);
    edges_.resize(k_.edges.size());
    chords_.resize(k_.triangles.size());
    for_each(t_.balls.size(), [&](std::size_t i, EndSums& sums) { add_ball(i, sums); });
    for_each(k_.edges.size(), [&](std::size_t i, EndSums& sums) { add_edge(i, sums); });
    for_each(k_.triangles.size(), [&](std::size_t i, EndSums& sums) { add_triangle(i, sums); });
    for_each(k_.tetrahedra.size(), [&](std::size_t i, EndSums& sums) { add_cell(i, sums); });
    return result();
  }

 private:
  // Powers of two change no digit, unless the result is too small for all digits of a double.
  void require_exact_scaling() const {
    const auto is_exact = [&](double scaled, double given) {
      return std::ldexp(scaled, t_.scale_exponent) == given;
    };
    for (std::size_t i = 0; i < t_.balls.size(); ++i) {
      const Sphere &a = t_.balls[i], &b = spheres_[t_.ids[i]];
      if (is_exact(a.center.x, b.center.x) && is_exact(a.center.y, b.center.y) &&
          is_exact(a.center.z, b.center.z) && is_exact(a.radius, b.radius)) {
        continue;
      }
      throw InvalidInput(
          "the sizes of the spheres or their coordinates differ by too many powers of ten for a "
          "certificate");
    }
  }

  // Calls visit(i, sums) for i < count, on all cores, with the processor rounding upward.
  template <class Visit>
  void for_each(std::size_t count, Visit visit) {
    constexpr std::size_t kGrain = 256;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
      advance(monitor_, 0);
      EndSums& sums = sums_.local();
      with_rounding(mode_, [&] {
        if (mode_ == RoundingMode::upward) require_upward_rounding();
        for (std::size_t i = range.begin(); i < range.end(); ++i) visit(i, sums);
      });
    });
  }

  // Returns evaluate(T{}) for T = Interval or, if that is wider than `most`, for WideInterval with
  // as many bits as it takes. MPFR is called with the processor's usual rounding mode.
  template <std::size_t n, class Evaluate>
  auto settled(const std::array<std::uint32_t, n>& vertices, double most, EndSums& sums,
               Evaluate evaluate) {
    auto terms = evaluate(Interval());
    if (width(terms) <= most) return terms;
    for (const std::uint32_t v : vertices) {
      std::atomic_ref(is_wide_[v]).store(1, std::memory_order_relaxed);
    }
    with_rounding(RoundingMode::to_nearest, [&] {
      for (int bits = kLeastBits; bits <= kMostBits && !(width(terms) <= most); bits *= 2) {
        const Precision precision(bits);
        terms = evaluate(WideInterval());
        sums.bits = std::max(sums.bits, bits);
      }
    });
    return terms;
  }

  template <std::size_t n>
  std::array<Sphere, n> balls(const std::array<std::uint32_t, n>& vertices) const {
    std::array<Sphere, n> out;
    for (std::size_t k = 0; k < n; ++k) out[k] = t_.balls[vertices[k]];
    return out;
  }
  template <std::size_t n>
  std::array<Role, n> roles(const std::array<std::uint32_t, n>& vertices) const {
    std::array<Role, n> out;
    for (std::size_t k = 0; k < n; ++k) out[k] = roles_[vertices[k]];
    return out;
  }
  template <std::size_t n>
  bool is_needed(const std::array<std::uint32_t, n>& vertices) const {
    return std::any_of(vertices.begin(), vertices.end(),
                       [&](std::uint32_t v) { return roles_[v].measured; });
  }

  void add_ball(std::size_t i, EndSums& sums) {
    const bool measured = measured_.contains(t_.ids[i]);
    roles_[i] = {measured, measured && k_.exposed[i] != 0};
    if (!roles_[i].exposed) return;
    const Interval r(t_.balls[i].radius), area = Interval(4) * pi(r) * CGAL::square(r);
    sums.add({area, area * r / Interval(3)});
  }

  void add_edge(std::size_t i, EndSums& sums) {
    const DualEdge& edge = k_.edges[i];
    if (!is_needed(edge.vertices)) {
      edges_[i] = {{}, {}, Interval(0), false};
      return;
    }
    edges_[i] = settled(edge.vertices, kEdgeWidth, sums, [&]<class T>(const T&) {
      return edge_terms<T>(balls(edge.vertices), roles(edge.vertices), edge.exposed);
    });
    const MeasureTerms& angle = edges_[i].free_angle;
    if (!edge.exposed) return;
    const Interval turn = Interval(2) * pi(angle.area);
    sums.add({-turn * angle.area, -turn * angle.volume});
  }

  void add_triangle(std::size_t i, EndSums& sums) {
    const DualTriangle& f = k_.triangles[i];
    chords_[i] = Interval(0);
    if (!is_needed(f.vertices)) return;
    const TriangleInput input{balls(f.vertices),
                              roles(f.vertices),
                              {&edges_[f.edges[0]], &edges_[f.edges[1]], &edges_[f.edges[2]]},
                              f.exposed[0] + f.exposed[1]};
    const TriangleTerms terms = settled(f.vertices, kTriangleWidth, sums, [&]<class T>(const T&) {
      return triangle_terms<T>(input);
    });
    chords_[i] = terms.chord;
    if (input.corners > 0) sums.add(terms.corners);
  }

  // The number of the edge between vertices i and j of a cell, which is looked up in a facet that
  // has both.
  const EdgeTerms* edge_of(std::uint32_t cell, std::size_t i, std::size_t j) const {
    std::size_t other = 0;
    while (other == i || other == j) ++other;
    const auto& v = t_.cells[cell];
    return &edges_[edge_between(k_.triangles[k_.cell_triangles[cell][other]], v[i], v[j])];
  }

  void add_cell(std::size_t i, EndSums& sums) {
    const std::uint32_t c = k_.tetrahedra[i];
    const auto& v = t_.cells[c];
    if (!is_needed(v)) return;
    CellInput input{balls(v), roles(v), {}, {}};
    for (std::size_t p = 0; p < 6; ++p) {
      input.edges[p] = edge_of(c, kPairs[p][0], kPairs[p][1]);
    }
    for (std::size_t k = 0; k < 4; ++k) input.chords[k] = &chords_[k_.cell_triangles[c][k]];
    sums.add(settled(v, kCellWidth, sums, [&]<class T>(const T&) { return cell_terms<T>(input); }));
  }

  // `end` times 2^exponent, rounded in this direction if it is too small or too large for a double.
  static double unscaled(double end, int exponent, double direction) {
    const double value = std::ldexp(end, exponent);
    return std::ldexp(value, -exponent) == end ? value : std::nextafter(value, direction);
  }

  Enclosure unscaled(const ExactSum& lower, const ExactSum& upper, int dimension) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const int exponent = dimension * t_.scale_exponent;
    return {std::max(0.0, unscaled(lower.down(), exponent, -kInfinity)),
            unscaled(upper.up(), exponent, kInfinity)};
  }

  UnionCertificate result() const {
    EndSums total;
    for (const EndSums& sums : sums_) total.add(sums);
    UnionCertificate out{};
    out.area = unscaled(total.area_lower, total.area_upper, 2);
    out.volume = unscaled(total.volume_lower, total.volume_upper, 3);
    out.wide_spheres =
        static_cast<std::uint64_t>(std::count(is_wide_.begin(), is_wide_.end(), std::uint8_t{1}));
    out.bits = total.bits;
    return out;
  }

  const SphereSet& spheres_;
  const PowerTriangulation& t_;
  const DualComplex& k_;
  const MeasuredSpheres& measured_;
  Monitor* const monitor_;
  const RoundingMode mode_;
  std::vector<Role> roles_;            // per ball
  std::vector<std::uint8_t> is_wide_;  // per ball: 1 if one of its simplices took more than double
  std::vector<EdgeTerms> edges_;
  std::vector<Interval> chords_;  // per triangle: D
  tbb::enumerable_thread_specific<EndSums> sums_;
};

}  // namespace

UnionCertificate certify(const SphereSet& spheres, const PowerTriangulation& triangulation,
                         const DualComplex& complex, const MeasuredSpheres& measured,
                         Monitor* monitor, certificate::RoundingMode mode) {
  return Certifier(spheres, triangulation, complex, measured, monitor, mode).run();
}

}  // namespace vdwmesh
