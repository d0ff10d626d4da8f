// The power cell of one ball as a list of vertices, clipped by a warp (Ray, Sokolov, Lefebvre and
// Lévy 2018, "Meshless Voronoi on the GPU").
//
// Lengths are in units of the ball's radius and positions are relative to its centre. The cell
// begins as a box around the unit ball. Each vertex names the three faces that meet in it. A plane
// is compared with all vertices at once, a vertex for each lane and slot. An edge between a removed
// vertex and one that stays gets a new vertex, on the plane and on the two faces of the edge.
//
// Faces are counter-clockwise: if a vertex lists its faces as (i, j, k), then the determinant of
// their axes in this order is positive. The edge of faces i and j then leads from this vertex, as
// (i, j), to one that has the pair as (j, i), and no other vertex has either ordered pair. So a
// table by ordered pairs of faces finds the other end of every edge.
#pragma once

#include <cstdint>

#include "core/vec3.hpp"
#include "cuda/memory/warp.cuh"
#include "measures/arcs/arc_cap.hpp"

namespace vdwmesh::measure {

// What became of a ball: measured; measured with a doubt, so that the numbers mean nothing; or too
// large for the memory of the warp.
enum class Outcome : std::uint32_t { good, doubtful, too_large };

// A radical plane: dot(axis, x) = cosine. The cell lies where the left side is smaller.
struct alignas(16) Plane {
  Vec3d axis;
  double cosine;
};

// A vertex nearer than this to a plane may lie on the plane: rounding would decide on which side
// it is. Rounding errors of well-conditioned vertices are a thousandth of it.
inline constexpr double kNearPlane = 1e-11;
// The rounding error of a vertex is at most this, divided by the determinant of its three axes.
inline constexpr double kVertexError = 4e-15;
// Vertices of planes whose determinant is smaller are not computed.
inline constexpr double kLeastDeterminant = 1e-8;
// Half the side of the first box. Above 1, so that its faces do not meet the ball.
inline constexpr double kBox = 1.0625;

__device__ __forceinline__ Vec3d fused_cross(const Vec3d& a, const Vec3d& b) {
  return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}

__device__ __forceinline__ unsigned lanes_before() {
  unsigned mask;
  asm("mov.u32 %0, %%lanemask_lt;" : "=r"(mask));
  return mask;
}

// The tables by which a cell finds its edges. Vertex v is in slot v / 32 of lane v % 32.
template <int kSlots, int kFaces>
struct CellTables {
  std::uint32_t faces_of[32 * kSlots];   // three faces of a vertex, a byte each
  std::uint16_t border[32 * kSlots];     // of a cut: two faces of each new vertex, a byte each
  std::uint8_t vertex[kFaces * kFaces];  // [i * kFaces + j]: the vertex that has the pair (i, j)
};

// Of a face, for the derivatives (cell_gradient.cuh).
struct FaceTerms {
  double angle;                 // exposed, of its circle
  double area_arc, volume_arc;  // what axis × (start - end) of an arc counts for
  double segment, along;        // what s (p + q) and s axis of a segment count for
};

// Memory of a warp that the cell needs.
template <int kSlots, int kFaces>
struct CellSpace {
  static_assert(32 * kSlots <= 256 && kFaces <= 256, "vertices and faces are numbered by bytes");
  Plane face[kFaces];
  union {
    CellTables<kSlots, kFaces> table;  // until all edges are listed
    FaceTerms terms[kFaces];           // then
  };
};

__device__ __forceinline__ std::uint32_t face_of(std::uint32_t faces, int i) {
  return faces >> (8 * i) & 0xff;
}

// Every lane of the warp calls each function with the same arguments.
template <int kSlots, int kFaces>
class PowerCell {
 public:
  using Space = CellSpace<kSlots, kFaces>;

  __device__ __forceinline__ PowerCell(Space& space, unsigned lane) : space_(space), lane_(lane) {
    make_box();
  }

  // Removes what lies beyond the plane. Returns the face that has the plane, or kNoFace.
  static constexpr std::uint32_t kNoFace = 0xffffffffu;
  __device__ __forceinline__ std::uint32_t cut(const Plane& plane);

  __device__ __forceinline__ Outcome outcome() const { return outcome_; }
  __device__ __forceinline__ bool empty() const { return empty_; }
  // No vertex is farther from the centre.
  __device__ __forceinline__ float reach() const { return reach_; }
  __device__ __forceinline__ bool has(int slot) const { return alive_[slot] >> lane_ & 1; }
  __device__ __forceinline__ bool has_vertex(std::uint32_t vertex) const {
    return contains(alive_, vertex);
  }
  __device__ __forceinline__ unsigned alive(int slot) const { return alive_[slot]; }
  __device__ __forceinline__ const Vec3d& position(int slot) const { return position_[slot]; }
  __device__ __forceinline__ std::uint32_t faces(int slot) const { return faces_[slot]; }
  __device__ __forceinline__ std::uint32_t face_count() const { return next_face_; }
  __device__ __forceinline__ const Space& space() const { return space_; }

 private:
  __device__ __forceinline__ void make_box();
  __device__ __forceinline__ std::uint32_t face_with(const Plane& plane) const;
  __device__ __forceinline__ std::uint32_t new_face();
  __device__ __forceinline__ int find_border(const unsigned (&out)[kSlots]);
  __device__ __forceinline__ void add_vertices(int count, std::uint32_t fresh, const Plane& plane);
  __device__ __forceinline__ bool place_vertex(int slot, std::uint32_t first, std::uint32_t second,
                                               std::uint32_t fresh, const Plane& plane);
  __device__ __forceinline__ void set_vertex(int slot, std::uint32_t i, std::uint32_t j,
                                             std::uint32_t k);
  __device__ __forceinline__ void update_reach();
  __device__ __forceinline__ static bool contains(const unsigned (&set)[kSlots],
                                                  std::uint32_t vertex) {
    // Masks instead of a choice, of which the compiler would make an array in local memory.
    unsigned word = 0;
#pragma unroll
    for (int k = 0; k < kSlots; ++k) word |= set[k] & -static_cast<unsigned>(vertex / 32 == k);
    return word >> vertex % 32 & 1;
  }

  Space& space_;
  unsigned lane_;
  std::uint32_t next_face_ = 6;  // faces with smaller numbers have been used
  unsigned alive_[kSlots] = {};  // bit for each lane: it has a vertex in this slot
  Vec3d position_[kSlots];
  float margin_[kSlots];   // a plane that is nearer to the vertex leaves a doubt
  float squared_[kSlots];  // squared distance from the centre, rounded up
  std::uint32_t faces_[kSlots];
  float reach_;
  bool empty_ = false;
  Outcome outcome_ = Outcome::good;
};

template <int kSlots, int kFaces>
__device__ __forceinline__ void PowerCell<kSlots, kFaces>::set_vertex(int slot, std::uint32_t i,
                                                                      std::uint32_t j,
                                                                      std::uint32_t k) {
  const std::uint32_t v = 32 * slot + lane_;
  faces_[slot] = i | j << 8 | k << 16;
  space_.table.faces_of[v] = faces_[slot];
  space_.table.vertex[i * kFaces + j] = static_cast<std::uint8_t>(v);
  space_.table.vertex[j * kFaces + k] = static_cast<std::uint8_t>(v);
  space_.table.vertex[k * kFaces + i] = static_cast<std::uint8_t>(v);
}

// Faces 2 a and 2 a + 1 are the sides at kBox and -kBox along axis a.
template <int kSlots, int kFaces>
__device__ __forceinline__ void PowerCell<kSlots, kFaces>::make_box() {
  if (lane_ < 6) {
    Vec3d axis{0, 0, 0};
    const double sign = lane_ % 2 == 0 ? 1 : -1;
    if (lane_ / 2 == 0) axis.x = sign;
    if (lane_ / 2 == 1) axis.y = sign;
    if (lane_ / 2 == 2) axis.z = sign;
    space_.face[lane_] = {axis, kBox};
  }
  if (lane_ < 8) {
    const std::uint32_t x = lane_ & 1, y = lane_ >> 1 & 1, z = lane_ >> 2;
    position_[0] = {x ? -kBox : kBox, y ? -kBox : kBox, z ? -kBox : kBox};
    margin_[0] = static_cast<float>(kNearPlane);
    squared_[0] = __double2float_ru(3 * kBox * kBox);
    if ((x + y + z) % 2 == 0) {
      set_vertex(0, x, 2 + y, 4 + z);
    } else {
      set_vertex(0, 2 + y, x, 4 + z);
    }
  }
  alive_[0] = 0xff;
  reach_ = 2;
  __syncwarp();
}

// The face that has this plane, to the last bit, or kNoFace; such a plane cuts nothing off.
template <int kSlots, int kFaces>
__device__ __forceinline__ std::uint32_t PowerCell<kSlots, kFaces>::face_with(
    const Plane& plane) const {
  std::uint32_t same = kNoFace;
  for (std::uint32_t f = lane_; f < next_face_; f += 32) {
    const Plane& face = space_.face[f];
    if (face.cosine == plane.cosine && face.axis == plane.axis) same = f;
  }
  return __reduce_min_sync(kAllLanes, same);
}

template <int kSlots, int kFaces>
__device__ __forceinline__ std::uint32_t PowerCell<kSlots, kFaces>::cut(const Plane& plane) {
  unsigned out[kSlots];
  unsigned any = 0;
  bool near = false;
#pragma unroll
  for (int k = 0; k < kSlots; ++k) {
    out[k] = 0;
    if (k > 0 && alive_[k] == 0) continue;
    const double depth = has(k) ? dot(position_[k], plane.axis) - plane.cosine : -1.0;
    near = near || (has(k) && !(fabs(depth) > margin_[k]));
    out[k] = __ballot_sync(kAllLanes, depth > 0);
    any |= out[k];
  }
  if (__any_sync(kAllLanes, near)) {
    const std::uint32_t same = face_with(plane);
    if (same == kNoFace) outcome_ = Outcome::doubtful;
    return same;
  }
  if (any == 0) return kNoFace;
  const std::uint32_t fresh = new_face();
  if (fresh == kFaces) {
    outcome_ = Outcome::too_large;
    return kNoFace;
  }
  const int count = find_border(out);
  unsigned left = 0;
#pragma unroll
  for (int k = 0; k < kSlots; ++k) {
    alive_[k] &= ~out[k];
    left |= alive_[k];
  }
  empty_ = left == 0;
  if (empty_) return kNoFace;
  // A convex body loses one connected piece, which has a border of three edges or more.
  if (count < 3) {
    outcome_ = Outcome::doubtful;
    return kNoFace;
  }
  add_vertices(count, fresh, plane);
  update_reach();
  return fresh;
}

// Returns a number for a new face, or kFaces if there is none left. Numbers of faces that have lost
// all vertices are used again.
template <int kSlots, int kFaces>
__device__ __forceinline__ std::uint32_t PowerCell<kSlots, kFaces>::new_face() {
  if (next_face_ < kFaces) return next_face_++;
  for (std::uint32_t base = 0; base < kFaces; base += 32) {
    unsigned used = 0;
#pragma unroll
    for (int k = 0; k < kSlots; ++k) {
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t f = face_of(faces_[k], i) - base;
        if (has(k) && f < 32) used |= 1u << f;
      }
    }
    used = __reduce_or_sync(kAllLanes, used);
    if (used == kAllLanes) continue;
    const std::uint32_t free = base + static_cast<std::uint32_t>(__ffs(~used)) - 1;
    return free < kFaces ? free : kFaces;
  }
  return kFaces;
}

// Lists the edges between vertices that go, `out`, and vertices that stay. Returns their number.
template <int kSlots, int kFaces>
__device__ __forceinline__ int PowerCell<kSlots, kFaces>::find_border(
    const unsigned (&out)[kSlots]) {
  int count = 0;
#pragma unroll
  for (int k = 0; k < kSlots; ++k) {
    if (out[k] == 0) continue;
    const bool goes = out[k] >> lane_ & 1;
#pragma unroll
    for (int i = 0; i < 3; ++i) {
      bool crosses = false;
      std::uint32_t a = 0, b = 0;
      if (goes) {
        a = face_of(faces_[k], i);
        b = face_of(faces_[k], (i + 1) % 3);
        crosses = !contains(out, space_.table.vertex[b * kFaces + a]);
      }
      const unsigned crossing = __ballot_sync(kAllLanes, crosses);
      const int place = count + __popc(crossing & lanes_before());
      if (crosses && place < 32 * kSlots) {
        space_.table.border[place] = static_cast<std::uint16_t>(a | b << 8);
      }
      count += __popc(crossing);
    }
  }
  __syncwarp();
  return count;
}

// Gives the new vertices of the face `fresh` to lanes and slots that have none, the lowest first.
template <int kSlots, int kFaces>
__device__ __forceinline__ void PowerCell<kSlots, kFaces>::add_vertices(int count,
                                                                        std::uint32_t fresh,
                                                                        const Plane& plane) {
  if (lane_ == 0) space_.face[fresh] = plane;
  int given = 0;
  bool bad = false;
#pragma unroll
  for (int k = 0; k < kSlots; ++k) {
    if (given >= count) break;
    const unsigned free = ~alive_[k];
    const int number = given + __popc(free & lanes_before());
    const bool takes = (free >> lane_ & 1) && number < count;
    if (takes) {
      const std::uint32_t pair = space_.table.border[number];
      bad = !place_vertex(k, pair & 0xff, pair >> 8, fresh, plane) || bad;
    }
    alive_[k] |= __ballot_sync(kAllLanes, takes);
    given += __popc(free);
  }
  __syncwarp();
  if (given < count) outcome_ = Outcome::too_large;
  if (__any_sync(kAllLanes, bad)) outcome_ = Outcome::doubtful;
}

// Computes the common point of three planes. Returns false if they are nearly dependent.
template <int kSlots, int kFaces>
__device__ __forceinline__ bool PowerCell<kSlots, kFaces>::place_vertex(
    int slot, std::uint32_t first, std::uint32_t second, std::uint32_t fresh, const Plane& plane) {
  const Plane a = space_.face[first];
  const Plane b = space_.face[second];
  const Vec3d bc = fused_cross(b.axis, plane.axis);
  const Vec3d ca = fused_cross(plane.axis, a.axis);
  const Vec3d ab = fused_cross(a.axis, b.axis);
  const double determinant = dot(a.axis, bc);
  const double inverse = 1 / determinant;
  const Vec3d sum{fma(a.cosine, bc.x, fma(b.cosine, ca.x, plane.cosine * ab.x)),
                  fma(a.cosine, bc.y, fma(b.cosine, ca.y, plane.cosine * ab.y)),
                  fma(a.cosine, bc.z, fma(b.cosine, ca.z, plane.cosine * ab.z))};
  position_[slot] = inverse * sum;
  margin_[slot] = static_cast<float>(fma(kVertexError, fabs(inverse), kNearPlane));
  squared_[slot] = __double2float_ru(squared_norm(position_[slot]));
  set_vertex(slot, first, second, fresh);
  return determinant > kLeastDeterminant;
}

template <int kSlots, int kFaces>
__device__ __forceinline__ void PowerCell<kSlots, kFaces>::update_reach() {
  float farthest = 0;
#pragma unroll
  for (int k = 0; k < kSlots; ++k) farthest = has(k) ? fmaxf(farthest, squared_[k]) : farthest;
  // Floats that are not negative have the order of their bits.
  const unsigned bits = __reduce_max_sync(kAllLanes, __float_as_uint(farthest));
  reach_ = __fsqrt_ru(__uint_as_float(bits)) * 1.000001f;
}

}  // namespace vdwmesh::measure
