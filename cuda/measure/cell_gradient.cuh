// Derivatives by one ball, by a warp, from a PowerCell that a CellMeasurement has measured: the
// sums of measures/arcs/face_rates.hpp, in units of the ball's radius.
//
// 1. add_faces(): a face for each lane. Adds what its exposed angle counts for, also by the sector
//    of its area, and writes down what its arcs and segments will count for.
// 2. add_edges(): an edge for each lane, which is a segment of two faces. With the segment from p
//    to q, counter-clockwise about a face's axis n, s = n · (p × q) is twice the area of the
//    triangle over it, and s (p + q) / 6 the integral over that of the place. An end that is a
//    corner is the start of an arc of one face and the end of one of the other: T of face_rates.hpp
//    is the sum of n × (start - end).
// 3. share(): adds up the lanes; four of them have one of the eight derivatives.
#pragma once

#include "cuda/measure/cell_measures.cuh"
#include "measures/arcs/face_rates.hpp"

namespace vdwmesh::measure {

// Keeps of a measurement what derivatives need: of each edge its ends, and the exposed angles.
struct GradientNotes {
  std::uint32_t* ends;  // by edge: upper end, lower end << 16; or kNoPart
  FaceTerms* terms;
  static constexpr std::uint32_t kNoPart = 0xffffffffu;

  __device__ __forceinline__ void edge(int e, bool meets, std::uint32_t upper,
                                       std::uint32_t lower) const {
    ends[e] = meets ? upper | lower << 16 : kNoPart;
  }
  __device__ __forceinline__ void angle(std::uint32_t face, double angle) const {
    terms[face].angle = angle;
  }
};

// A ball or a neighbour of it, with its weights.
struct WeightedBall {
  Sphere ball;
  arcs::BallWeights weights;
};

template <int kSlots, int kFaces, int kCorners>
class CellGradient {
 public:
  using Measure = MeasureSpace<kSlots, kFaces, kCorners>;

  __device__ __forceinline__ CellGradient(CellSpace<kSlots, kFaces>& cell, const Measure& measure,
                                          const std::uint32_t* ends, unsigned lane)
      : cell_(cell), measure_(measure), ends_(ends), lane_(lane) {}

  // neighbor(f) is the ball of face f; uses(f) whether the face bounds the cell.
  template <class Uses, class Neighbor>
  __device__ __forceinline__ void add_faces(const WeightedBall& own, std::uint32_t faces,
                                            const Uses& uses, const Neighbor& neighbor) {
    // Numbers of the first box's sides are used again once the sides are cut off.
    __syncwarp();
    for (std::uint32_t f = lane_; f < faces; f += 32) {
      const bool of_box = !(cell_.face[f].cosine < 1);
      if (uses(f) && !of_box) add_face(own, neighbor(f), f);
    }
    __syncwarp();
  }

  __device__ __forceinline__ void add_edges(int edges) {
    for (int e = static_cast<int>(lane_); e < edges; e += 32) {
      if (ends_[e] != GradientNotes::kNoPart) add_edge(measure_.edge[e], ends_[e]);
    }
  }

  // The sum of all lanes of derivative lane / 4, in the order of BallGradient.
  __device__ __forceinline__ double share() const {
    double v[8] = {area_center_.x,   area_center_.y,   area_center_.z,   area_radius_,
                   volume_center_.x, volume_center_.y, volume_center_.z, volume_radius_};
#pragma unroll
    for (int half = 4, bit = 16; half > 0; half /= 2, bit /= 2) {
      const bool upper = (lane_ & static_cast<unsigned>(bit)) != 0;
#pragma unroll
      for (int k = 0; k < half; ++k) {
        const double kept = upper ? v[k + half] : v[k], sent = upper ? v[k] : v[k + half];
        v[k] = kept + __shfl_xor_sync(kAllLanes, sent, bit);
      }
    }
    return joined_by_warp<2>(v[0], [](double a, double b) { return a + b; });
  }

 private:
  __device__ __forceinline__ void add_face(const WeightedBall& own, const WeightedBall& other,
                                           std::uint32_t f) {
    FaceTerms& terms = cell_.terms[f];
    if (arcs::only_touch(own.ball, other.ball)) {
      terms = {};
      return;
    }
    const Plane plane = cell_.face[f];
    const arcs::SharedPlane shared =
        arcs::shared_plane(own.ball, other.ball, {plane.axis, plane.cosine});
    const double r = own.ball.radius;
    const arcs::FaceRates rates =
        arcs::face_rates(r, other.ball.radius, shared, own.weights, other.weights);
    const double squared = (1 - plane.cosine) * (1 + plane.cosine), angle = terms.angle,
                 sector = 0.5 * squared * angle;
    area_center_ = area_center_ + (angle * rates.angle_along) * plane.axis;
    area_radius_ += angle * rates.angle_radius;
    volume_center_ = volume_center_ + (sector * rates.area_along) * plane.axis;
    volume_radius_ += sector * rates.area_radius;
    // A moment in units of the ball's radius has one length more than an area.
    const double moment = r * rates.moment;
    terms.area_arc = r * rates.arc;
    terms.volume_arc = (1.0 / 3) * squared * moment;
    terms.segment = (1.0 / 6) * moment;
    terms.along = 0.5 * rates.area_along - (1.0 / 3) * plane.cosine * moment;
  }

  __device__ __forceinline__ const Vec3d& place_of(std::uint32_t end) const {
    return end & kCornerEnd ? measure_.corner[end & ~kCornerEnd].point : measure_.position[end];
  }

  __device__ __forceinline__ void add_edge(std::uint32_t packed, std::uint32_t ends) {
    const std::uint32_t ia = packed & 0xff, ib = packed >> 8 & 0xff;
    const std::uint32_t upper = ends & 0xffff, lower = ends >> 16;
    const Vec3d p = place_of(lower), q = place_of(upper);
    const Vec3d axis_a = cell_.face[ia].axis, axis_b = cell_.face[ib].axis;
    const FaceTerms &a = cell_.terms[ia], &b = cell_.terms[ib];
    // From the lower end to the upper one the edge runs counter-clockwise about a.
    const Vec3d turned = cross(p, q);
    const double of_a = dot(axis_a, turned), of_b = -dot(axis_b, turned);
    const double both = of_a * a.segment + of_b * b.segment;
    volume_center_ =
        volume_center_ + both * (p + q) + (of_a * a.along) * axis_a + (of_b * b.along) * axis_b;
    volume_radius_ += 3 * both;
    if (((upper | lower) & kCornerEnd) == 0) return;
    Vec3d start_less_end{0, 0, 0};  // of arcs of a
    if (upper & kCornerEnd) start_less_end = q;
    if (lower & kCornerEnd) start_less_end = start_less_end - p;
    area_center_ = area_center_ + cross(a.area_arc * axis_a - b.area_arc * axis_b, start_less_end);
    volume_center_ =
        volume_center_ + cross(a.volume_arc * axis_a - b.volume_arc * axis_b, start_less_end);
  }

  CellSpace<kSlots, kFaces>& cell_;
  const Measure& measure_;
  const std::uint32_t* ends_;
  unsigned lane_;
  // Sums of this lane. Those of volume are divided by the squared radius.
  Vec3d area_center_{0, 0, 0}, volume_center_{0, 0, 0};
  double area_radius_ = 0, volume_radius_ = 0;
};

}  // namespace vdwmesh::measure
