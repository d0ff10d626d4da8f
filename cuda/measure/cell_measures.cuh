// Area of the exposed part of the unit sphere and volume of unit ball ∩ power cell, by a warp, from
// the vertices of a PowerCell. The formulas are those of arrangement/arcs/arc_measure.hpp and
// arc_patch.hpp, which derive them:
//   area   = area(P) - sum phi (1 - t), modulo 4 pi
//   volume = (area + sum t F) / 3
// with the spherical polygon P, and for each face the cosine t of its cap, the exposed angle phi of
// its circle and its area F. The sum over faces of t times the straight part of F is taken edge by
// edge, so only the angles phi need sums for each face.
//
// 1. list_edges() gives each edge of the cell to a lane.
// 2. add_edges() cuts the edges by the sphere. Their ends on the sphere are corners, which are
//    listed, and whose factors are multiplied.
// 3. add_faces() multiplies, a face for each lane, the places of the corners on its circle.
// Whatever leaves a doubt ends the measurement.
#pragma once

#include "cuda/measure/power_cell.cuh"

namespace vdwmesh::measure {

struct Complex {
  double re, im;
};
__device__ inline Complex operator*(const Complex& a, const Complex& b) {
  return {fma(a.re, b.re, -(a.im * b.im)), fma(a.re, b.im, a.im * b.re)};
}

inline constexpr double kPi = 3.14159265358979323846;
// Doubts; see the constants of the same meaning in arrangement/arcs/.
inline constexpr double kNearSphere = 2e-9;       // of a vertex: squared distance from the sphere
inline constexpr double kNearlyParallel = 1e-10;  // squared sine between two planes
inline constexpr double kTangent = 2e-10;         // Gram determinant of an edge and its corner
inline constexpr double kTinyAngle = 1e-9;        // exposed angle of a circle
inline constexpr double kRounding = 64 * 2.220446049250313e-16;
inline constexpr double kMaxError = 1e-9;  // of the angle at a corner
inline constexpr double kMaxOpen = 1e-10;  // twice the vector area of the closed surface
inline constexpr double kPoleDistance = 1e-4;

struct UnitMeasures {
  double area, volume;
  Outcome outcome;
};

// A corner lies on the circles of two faces. The arc on the circle of `start` begins there, the arc
// on the circle of `end` ends.
struct Corner {
  Vec3d point;
  std::uint32_t start, end;
};

// Memory of a warp for the measurement.
template <int kSlots, int kFaces, int kCorners>
struct MeasureSpace {
  Vec3d position[32 * kSlots];
  Corner corner[kCorners];
  // The faces a and b of an edge and its upper and lower end, a byte each. The upper end is the
  // one in the direction of axis a × axis b.
  std::uint32_t edge[48 * kSlots];
  // Bits of faces. touched: an edge of the face meets the ball. beyond: the centre of its disk lies
  // beyond a neighbouring plane.
  unsigned used[(kFaces + 31) / 32], touched[(kFaces + 31) / 32], beyond[(kFaces + 31) / 32];
};

__device__ inline double sum_of_lanes(double x) {
#pragma unroll
  for (int step = 16; step > 0; step /= 2) x += __shfl_xor_sync(kWarp, x, step);
  return x;
}

// Brings the size of a factor to 1.
__device__ inline Complex unit(const Complex& z) {
  const double scale = rsqrt(fma(z.re, z.re, z.im * z.im));
  return {scale * z.re, scale * z.im};
}

__device__ inline Complex product_of_lanes(Complex z) {
  z = unit(z);
#pragma unroll
  for (int step = 16; step > 0; step /= 2) {
    z = z * Complex{__shfl_down_sync(kWarp, z.re, step), __shfl_down_sync(kWarp, z.im, step)};
  }
  return {__shfl_sync(kWarp, z.re, 0), __shfl_sync(kWarp, z.im, 0)};
}

// The argument in [0, 2 pi).
__device__ inline double argument(const Complex& z) {
  const double angle = atan2(z.im, z.re);
  return angle < 0 ? angle + 2 * kPi : angle;
}

// Poles to try in turn; see arc_patch.hpp.
inline constexpr int kPoleCount = 4;
__device__ inline Vec3d pole(int attempt) {
  if (attempt == 0) return {0.36, 0.48, 0.80};
  if (attempt == 1) return {-0.48, 0.60, 0.64};
  if (attempt == 2) return {0.28, -0.768, -0.576};
  return {-0.6, -0.48, -0.64};
}

template <int kSlots, int kFaces, int kCorners>
class CellMeasurement {
 public:
  using Cell = PowerCell<kSlots, kFaces>;
  using Space = MeasureSpace<kSlots, kFaces, kCorners>;

  __device__ CellMeasurement(const Cell& cell, Space& space, unsigned lane)
      : cell_(cell), space_(space), lane_(lane) {}

  __device__ UnitMeasures measure();

 private:
  __device__ void store_vertices();
  __device__ void list_edges();
  __device__ bool choose_pole();
  __device__ void add_edges();
  __device__ void add_edge(std::uint32_t packed, int (&ends)[2], Corner (&corner)[2]);
  __device__ void add_corner_factors(const Plane& a, const Plane& b, double cosine, double root,
                                     int corners, double side);
  __device__ void list_corners(const int (&ends)[2], const Corner (&corner)[2]);
  __device__ void add_faces();
  __device__ Complex exposed_arcs(std::uint32_t face, const Vec3d& axis, double sine, int& ends,
                                  int& balance) const;
  __device__ UnitMeasures result();
  __device__ bool doubtful() { return __any_sync(kWarp, doubt_); }

  const Cell& cell_;
  Space& space_;
  unsigned lane_;
  bool doubt_ = false;
  int edge_count_ = 0, corner_count_ = 0;
  Vec3d pole_{};
  // Sums of this lane, over edges.
  double moment_ = 0;  // sum t × straight part of 2 F
  Vec3d open_{0, 0, 0};
  Complex polygon_{1, 0}, turning_{1, 0};
  float condition_ = 0, worst_ = 1;
  // Sums of this lane, over faces.
  double angle_ = 0, sector_ = 0, pyramid_ = 0, largest_ = 0;
};

template <int kSlots, int kFaces, int kCorners>
__device__ UnitMeasures CellMeasurement<kSlots, kFaces, kCorners>::measure() {
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

template <int kSlots, int kFaces, int kCorners>
__device__ void CellMeasurement<kSlots, kFaces, kCorners>::store_vertices() {
#pragma unroll
  for (int k = 0; k < kSlots; ++k) {
    if (!cell_.has(k)) continue;
    const Vec3d& x = cell_.position(k);
    space_.position[32 * k + lane_] = x;
    doubt_ = doubt_ || fabs(squared_norm(x) - 1) < kNearSphere;
  }
  for (std::uint32_t i = lane_; i < (kFaces + 31) / 32; i += 32) {
    space_.used[i] = space_.touched[i] = space_.beyond[i] = 0;
  }
  __syncwarp();
}

// Each edge is listed by the end with the lower number. If the two ends do not name each other, the
// list of vertices is no polytope.
template <int kSlots, int kFaces, int kCorners>
__device__ void CellMeasurement<kSlots, kFaces, kCorners>::list_edges() {
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
        w = cell.vertex[b * kFaces + a];
        const std::uint32_t other = cell.faces_of[w];
        bool paired = false;
        for (int j = 0; j < 3; ++j) {
          paired = paired || (face_of(other, j) == b && face_of(other, (j + 1) % 3) == a);
        }
        if (!paired || !cell_.has_vertex(w) || cell.vertex[a * kFaces + b] != v) doubt_ = true;
        lists = v < w;
      }
      const unsigned listing = __ballot_sync(kWarp, lists);
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
template <int kSlots, int kFaces, int kCorners>
__device__ bool CellMeasurement<kSlots, kFaces, kCorners>::choose_pole() {
  for (int attempt = 0; attempt < kPoleCount; ++attempt) {
    pole_ = pole(attempt);
    bool bad = false;
    for (std::uint32_t f = lane_; f < cell_.face_count(); f += 32) {
      bad = bad || 1 + dot(pole_, cell_.space().face[f].axis) < kPoleDistance;
    }
    if (!__any_sync(kWarp, bad)) return true;
  }
  return false;
}

template <int kSlots, int kFaces, int kCorners>
__device__ void CellMeasurement<kSlots, kFaces, kCorners>::add_edges() {
  for (int base = 0; base < edge_count_; base += 32) {
    const int e = base + static_cast<int>(lane_);
    int ends[2] = {0, 0};
    Corner corner[2];
    if (e < edge_count_) add_edge(space_.edge[e], ends, corner);
    list_corners(ends, corner);
  }
  __syncwarp();
}

// Adds one edge to the sums. ends[0] and ends[1] become 1 if the upper and lower end of the edge's
// part in the ball are corners.
template <int kSlots, int kFaces, int kCorners>
__device__ void CellMeasurement<kSlots, kFaces, kCorners>::add_edge(std::uint32_t packed,
                                                                    int (&ends)[2],
                                                                    Corner (&corner)[2]) {
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
  atomicOr(&space_.used[ia / 32], 1u << ia % 32);
  atomicOr(&space_.used[ib / 32], 1u << ib % 32);
  if (toward_b <= 0) atomicOr(&space_.beyond[ia / 32], 1u << ia % 32);
  if (toward_a <= 0) atomicOr(&space_.beyond[ib / 32], 1u << ib % 32);
  const double inverse = 1 / squared_sine;
  double top = dot(upper, normal) * inverse, bottom = dot(lower, normal) * inverse;
  const bool top_out = squared_norm(upper) > 1, bottom_out = squared_norm(lower) > 1;
  if (top_out && bottom_out) {
    const bool spans = top > 0 && bottom < 0;  // the edge has the point of its line nearest to 0
    doubt_ = doubt_ || (spans && !(fabs(gram) > kTangent));
    if (!spans || gram < 0) return;
  }
  doubt_ = doubt_ || !(squared_sine > kNearlyParallel);
  atomicOr(&space_.touched[ia / 32], 1u << ia % 32);
  atomicOr(&space_.touched[ib / 32], 1u << ib % 32);
  double root = 0;
  if (top_out || bottom_out) {
    doubt_ = doubt_ || !(gram > 0);
    root = sqrt(gram);
    const double scale = root * inverse;
    if (top_out) top = scale;
    if (bottom_out) bottom = -scale;
    const Vec3d middle = a.cosine * a.axis + (toward_b * inverse) * fused_cross(normal, a.axis);
    const Vec3d arm = a.cosine * a.axis - b.cosine * b.axis;
    const Vec3d half = scale * normal;
    if (top_out) {
      ends[0] = 1;
      corner[0] = {middle + half, ia, ib};
      open_ = open_ + fused_cross(arm, corner[0].point);
    }
    if (bottom_out) {
      ends[1] = 1;
      corner[1] = {middle - half, ib, ia};
      open_ = open_ - fused_cross(arm, corner[1].point);
    }
    // det(pole, axis a, axis b), with the sign of the end
    const double side = dot(pole_, normal) * (ends[0] - ends[1]);
    add_corner_factors(a, b, cosine, root, ends[0] + ends[1], side);
  }
  const double moment = top - bottom;
  moment_ = fma(fma(a.cosine, toward_b, b.cosine * toward_a), moment, moment_);
  open_ = open_ + (toward_b * moment) * a.axis + (toward_a * moment) * b.axis;
}

template <int kSlots, int kFaces, int kCorners>
__device__ void CellMeasurement<kSlots, kFaces, kCorners>::add_corner_factors(
    const Plane& a, const Plane& b, double cosine, double root, int corners, double side) {
  const Complex triangle{1 + a.cosine + b.cosine + cosine, -root};
  const Complex turn{cosine - a.cosine * b.cosine, root};
  polygon_ = polygon_ * triangle;
  turning_ = turning_ * turn;
  if (corners == 2) {
    polygon_ = polygon_ * triangle;
    turning_ = turning_ * turn;
  } else {
    const double sum = dot(pole_, a.axis) + dot(pole_, b.axis);
    polygon_ = polygon_ * Complex{1 + sum + cosine, side};
  }
  const auto condition = static_cast<float>(1 / root + 1 / (1 + a.cosine) + 1 / (1 + b.cosine));
  condition_ += static_cast<float>(corners) * condition;
  worst_ = fmaxf(worst_, condition);
  // A long chain of factors stays far from the limits of double.
  polygon_ = unit(polygon_);
  turning_ = unit(turning_);
}

template <int kSlots, int kFaces, int kCorners>
__device__ void CellMeasurement<kSlots, kFaces, kCorners>::list_corners(const int (&ends)[2],
                                                                        const Corner (&corner)[2]) {
#pragma unroll
  for (int i = 0; i < 2; ++i) {
    const unsigned listing = __ballot_sync(kWarp, ends[i] != 0);
    const int place = corner_count_ + __popc(listing & lanes_before());
    if (ends[i] != 0 && place < kCorners) space_.corner[place] = corner[i];
    corner_count_ += __popc(listing);
  }
}

// The product of the arcs' ends and conjugated starts on the circle of a face.
template <int kSlots, int kFaces, int kCorners>
__device__ Complex CellMeasurement<kSlots, kFaces, kCorners>::exposed_arcs(std::uint32_t face,
                                                                           const Vec3d& axis,
                                                                           double sine, int& ends,
                                                                           int& balance) const {
  Complex product{1, 0};
  const vdwmesh::arcs::Frame frame = vdwmesh::arcs::frame_of(axis);
  const double scale = 1 / sine;
  for (int c = 0; c < corner_count_; ++c) {
    const Corner& corner = space_.corner[c];
    if (corner.start != face && corner.end != face) continue;
    const int direction = corner.end == face ? 1 : -1;
    const double re = scale * dot(frame.first, corner.point);
    const double im = scale * dot(frame.second, corner.point);
    product = product * Complex{re, direction * im};
    balance += direction;
    ++ends;
  }
  return product;
}

template <int kSlots, int kFaces, int kCorners>
__device__ void CellMeasurement<kSlots, kFaces, kCorners>::add_faces() {
  for (std::uint32_t base = 0; base < cell_.face_count(); base += 32) {
    const std::uint32_t f = base + lane_;
    const bool used = f < cell_.face_count() && (space_.used[base / 32] >> lane_ & 1);
    if (!used) continue;
    const Plane face = cell_.space().face[f];
    if (!(face.cosine < 1)) continue;  // a side of the first box
    const double drop = 1 - face.cosine;
    const double squared_sine = drop * (1 + face.cosine);
    const bool touched = space_.touched[base / 32] >> lane_ & 1;
    const bool beyond = space_.beyond[base / 32] >> lane_ & 1;
    double angle = 0;
    if (!touched && !beyond) angle = 2 * kPi;  // a whole disk
    if (touched && corner_count_ > 0) {
      int ends = 0, balance = 0;
      const Complex arcs_product = exposed_arcs(f, face.axis, sqrt(squared_sine), ends, balance);
      if (ends > 0) {
        angle = argument(arcs_product);
        doubt_ = doubt_ || balance != 0 || !(angle > kTinyAngle && angle < 2 * kPi - kTinyAngle);
        angle_ += angle;
      }
    }
    sector_ = fma(angle, drop, sector_);
    pyramid_ = fma(0.5 * face.cosine * squared_sine, angle, pyramid_);
    largest_ = fmax(largest_, 2 * kPi * drop);
  }
}

// Adds up the lanes and checks the sums.
template <int kSlots, int kFaces, int kCorners>
__device__ UnitMeasures CellMeasurement<kSlots, kFaces, kCorners>::result() {
  const double pyramid = sum_of_lanes(fma(0.5, moment_, pyramid_));
  const double sector = sum_of_lanes(sector_);
  const Vec3d open{sum_of_lanes(open_.x), sum_of_lanes(open_.y), sum_of_lanes(open_.z)};
  bool doubt = !(squared_norm(open) <= kMaxOpen * kMaxOpen);
  bool touched = false;
  for (int i = 0; i < (kFaces + 31) / 32; ++i) touched = touched || space_.touched[i] != 0;
  // Without corners the patch is the sphere less whole disks, or nothing.
  double area = touched || sector == 0 ? 0 : 4 * kPi - sector;
  if (corner_count_ > 0) {
    const double polygon = 2 * argument(product_of_lanes(polygon_));
    const double turning = argument(product_of_lanes(turning_));
    double largest = largest_;
    float worst = worst_;
    for (int step = 16; step > 0; step /= 2) {
      largest = fmax(largest, __shfl_xor_sync(kWarp, largest, step));
      worst = fmaxf(worst, __shfl_xor_sync(kWarp, worst, step));
    }
    const double condition = 1 + sum_of_lanes(condition_);
    const double full = 4 * kPi;
    area = polygon - sector;
    area -= full * floor(area / full);
    if (area > full - 0.5 * largest) area -= full;
    const double turns = (polygon - sum_of_lanes(angle_) + turning) / (2 * kPi);
    const double miss = 2 * kPi * fabs(turns - rint(turns));
    doubt = doubt || !(miss <= kRounding * condition) || !(kRounding * worst <= kMaxError);
  }
  const double volume = (area + pyramid) / 3;
  const double most = 4 * kPi + kMaxError;
  doubt = doubt || !(fabs(area) <= most && fabs(volume) <= most);
  return {area, volume, doubt ? Outcome::doubtful : Outcome::good};
}

}  // namespace vdwmesh::measure
