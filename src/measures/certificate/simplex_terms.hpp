// What each simplex of the dual complex contributes to area and volume of the union.
//
// The formulas are those of inclusion_exclusion() (complex/inclusion_exclusion.cpp), rearranged so
// that every simplex has one term of its own and the terms may be added in any order. Let a ball
// with the radius r be exposed, φ = 2 π - sum of δ the free angle of an edge, δ the dihedral angles
// of tetrahedra and corner tetrahedra at it, h the height of the radical plane over a centre, ρ the
// radius of the circle, and ω solid angles. Then
//   area   = sum over balls of 4 π r² - sum of ω r² - sum over edges of φ A
//   volume = sum over balls of 4 π r³ / 3 - sum of ω r³ / 3 - sum over edges of φ V
//            + sum over triangles of D × chord
// with, for an edge between balls a and b, and for a triangle with the edges e,
//   A = r_a (r_a - h_a) + r_b (r_b - h_b)      of balls that are exposed; 0 if the edge is not
//   V = r_a² (r_a - h_a) / 3 + r_b² (r_b - h_b) / 3 - H ρ² / 6,   H = h_a + h_b
//   D = sum over e of H_e × (signed distance of the orthogonal centre from e) / 6
// The chord is divided into the heights of orthogonal centres of tetrahedra, and the half chords to
// exposed corners. In a tetrahedron a solid angle is the sum of three dihedral angles less π.
// Balls that are not to be measured contribute no r and no h to these sums.
//
// The shapes behind them are those of complex/simplex_shape.hpp, but not by its code: that turns to
// more digits where double loses them, and intervals say themselves how many they have lost.
//
// Every template computes with a type of interval T, which is Interval or WideInterval, and gives
// intervals of doubles. With Interval, the processor must round upward. Where a simplex is known to
// be in the dual complex, bounds follow that hold without rounding: its orthogonal centre is in all
// its balls. within() uses them, so that no interval is infinite.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "measures/certificate/interval.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh::certificate {

// How a ball enters the sums. An exposed ball is also measured.
struct Role {
  bool measured, exposed;
};

// Terms of area and volume, in units of the triangulation.
struct MeasureTerms {
  Interval area{0}, volume{0};
};
inline double width(const MeasureTerms& t) { return std::max(width(t.area), width(t.volume)); }

struct EdgeTerms {
  MeasureTerms free_angle;  // A and V: per radian of the free angle
  MeasureTerms
      cell_angle;   // per radian of a tetrahedron's dihedral angle: A and V less r² and r³ / 3
  Interval height;  // H
  bool has_angle;   // not all of the above but the height are 0
};
inline double width(const EdgeTerms& t) {
  return std::max({width(t.free_angle), width(t.cell_angle), width(t.height)});
}

struct TriangleTerms {
  MeasureTerms corners;  // of its corner tetrahedra
  Interval chord;        // D
};
// D enters the terms of two tetrahedra with up to four such numbers each, so it counts 16 times.
inline double width(const TriangleTerms& t) {
  return std::max(width(t.corners), 16 * width(t.chord));
}

// `exposed` says whether the edge has exposed arcs.
template <class T>
EdgeTerms edge_terms(const std::array<Sphere, 2>& balls, const std::array<Role, 2>& roles,
                     bool exposed);

// A triangle of the complex; edge k is opposite to ball k.
struct TriangleInput {
  std::array<Sphere, 3> balls;
  std::array<Role, 3> roles;
  std::array<const EdgeTerms*, 3> edges;
  int corners;  // exposed: 0, 1 or 2
};
template <class T>
TriangleTerms triangle_terms(const TriangleInput& in);

// A positively oriented tetrahedron of the complex. Facet k is opposite to ball k, edge p has the
// vertices kPairs[p].
struct CellInput {
  std::array<Sphere, 4> balls;
  std::array<Role, 4> roles;
  std::array<const EdgeTerms*, 6> edges;
  std::array<const Interval*, 4> chords;  // D of the facets
};
template <class T>
MeasureTerms cell_terms(const CellInput& in);

}  // namespace vdwmesh::certificate
