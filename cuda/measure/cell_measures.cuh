// Area of the exposed part of the unit sphere and volume of unit ball ∩ power cell, by a warp, from
// the vertices of a PowerCell. Let t be the cosine of a face's cap, phi the exposed angle of its
// circle, F its area, and P the spherical polygon that replaces each arc of the patch's boundary by
// two great-circle segments: to the point where the cap's axis meets the sphere, and on from there.
//   area   = area(P) - sum phi (1 - t), modulo 4 pi       the patch is P without sectors of caps
//   volume = (area + sum t F) / 3                         divergence theorem about the centre
// P is divided into spherical triangles, for each corner of circles a and b one of axis a, corner
// and axis b, and one of a pole and both axes, with a pole common to all. Unit vectors u, v, w span
// the solid angle 2 arg(1 + u·v + v·w + w·u + i det(u, v, w)) (Van Oosterom and Strackee 1983, "The
// solid angle of a plane triangle"), so half the area of P is the argument of a product. The sum
// over faces of t times the straight part of F is taken edge by edge, so only the angles phi need
// sums for each face.
//
// 1. list_edges() gives each edge of the cell to a lane.
// 2. add_edges() cuts the edges by the sphere. Their ends on the sphere are corners, which are
//    listed, and whose factors are multiplied.
// 3. add_faces() multiplies, a face for each lane, the places of the corners on its circle.
// Whatever leaves a doubt ends the measurement.
#pragma once

#include "cuda/measure/power_cell.cuh"
#include "measures/arcs/doubts.hpp"

namespace vdwmesh::measure {

struct UnitFactor {
  double re, im;
};
__device__ __forceinline__ UnitFactor operator*(const UnitFactor& a, const UnitFactor& b) {
  return {fma(a.re, b.re, -(a.im * b.im)), fma(a.re, b.im, a.im * b.re)};
}

inline constexpr double kPi = 3.14159265358979323846;
// What else raises a doubt; the tolerances that both backends have are in measures/arcs/doubts.
using arcs::kMaxError, arcs::kMaxOpen, arcs::kNearlyParallel, arcs::kRounding, arcs::kTinyAngle;
// A vertex at the distance kTouching from the sphere has this squared distance from the centre,
// less 1.
inline constexpr double kNearSphere = 2 * arcs::kTouching;
inline constexpr double kTangent = 2e-10;  // Gram determinant of an edge and its corner
inline constexpr double kPoleDistance = 1e-4;

struct UnitMeasures {
  double area, volume;
  Outcome outcome;
};

// The part of an edge's line that lies in the ball: middle - half to middle + half. Which of its
// ends are corners of the patch, and whether the edge has a part in the ball.
struct ArcChord {
  Vec3d middle, half;
  bool upper, lower, meets;
};

// An end of an edge's part in the ball: a vertex, or a corner if this bit is set.
inline constexpr std::uint32_t kCornerEnd = 0x8000;

// What a measurement writes down of the edges that meet the ball and of the exposed angles of
// circles, for who goes on with them: nothing.
struct NoNotes {
  __device__ __forceinline__ void edge(int, bool, std::uint32_t, std::uint32_t) const {}
  __device__ __forceinline__ void angle(std::uint32_t, double) const {}
};

// A corner lies on the circles of two faces. The arc on the circle of `start` begins there, the arc
// on the circle of `end` ends.
struct CellCorner {
  Vec3d point;
  std::uint32_t start, end;
};

// Memory of a warp for the measurement.
template <int kSlots, int kFaces, int kCorners>
struct MeasureSpace {
  Vec3d position[32 * kSlots];
  CellCorner corner[kCorners];
  // The faces a and b of an edge and its upper and lower end, a byte each. The upper end is the
  // one in the direction of axis a × axis b.
  std::uint32_t edge[48 * kSlots];
};

// A set of faces. Each lane collects members; combine() gives all lanes the union.
template <int kFaces>
class FaceSet {
 public:
  __device__ __forceinline__ void add(std::uint32_t face, bool condition) {
    const unsigned bit = condition ? 1u << face % 32 : 0;
#pragma unroll
    for (std::uint32_t i = 0; i < kWords; ++i) word_[i] |= face / 32 == i ? bit : 0;
  }
  __device__ __forceinline__ void combine() {
#pragma unroll
    for (std::uint32_t i = 0; i < kWords; ++i) word_[i] = __reduce_or_sync(kAllLanes, word_[i]);
  }
  __device__ __forceinline__ bool has(std::uint32_t face) const {
    unsigned word = 0;
#pragma unroll
    for (std::uint32_t i = 0; i < kWords; ++i) {
      word |= word_[i] & -static_cast<unsigned>(face / 32 == i);
    }
    return word >> face % 32 & 1;
  }
  __device__ __forceinline__ bool empty() const {
    unsigned any = 0;
#pragma unroll
    for (std::uint32_t i = 0; i < kWords; ++i) any |= word_[i];
    return any == 0;
  }

 private:
  static constexpr std::uint32_t kWords = (kFaces + 31) / 32;
  unsigned word_[kWords] = {};
};

__device__ __forceinline__ double sum_of_lanes(double x) {
  return joined_by_warp(x, [](double a, double b) { return a + b; });
}

// Brings the size of a factor to 1.
__device__ __forceinline__ UnitFactor unit(const UnitFactor& z) {
  const double scale = rsqrt(fma(z.re, z.re, z.im * z.im));
  return {scale * z.re, scale * z.im};
}

__device__ __forceinline__ UnitFactor product_of_lanes(UnitFactor z) {
  z = unit(z);
#pragma unroll
  for (int step = 16; step > 0; step /= 2) {
    z = z * UnitFactor{__shfl_down_sync(kAllLanes, z.re, step),
                       __shfl_down_sync(kAllLanes, z.im, step)};
  }
  return {__shfl_sync(kAllLanes, z.re, 0), __shfl_sync(kAllLanes, z.im, 0)};
}

// The argument in [0, 2 pi).
__device__ __forceinline__ double argument(const UnitFactor& z) {
  const double angle = atan2(z.im, z.re);
  return angle < 0 ? angle + 2 * kPi : angle;
}

// Poles to try in turn: one opposite to an axis is bad, because the great circle between them is
// not determined. The directions have no symmetry, so that in a lattice at most one of them is bad.
inline constexpr int kPoleCount = 4;
__device__ __forceinline__ Vec3d pole(int attempt) {
  if (attempt == 0) return {0.36, 0.48, 0.80};
  if (attempt == 1) return {-0.48, 0.60, 0.64};
  if (attempt == 2) return {0.28, -0.768, -0.576};
  return {-0.6, -0.48, -0.64};
}

template <int kSlots, int kFaces, int kCorners, class Notes>
class CellMeasurement {
 public:
  using Cell = PowerCell<kSlots, kFaces>;
  using Space = MeasureSpace<kSlots, kFaces, kCorners>;

  __device__ __forceinline__ CellMeasurement(const Cell& cell, Space& space, unsigned lane,
                                             const Notes& notes)
      : cell_(cell), space_(space), lane_(lane), notes_(notes) {}

  __device__ __forceinline__ UnitMeasures measure();

  // Of a good measurement.
  __device__ __forceinline__ int edge_count() const { return edge_count_; }
  __device__ __forceinline__ bool uses(std::uint32_t face) const { return used_.has(face); }

 private:
  __device__ __forceinline__ void store_vertices();
  __device__ __forceinline__ void list_edges();
  __device__ __forceinline__ bool choose_pole();
  __device__ __forceinline__ void add_edges();
  __device__ __forceinline__ void add_edge(std::uint32_t packed, ArcChord& chord);
  __device__ __forceinline__ void add_corner_factors(const Plane& a, const Plane& b, double cosine,
                                                     double root, int corners, double side);
  __device__ __forceinline__ std::uint32_t list_corner(bool lists, const Vec3d& point,
                                                       std::uint32_t start, std::uint32_t end);
  __device__ __forceinline__ void add_faces();
  __device__ __forceinline__ void add_face(const Plane& face, std::uint32_t number, double angle,
                                           int ends, int balance);
  __device__ __forceinline__ UnitFactor exposed_arcs(std::uint32_t number, const Plane& face,
                                                     int& ends, int& balance) const;
  __device__ __forceinline__ UnitMeasures result();
  __device__ __forceinline__ bool doubtful() { return __any_sync(kAllLanes, doubt_); }

  const Cell& cell_;
  Space& space_;
  unsigned lane_;
  Notes notes_;
  bool doubt_ = false;
  int edge_count_ = 0, corner_count_ = 0;
  Vec3d pole_{};
  // touched: an edge of the face meets the ball. beyond: the centre of its disk lies beyond a
  // neighbouring plane.
  FaceSet<kFaces> used_, touched_, beyond_;
  // Sums of this lane, over edges.
  double moment_ = 0;  // sum t × straight part of 2 F
  Vec3d open_{0, 0, 0};
  UnitFactor polygon_{1, 0}, turning_{1, 0};
  float condition_ = 0, worst_ = 1;
  // Sums of this lane, over faces.
  double polygon_angle_ = 0, turning_angle_ = 0;
  double angle_ = 0, sector_ = 0, pyramid_ = 0, largest_ = 0;
};

template <int kSlots, int kFaces, int kCorners, class Notes>
__device__ __forceinline__ UnitMeasures
CellMeasurement<kSlots, kFaces, kCorners, Notes>::measure() {
  store_vertices();
  list_edges();
  if (!choose_pole() || doubtful()) return {0, 0, Outcome::doubtful};
  add_edges();
  if (doubtful()) return {0, 0, Outcome::doubtful};
  if (corner_count_ > kCorners) return {0, 0, Outcome::too_large};
  add_faces();
  if (doubtful()) return {0, 0, Outcome::doubtful};
  return result();
}

template <int kSlots, int kFaces, int kCorners, class Notes>
__device__ __forceinline__ void CellMeasurement<kSlots, kFaces, kCorners, Notes>::store_vertices() {
#pragma unroll
  for (int k = 0; k < kSlots; ++k) {
    if (!cell_.has(k)) continue;
    const Vec3d& x = cell_.position(k);
    space_.position[32 * k + lane_] = x;
    doubt_ = doubt_ || fabs(squared_norm(x) - 1) < kNearSphere;
  }
  __syncwarp();
}

// Each edge is listed by the end with the lower number. If the two ends do not name each other, the
// list of vertices is no polytope.
template <int kSlots, int kFaces, int kCorners, class Notes>
__device__ __forceinline__ void CellMeasurement<kSlots, kFaces, kCorners, Notes>::list_edges() {
  const auto& cell = cell_.space();
#pragma unroll
  for (int k = 0; k < kSlots; ++k) {
    if (cell_.alive(k) == 0) continue;
    const std::uint32_t v = 32 * k + lane_;
    const std::uint32_t faces = cell_.has(k) ? cell_.faces(k) : 0;
#pragma unroll
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = face_of(faces, i), b = face_of(faces, (i + 1) % 3);
      bool lists = false;
      std::uint32_t w = 0;
      if (cell_.has(k)) {
        w = cell.table.vertex[b * kFaces + a];
        const std::uint32_t other = cell.table.faces_of[w];
        bool paired = false;
        for (int j = 0; j < 3; ++j) {
          paired = paired || (face_of(other, j) == b && face_of(other, (j + 1) % 3) == a);
        }
        if (!paired || !cell_.has_vertex(w) || cell.table.vertex[a * kFaces + b] != v)
          doubt_ = true;
        lists = v < w;
      }
      const unsigned listing = __ballot_sync(kAllLanes, lists);
      if (lists) {
        const int place = edge_count_ + __popc(listing & lanes_before());
        if (place < 48 * kSlots) space_.edge[place] = a | b << 8 | v << 16 | w << 24;
      }
      edge_count_ += __popc(listing);
    }
  }
  if (edge_count_ > 48 * kSlots) doubt_ = true;
  __syncwarp();
}

// Takes the first pole that is far enough from the antipodes of all axes.
template <int kSlots, int kFaces, int kCorners, class Notes>
__device__ __forceinline__ bool CellMeasurement<kSlots, kFaces, kCorners, Notes>::choose_pole() {
  for (int attempt = 0; attempt < kPoleCount; ++attempt) {
    pole_ = pole(attempt);
    bool bad = false;
    for (std::uint32_t f = lane_; f < cell_.face_count(); f += 32) {
      bad = bad || 1 + dot(pole_, cell_.space().face[f].axis) < kPoleDistance;
    }
    if (!__any_sync(kAllLanes, bad)) return true;
  }
  return false;
}

template <int kSlots, int kFaces, int kCorners, class Notes>
__device__ __forceinline__ void CellMeasurement<kSlots, kFaces, kCorners, Notes>::add_edges() {
  for (int base = 0; base < edge_count_; base += 32) {
    const int e = base + static_cast<int>(lane_);
    ArcChord chord{};
    const std::uint32_t packed = e < edge_count_ ? space_.edge[e] : 0;
    if (e < edge_count_) add_edge(packed, chord);
    const std::uint32_t ia = packed & 0xff, ib = packed >> 8 & 0xff;
    const std::uint32_t upper = list_corner(chord.upper, chord.middle + chord.half, ia, ib),
                        lower = list_corner(chord.lower, chord.middle - chord.half, ib, ia);
    if (e < edge_count_) {
      notes_.edge(e, chord.meets, chord.upper ? upper | kCornerEnd : packed >> 16 & 0xff,
                  chord.lower ? lower | kCornerEnd : packed >> 24);
    }
  }
  used_.combine();
  touched_.combine();
  beyond_.combine();
  __syncwarp();
}

// Adds one edge to the sums. Fills the chord; its line only if an end of the edge's part in the
// ball is a corner.
template <int kSlots, int kFaces, int kCorners, class Notes>
__device__ __forceinline__ void CellMeasurement<kSlots, kFaces, kCorners, Notes>::add_edge(
    std::uint32_t packed, ArcChord& chord) {
  const std::uint32_t ia = packed & 0xff, ib = packed >> 8 & 0xff;
  const Plane a = cell_.space().face[ia];
  const Plane b = cell_.space().face[ib];
  const Vec3d& upper = space_.position[packed >> 16 & 0xff];
  const Vec3d& lower = space_.position[packed >> 24];
  const double cosine = dot(a.axis, b.axis);
  const double sign = cosine < 0 ? -1 : 1;
  const Vec3d apart = b.axis - sign * a.axis;
  const double toward_b = (b.cosine - sign * a.cosine) - a.cosine * dot(apart, a.axis);
  const double toward_a = (a.cosine - sign * b.cosine) + sign * b.cosine * dot(apart, b.axis);
  const Vec3d normal = fused_cross(a.axis, apart);
  const double squared_sine = squared_norm(normal);
  const double gram = fma((1 - a.cosine) * (1 + a.cosine), squared_sine, -(toward_b * toward_b));
  used_.add(ia, true);
  used_.add(ib, true);
  beyond_.add(ia, toward_b <= 0);
  beyond_.add(ib, toward_a <= 0);
  const double inverse = 1 / squared_sine;
  double top = dot(upper, normal) * inverse, bottom = dot(lower, normal) * inverse;
  const bool top_out = squared_norm(upper) > 1, bottom_out = squared_norm(lower) > 1;
  if (top_out && bottom_out) {
    const bool spans = top > 0 && bottom < 0;  // the edge has the point of its line nearest to 0
    doubt_ = doubt_ || (spans && !(fabs(gram) > kTangent));
    if (!spans || gram < 0) return;
  }
  doubt_ = doubt_ || !(squared_sine > kNearlyParallel);
  touched_.add(ia, true);
  touched_.add(ib, true);
  chord.meets = true;
  if (top_out || bottom_out) {
    doubt_ = doubt_ || !(gram > 0);
    const double root = sqrt(gram);
    const double scale = root * inverse;
    if (top_out) top = scale;
    if (bottom_out) bottom = -scale;
    chord.middle = a.cosine * a.axis + (toward_b * inverse) * fused_cross(normal, a.axis);
    chord.half = scale * normal;
    chord.upper = top_out;
    chord.lower = bottom_out;
    // The vector area of the arcs: arm × upper corner - arm × lower corner.
    const Vec3d arm = a.cosine * a.axis - b.cosine * b.axis;
    const double ends = top_out + bottom_out, difference = top_out - bottom_out;
    open_ = open_ + fused_cross(arm, difference * chord.middle + ends * chord.half);
    // det(pole, axis a, axis b), with the sign of the end
    const double side = dot(pole_, normal) * difference;
    add_corner_factors(a, b, cosine, root, top_out + bottom_out, side);
  }
  const double moment = top - bottom;
  moment_ = fma(fma(a.cosine, toward_b, b.cosine * toward_a), moment, moment_);
  open_ = open_ + (toward_b * moment) * a.axis + (toward_a * moment) * b.axis;
}

template <int kSlots, int kFaces, int kCorners, class Notes>
__device__ __forceinline__ void
CellMeasurement<kSlots, kFaces, kCorners, Notes>::add_corner_factors(const Plane& a, const Plane& b,
                                                                     double cosine, double root,
                                                                     int corners, double side) {
  const UnitFactor triangle{1 + a.cosine + b.cosine + cosine, -root};
  const UnitFactor turn{cosine - a.cosine * b.cosine, root};
  polygon_ = polygon_ * triangle;
  turning_ = turning_ * turn;
  if (corners == 2) {
    polygon_ = polygon_ * triangle;
    turning_ = turning_ * turn;
  } else {
    const double sum = dot(pole_, a.axis) + dot(pole_, b.axis);
    polygon_ = polygon_ * UnitFactor{1 + sum + cosine, side};
  }
  const float condition = 1 / static_cast<float>(root) + 1 / static_cast<float>(1 + a.cosine) +
                          1 / static_cast<float>(1 + b.cosine);
  condition_ += static_cast<float>(corners) * condition;
  worst_ = fmaxf(worst_, condition);
}

template <int kSlots, int kFaces, int kCorners, class Notes>
__device__ __forceinline__ std::uint32_t
CellMeasurement<kSlots, kFaces, kCorners, Notes>::list_corner(bool lists, const Vec3d& point,
                                                              std::uint32_t start,
                                                              std::uint32_t end) {
  const unsigned listing = __ballot_sync(kAllLanes, lists);
  const int place = corner_count_ + __popc(listing & lanes_before());
  if (lists && place < kCorners) space_.corner[place] = {point, start, end};
  corner_count_ += __popc(listing);
  return static_cast<std::uint32_t>(place);
}

// The product of the arcs' ends and conjugated starts on the circle of a face. Its size is a power
// of the circle's radius, which does not matter.
template <int kSlots, int kFaces, int kCorners, class Notes>
__device__ __forceinline__ UnitFactor
CellMeasurement<kSlots, kFaces, kCorners, Notes>::exposed_arcs(std::uint32_t number,
                                                               const Plane& face, int& ends,
                                                               int& balance) const {
  UnitFactor product{1, 0};
  const vdwmesh::arcs::AxisBasis frame = vdwmesh::arcs::frame_of(face.axis);
  for (int c = 0; c < corner_count_; ++c) {
    const CellCorner& corner = space_.corner[c];
    if (corner.start != number && corner.end != number) continue;
    const int direction = corner.end == number ? 1 : -1;
    const double re = dot(frame.first, corner.point), im = dot(frame.second, corner.point);
    product = product * UnitFactor{re, direction * im};
    balance += direction;
    ++ends;
  }
  return product;
}

// A face for each lane. Behind the faces come the two products of the patch, so that their
// arguments are computed along with the angles of the circles.
template <int kSlots, int kFaces, int kCorners, class Notes>
__device__ __forceinline__ void CellMeasurement<kSlots, kFaces, kCorners, Notes>::add_faces() {
  const std::uint32_t faces = cell_.face_count();
  const bool corners = corner_count_ > 0;
  const std::uint32_t tasks = corners ? faces + 2 : faces;
  if (corners) {
    polygon_ = product_of_lanes(polygon_);
    turning_ = product_of_lanes(turning_);
  }
  double argument_here = 0;
  for (std::uint32_t base = 0; base < tasks; base += 32) {
    const std::uint32_t f = base + lane_;
    const bool used = f < faces && used_.has(f);
    UnitFactor product = f == faces ? polygon_ : turning_;
    int ends = 0, balance = 0;
    Plane face{{0, 0, 1}, 1};
    if (used) {
      face = cell_.space().face[f];
      product = exposed_arcs(f, face, ends, balance);
    }
    const double angle = corners ? argument(product) : 0;
    if (used) {
      add_face(face, f, angle, ends, balance);
    } else if (f == faces || f == faces + 1) {
      argument_here = angle;
    }
  }
  polygon_angle_ = __shfl_sync(kAllLanes, argument_here, faces % 32);
  turning_angle_ = __shfl_sync(kAllLanes, argument_here, (faces + 1) % 32);
}

// `angle`: of the product of the arcs on the face's circle.
template <int kSlots, int kFaces, int kCorners, class Notes>
__device__ __forceinline__ void CellMeasurement<kSlots, kFaces, kCorners, Notes>::add_face(
    const Plane& face, std::uint32_t number, double angle, int ends, int balance) {
  if (!(face.cosine < 1)) return;  // a side of the first box
  const double drop = 1 - face.cosine;
  if (ends > 0) {
    doubt_ = doubt_ || balance != 0 || !(angle > kTinyAngle && angle < 2 * kPi - kTinyAngle);
    angle_ += angle;
  } else {  // a whole disk, or nothing of the circle
    angle = touched_.has(number) || beyond_.has(number) ? 0 : 2 * kPi;
  }
  notes_.angle(number, angle);
  sector_ = fma(angle, drop, sector_);
  pyramid_ = fma(0.5 * face.cosine * (drop * (1 + face.cosine)), angle, pyramid_);
  largest_ = fmax(largest_, 2 * kPi * drop);
}

// Adds up the lanes and checks the sums.
template <int kSlots, int kFaces, int kCorners, class Notes>
__device__ __forceinline__ UnitMeasures CellMeasurement<kSlots, kFaces, kCorners, Notes>::result() {
  const double pyramid = sum_of_lanes(fma(0.5, moment_, pyramid_));
  const double sector = sum_of_lanes(sector_);
  const Vec3d open{sum_of_lanes(open_.x), sum_of_lanes(open_.y), sum_of_lanes(open_.z)};
  bool doubt = !(squared_norm(open) <= kMaxOpen * kMaxOpen);
  // Without corners the patch is the sphere less whole disks, or nothing.
  double area = !touched_.empty() || sector == 0 ? 0 : 4 * kPi - sector;
  if (corner_count_ > 0) {
    const double polygon = 2 * polygon_angle_;  // the product holds half the area
    const double largest = joined_by_warp(largest_, [](double a, double b) { return fmax(a, b); });
    const float worst = joined_by_warp(worst_, [](float a, float b) { return fmaxf(a, b); });
    const double condition = 1 + sum_of_lanes(static_cast<double>(condition_));
    const double full = 4 * kPi;
    area = polygon - sector;
    area -= full * floor(area / full);
    if (area > full - 0.5 * largest) area -= full;
    const double turns = (polygon - sum_of_lanes(angle_) + turning_angle_) / (2 * kPi);
    const double miss = 2 * kPi * fabs(turns - rint(turns));
    doubt = doubt || !(miss <= kRounding * condition) || !(kRounding * worst <= kMaxError);
  }
  const double volume = (area + pyramid) / 3;
  const double most = 4 * kPi + kMaxError;
  doubt = doubt || !(fabs(area) <= most && fabs(volume) <= most);
  return {area, volume, doubt ? Outcome::doubtful : Outcome::good};
}

}  // namespace vdwmesh::measure
