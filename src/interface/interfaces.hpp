// Interfaces between groups of balls, such as the chains of a complex: how much of their surfaces
// they take from each other, and where they touch.
//
// The surface is the boundary of the union. With balls that have grown by a probe it is the
// accessible surface, whose buried area is the usual measure of an interface (Chothia and Janin
// 1975, "Principles of protein-protein recognition"). A ball's exposed patch is measured with the
// balls of its own group alone, with those of one other group, and with all; the neighbours are
// found once. Only balls that overlap another group are measured more than once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/monitor.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// A ball that overlaps a ball of the other group, and the area of its exposed patch, Å²: with its
// own group alone, and in the pair. The difference is what the other group buries, >= 0 but for
// rounding.
struct InterfaceAtom {
  SphereId sphere;
  double alone, in_pair;

  double buried() const { return alone - in_pair; }
};

// Two balls that share a face of the pair's power diagram: the area of the face inside both balls,
// which lies in the plane of the circle in which their spheres meet. Å².
struct AtomContact {
  SphereId a, b;
  double area;
};

// Two groups, a < b, as they are with each other and with nobody else.
struct Interface {
  std::int32_t a, b;
  double area_a, area_b;             // Å² of each group alone
  double buried_a, buried_b;         // Å² that each loses to the other; both make the buried area
  double contact_area;               // Å², of all contacts
  std::vector<InterfaceAtom> atoms;  // of both groups, ascending
  std::vector<AtomContact> contacts;  // a of group a, b of group b; ascending
  // The two balls that overlap deepest: radius + radius - distance, Å.
  SphereId deepest_a, deepest_b;
  double overlap;

  double buried_area() const { return buried_a + buried_b; }
};

struct GroupAreas {
  std::uint64_t spheres;
  double alone;     // Å², of the group without all others
  double in_whole;  // Å², of the group's balls among all balls
};

struct Interfaces {
  // By sphere: the area of its patch with its own group alone, and among all balls. Å²; both are
  // NaN for a sphere that is in no group.
  std::vector<double> alone, in_whole;
  std::vector<GroupAreas> groups;  // by number
  std::vector<Interface> pairs;    // of groups with balls that overlap, ascending by (a, b)
};

// `group[i]` is the group of sphere i, from 0; a negative number: in none, so that the sphere only
// covers others in the whole. Areas are those that exact_union() by arcs has for the balls of one
// group, of a pair and of all, each measured by itself: the same bits for each ball, but for balls
// whose measures come from a triangulation. Results do not depend on the number of threads. Balls
// that are equal count for the lowest id, as in every union.
// Throws InvalidInput for an empty set, if there is not one group for each sphere, if a group's
// number is not below the number of spheres, or if a measure is not finite; and Cancelled.
Interfaces interfaces(const SphereSet& spheres, std::span<const std::int32_t> group,
                      Monitor* monitor = nullptr);

}  // namespace vdwmesh
