// The balls of a DeviceFrames, and the cell lists that are built from them on the device.
#pragma once

#include <optional>

#include "cuda/memory/device_structures.cuh"
#include "cuda/on_device.hpp"

namespace vdwmesh {

// All work on the balls runs on the stream that they were made on, so their memory is given back
// after it, however a call ends.
struct DeviceFrames::Data {
  int device = 0;
  std::size_t frames = 0, atoms = 0, valid_frames = 0;
  std::optional<InvalidFrame> invalid;
  Box balls{}, centers{};
  double least_radius = 0;
  std::optional<Stream> stream;
  DeviceArray<Sphere> rows;  // frames × atoms

  explicit Data(int on) : device(on) {}
  ~Data();
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  const Stream& work() const { return *stream; }
};

// The cell list of the first frame's balls, whose reach is their field_reach(): the list that
// field_list() makes on the host of the same spheres, element by element.
DeviceCellList build_cell_list(const DeviceFrames::Data& balls, const FieldModel& model);

}  // namespace vdwmesh
