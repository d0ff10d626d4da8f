// Vec3: three coordinates with the usual operations, for host and device.
//
// CPU and CUDA results must agree bit for bit. The sources therefore say for every operation how it
// is rounded: fused multiply-adds are explicit, and all targets forbid the compiler to form others
// (-ffp-contract=off, and --fmad=false for nvcc).
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"

namespace vdwmesh {

template <class T>
struct Vec3 {
  T x, y, z;

  VDWMESH_HD constexpr T& operator[](int axis) { return axis == 0 ? x : (axis == 1 ? y : z); }
  VDWMESH_HD constexpr const T& operator[](int axis) const {
    return axis == 0 ? x : (axis == 1 ? y : z);
  }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3d = Vec3<double>;
using Vec3f = Vec3<float>;
using Vec3i = Vec3<std::int64_t>;

template <class T>
VDWMESH_HD constexpr Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <class T>
VDWMESH_HD constexpr Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class T>
VDWMESH_HD constexpr Vec3<T> operator*(T s, const Vec3<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}

// dot() rounds three times: the product of the x coordinates, then two fused multiply-adds.
template <class T>
VDWMESH_HD inline T dot(const Vec3<T>& a, const Vec3<T>& b) {
  using std::fma;
  return fma(a.z, b.z, fma(a.y, b.y, a.x * b.x));
}

// cross() has no fma: both products of a component are rounded, so cross(a, a) is exactly 0 and
// cross(b, a) is exactly -cross(a, b).
template <class T>
VDWMESH_HD inline Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
VDWMESH_HD inline T squared_norm(const Vec3<T>& a) {
  return dot(a, a);
}

template <class T>
VDWMESH_HD inline T norm(const Vec3<T>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

// Converts each coordinate, rounding as static_cast does.
template <class To, class From>
VDWMESH_HD constexpr Vec3<To> cast(const Vec3<From>& a) {
  return {static_cast<To>(a.x), static_cast<To>(a.y), static_cast<To>(a.z)};
}

}  // namespace vdwmesh
