// The structures of DLPack's binary interface (github.com/dmlc/dlpack, version 0: those without a
// version number, which every consumer takes), by which libraries hand arrays to each other.
#pragma once

#include <cstdint>

namespace vdwmesh::python::dlpack {

inline constexpr std::int32_t kCuda = 2;                          // a device type
inline constexpr std::uint8_t kUnsigned = 1, kFloatingPoint = 2;  // type codes

struct Device {
  std::int32_t type, id;
};

struct DataType {
  std::uint8_t code, bits;
  std::uint16_t lanes;
};

struct Tensor {
  void* data;
  Device device;
  std::int32_t dimensions;
  DataType type;
  std::int64_t* shape;
  std::int64_t* strides;  // in elements
  std::uint64_t byte_offset;
};

// The consumer calls the deleter once it is done, on any thread.
struct ManagedTensor {
  Tensor tensor;
  void* context;
  void (*deleter)(ManagedTensor*);
};

}  // namespace vdwmesh::python::dlpack
