// What the search for crossing triangles on the device knows about each patch before it compares
// patches: bounding boxes, whether a vertex has moved, and corners around which all patches are a
// star. No two triangles of a star cross (surface/star_fans.hpp has the proof), so that patches
// which share such a corner need not be compared.
//
// A patch has what the CPU's views of a level say (refine/level_view.hpp): one triangle on level 0,
// the four children of a parent triangle on level 1, and 16 triangles in four parts from level 2
// on. Its vertices come in kinds of three, one of each kind for each corner, and are numbered alike
// from every corner on. So the thread for corner c of a patch reads vertex (k + c) % 3 of a kind
// for vertex k, and sees the patch as if c were its first corner.
#pragma once

#include "cuda/refine/refine_levels.cuh"

namespace vdwmesh {

// The views of a level, with the members that the search needs. kQuarters: the number of quarters
// of a patch, which have boxes of their own: its triangles on level 1, its parts from level 2 on.
struct GivenPatches : GivenLevel {
  static constexpr int kQuarters = 0;
};

struct MidpointPatches : MidpointLevel {
  static constexpr int kQuarters = 4, kQuarterVertices = 3, kBorder = 3;
  static constexpr bool kHasParts = false;  // whether quarters have several triangles
  // The middle child begins where those of corners end; its corners are the midpoints.
  __device__ std::uint32_t vertex(std::uint64_t t, int i) const {
    return i < 3 ? parent.corners[3 * t + i] : mesh.corners[3 * (4 * t + 3) + i - 3];
  }
  static constexpr __host__ __device__ int corner_of(int triangle, int k) {
    return child_corner(triangle, k);
  }
  static constexpr __host__ __device__ int quarter_vertex(int quarter, int i) {
    return corner_of(quarter, i);
  }
  // The vertices of the border of the fan of corner 0, which runs counter-clockwise.
  static constexpr __host__ __device__ int border(int i) { return i == 0 ? 1 : i == 1 ? 4 : 2; }
  std::uint64_t corner_vertices() const { return parent.vertices; }
  // The patch to which half-edge h of the parent belongs.
  __device__ std::uint64_t patch_of(std::uint64_t h) const { return h / 3; }
};

// The parent was made by a subdivision too, and a patch is a triangle of the parent's own parent.
struct DividedPatches : MidpointLevel {
  static constexpr int kVertices = 15, kTriangles = 16;
  static constexpr int kQuarters = 4, kQuarterVertices = 6, kBorder = 5;
  static constexpr bool kHasParts = true;
  __host__ __device__ std::uint64_t patches() const { return parent.triangles / 4; }
  // Midpoint k of parent triangle 4 t + part.
  __device__ std::uint32_t midpoint_in(std::uint64_t t, int part, int k) const {
    return mesh.corners[3 * (16 * t + 4 * part + 3) + k];
  }
  __device__ std::uint32_t vertex(std::uint64_t t, int i) const {
    const int k = i % 3, next = k == 2 ? 0 : k + 1;
    if (i < 3) return parent.corners[3 * (4 * t + k)];
    if (i < 6) return parent.corners[3 * (4 * t + 3) + k];
    return i < 9 ? midpoint_in(t, k, 0) : i < 12 ? midpoint_in(t, next, 2) : midpoint_in(t, 3, k);
  }
  static constexpr __host__ __device__ int quarter_vertex(int part, int i) {
    const int before = (part + 2) % 3;
    if (part == 3) return i < 3 ? 3 + i : 9 + i;
    return i == 0   ? part
           : i == 1 ? 3 + part
           : i == 2 ? 3 + before
           : i == 3 ? 6 + part
           : i == 4 ? 12 + before
                    : 9 + before;
  }
  static constexpr __host__ __device__ int corner_of(int triangle, int k) {
    return quarter_vertex(triangle / 4, child_corner(triangle % 4, k));
  }
  static constexpr __host__ __device__ int border(int i) {
    return i == 0 ? 1 : i == 1 ? 7 : i == 2 ? 4 : i == 3 ? 10 : 2;
  }
  // The parent's parent is closed too: three edges for two triangles, a midpoint on each.
  std::uint64_t corner_vertices() const { return parent.vertices - 3 * patches() / 2; }
  __device__ std::uint64_t patch_of(std::uint64_t h) const { return h / 12; }
};

// A bounding box, Å, rounded outward to single precision. It holds what it bounds with its vertices
// before and after their moves, so it holds it too if some of these moves are taken back.
struct alignas(8) FloatBox {
  float lower[3], upper[3];
};

// Whether two boxes have a point in common.
__device__ inline bool overlap(const FloatBox& a, const FloatBox& b) {
  bool apart = false;
  for (int axis = 0; axis < 3; ++axis) {
    apart |= a.lower[axis] > b.upper[axis] || b.lower[axis] > a.upper[axis];
  }
  return !apart;
}

// This number is no vertex of a star.
inline constexpr std::uint32_t kNoStar = 0xffffffffu;

struct alignas(8) SurveyedPatch {
  FloatBox box;
  // The corners around which all patches were a star in pass 0, kNoStar for others.
  std::uint32_t star[3];
  // Byte c < 3 is of corner c; byte 3 fills the word that want_listed() changes. kWanted in any of
  // the three: the pass must test the patch. The survey and level 0 set it by the kind of vertex,
  // later passes in byte 0 alone. kFails, kCrosses: what the patch adds to the fan of corner c
  // (fan_state_of()).
  static constexpr unsigned kWanted = 1, kFails = 2, kCrosses = 4;
  std::uint8_t marks[4];
};

__device__ inline bool is_wanted(const SurveyedPatch& patch) {
  return ((patch.marks[0] | patch.marks[1] | patch.marks[2]) & SurveyedPatch::kWanted) != 0;
}

// A vertex of which a pass must test the patches: in pass 0 one that is away from where it started,
// since only pairs with one of them are tested. Later one that was just put back: only its
// triangles have changed, and a pair that crossed before had a moved vertex, which was put back.
__device__ inline bool has_wanted_state(const MoveStatesView& states, std::uint32_t v, int pass) {
  const MoveState state = states.of(v);
  if (pass > 0) return state == MoveState::just_undone;
  return state == MoveState::moved || state == MoveState::to_undo;
}

// ---- the directions of fans ----

// Adds the unit normal of each patch's corners to the directions of the three. They only choose the
// planes in which fans are judged, so the order of the sums does not matter. One thread per patch.
template <class Patches>
__global__ void add_directions(Patches level, Vec3f* directions) {
  const std::uint64_t t = thread_index();
  if (t >= level.patches()) return;
  std::uint32_t v[3];
  Vec3d p[3];
  for (int k = 0; k < 3; ++k) {
    v[k] = level.vertex(t, k);
    p[k] = level.mesh.positions[v[k]];
  }
  const Vec3d area = cross(p[1] - p[0], p[2] - p[0]);
  const double length = norm(area);
  if (!(length > 0)) return;
  const Vec3f normal = cast<float>((1 / length) * area);
  for (int k = 0; k < 3; ++k) {
    Vec3f& sum = directions[v[k]];
    atomicAdd(&sum.x, normal.x);
    atomicAdd(&sum.y, normal.y);
    atomicAdd(&sum.z, normal.z);
  }
}

// ---- stars ----

// The state of a fan: how many of its patches cross the positive x axis with their border, plus
// kFailure for each of them that proves nothing. The fan is a star if this is 1.
using FanState = unsigned long long;
inline constexpr FanState kFailure = FanState{1} << 32, kStarFan = 1;

// What a patch adds to the state of the fan of a corner, as SurveyedPatch::marks has it.
__device__ inline FanState fan_state_of(unsigned marks) {
  return ((marks & SurveyedPatch::kFails) != 0 ? kFailure : 0) +
         ((marks & SurveyedPatch::kCrosses) != 0 ? 1 : 0);
}

// A point of the plane onto which the patches around a vertex are projected.
struct FanPoint {
  double x, y;
};

__device__ inline double cross_of(const FanPoint& a, const FanPoint& b) {
  return a.x * b.y - a.y * b.x;
}
__device__ inline FanPoint operator-(const FanPoint& a, const FanPoint& b) {
  return {a.x - b.x, a.y - b.y};
}

// The map of the fan of a corner to a plane. Formulas, thresholds and their proof are those of
// FanLanes (surface/fan_lanes.hpp), for one corner instead of three.
class FanPlane {
 public:
  __device__ FanPlane(const Vec3d& corner, const Vec3f& direction) : corner_(corner) {
    const Vec3f unit = (1 / norm(direction)) * direction;
    const Vec3d n = cast<double>(unit);
    const double sign = n.z < 0 ? -1.0 : 1.0, a = -1 / (sign + n.z), b = n.x * n.y * a;
    first_ = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    second_ = {b, sign + n.y * n.y * a, -n.y};
  }
  __device__ FanPoint image(const Vec3d& p) {
    const Vec3d d = p - corner_;
    most_ = fmax(most_, fmax(fabs(d.x), fmax(fabs(d.y), fabs(d.z))));
    return {first_.x * d.x + first_.y * d.y + first_.z * d.z,
            second_.x * d.x + second_.y * d.y + second_.z * d.z};
  }
  // Whether a cross product is positive for certain. Precondition: all images were taken.
  __device__ bool is_positive(double product) const {
    return product > 0x1p-38 * most_ * most_ && most_ > 0x1p-400 && most_ < 0x1p400;
  }

 private:
  Vec3d corner_, first_, second_;
  double most_ = 0;  // the largest difference of coordinates, Å
};

// Judges a patch as a part of the fan of its corner 0, and returns the bits for its marks; `image`
// has the images of its vertices.
template <class Patches>
__device__ unsigned judge_in_fan(const FanPlane& plane,
                                 const FanPoint (&image)[Patches::kVertices]) {
  bool holds = true;
#pragma unroll
  for (int triangle = 0; triangle < Patches::kTriangles; ++triangle) {
    const FanPoint& a = image[Patches::corner_of(triangle, 0)];
    holds &= plane.is_positive(cross_of(image[Patches::corner_of(triangle, 1)] - a,
                                        image[Patches::corner_of(triangle, 2)] - a));
  }
  int crossings = 0;
#pragma unroll
  for (int i = 0; i + 1 < Patches::kBorder; ++i) {
    const FanPoint &a = image[Patches::border(i)], &b = image[Patches::border(i + 1)];
    holds &= plane.is_positive(cross_of(a, b));
    crossings += a.y < 0 && b.y >= 0;
  }
  if (!holds || crossings > 1) return SurveyedPatch::kFails;
  return crossings == 1 ? SurveyedPatch::kCrosses : 0;
}

// ---- the survey ----

__device__ inline void extend(float& lower, float& upper, double coordinate) {
  lower = fminf(lower, __double2float_rd(coordinate));
  upper = fmaxf(upper, __double2float_ru(coordinate));
}

// Which of a patch's vertices is number k as seen from corner c: three of each kind, which go round
// alike.
__device__ constexpr int seen_from(int c, int k) { return k / 3 * 3 + (k % 3 + c) % 3; }

// Writes the boxes of all patches and of their quarters, and which patches pass 0 must test, and
// judges the fans of their corners. Three threads per patch: that of corner c has the sides of the
// boxes along axis c. A midpoint starts between corners of its patch and of its part, which never
// move; only boxes of single triangles must hold the starts as well.
template <class Patches>
__global__ void survey_patches(Patches level, MoveStatesView states, SurveyedPatch* patches,
                               FloatBox* quarters, const Vec3f* directions, FanState* fans) {
  const std::uint64_t t = thread_index() / 3;
  if (t >= level.patches()) return;
  const int c = static_cast<int>(thread_index() % 3);
  constexpr int kVertices = Patches::kVertices;
  float lower = INFINITY, upper = -INFINITY;
  unsigned marks = 0;
  bool wanted = false;
  if constexpr (Patches::kQuarters == 0) {
    for (int i = 0; i < kVertices; ++i) {
      const std::uint32_t v = level.vertex(t, i);
      if (i == c) wanted = has_wanted_state(states, v, 0);
      extend(lower, upper, level.before(t, i)[c]);
      extend(lower, upper, level.mesh.positions[v][c]);
    }
  } else {
    float low[Patches::kQuarters], high[Patches::kQuarters];
    for (int quarter = 0; quarter < Patches::kQuarters; ++quarter) {
      low[quarter] = INFINITY;
      high[quarter] = -INFINITY;
    }
    const std::uint32_t corner = level.vertex(t, c);
    FanPlane plane(level.mesh.positions[corner], directions[corner]);
    FanPoint image[kVertices];
    double along[3];  // the corners' coordinates along axis c
#pragma unroll
    for (int i = 0; i < kVertices; ++i) {
      const std::uint32_t v = level.vertex(t, seen_from(c, i));
      if (i % 3 == 0) wanted |= has_wanted_state(states, v, 0);
      const Vec3d p = level.mesh.positions[v];
      image[i] = plane.image(p);
      if (i < 3) along[i] = p[c];
#pragma unroll
      for (int quarter = 0; quarter < Patches::kQuarters; ++quarter) {
#pragma unroll
        for (int k = 0; k < Patches::kQuarterVertices; ++k) {
          if (Patches::quarter_vertex(quarter, k) != i) continue;
          extend(low[quarter], high[quarter], p[c]);
          if (Patches::kQuarterVertices == 3 && i >= 3) {
            const double a = along[i % 3], b = along[(i + 1) % 3];
            extend(low[quarter], high[quarter], midpoint(Vec3d{a, a, a}, Vec3d{b, b, b}).x);
          }
        }
      }
    }
    marks = judge_in_fan<Patches>(plane, image);
    if (marks != 0) atomicAdd(&fans[corner], fan_state_of(marks));
#pragma unroll
    for (int quarter = 0; quarter < Patches::kQuarters; ++quarter) {
      lower = fminf(lower, low[quarter]);
      upper = fmaxf(upper, high[quarter]);
      FloatBox& box = quarters[Patches::kQuarters * t + (quarter < 3 ? (quarter + c) % 3 : 3)];
      box.lower[c] = low[quarter];
      box.upper[c] = high[quarter];
    }
  }
  patches[t].box.lower[c] = lower;
  patches[t].box.upper[c] = upper;
  patches[t].marks[c] = static_cast<std::uint8_t>(marks | (wanted ? SurveyedPatch::kWanted : 0));
  if (c == 0) patches[t].marks[3] = 0;
}

// Notes which corners of patches have stars, when all fans have been judged; `fans` is null if none
// were. One thread per patch.
template <class Patches>
__global__ void note_stars(Patches level, const FanState* fans, SurveyedPatch* patches) {
  const std::uint64_t t = thread_index();
  if (t >= level.patches()) return;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t v = fans != nullptr ? level.vertex(t, k) : kNoStar;
    patches[t].star[k] = fans != nullptr && fans[v] == kStarFan ? v : kNoStar;
  }
}

// Judges listed patches anew after vertices of them were put back, and corrects the states of their
// fans. Three threads per patch, one for each corner.
template <class Patches>
__global__ void renew_fans(Patches level, const std::uint32_t* listed,
                           const unsigned long long* count, SurveyedPatch* patches,
                           const Vec3f* directions, FanState* fans) {
  const std::uint64_t i = thread_index() / 3;
  if (i >= *count) return;
  const std::uint64_t t = listed[i];
  const int c = static_cast<int>(thread_index() % 3);
  const std::uint32_t corner = level.vertex(t, c);
  FanPlane plane(level.mesh.positions[corner], directions[corner]);
  FanPoint image[Patches::kVertices];
#pragma unroll
  for (int k = 0; k < Patches::kVertices; ++k) {
    image[k] = plane.image(level.mesh.positions[level.vertex(t, seen_from(c, k))]);
  }
  std::uint8_t& marks = patches[t].marks[c];
  const unsigned before = marks, now = judge_in_fan<Patches>(plane, image);
  const FanState change = fan_state_of(now) - fan_state_of(before);
  if (change != 0) atomicAdd(&fans[corner], change);
  marks = static_cast<std::uint8_t>((before & SurveyedPatch::kWanted) | now);
}

}  // namespace vdwmesh
