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

// The cell list of spheres in device memory, whose reach is their field_reach(): the list that
// field_list() makes on the host of the same spheres, element by element. `least_radius` is the
// smallest of theirs, Å. The spheres are not needed afterwards. If `given` is not null, these are
// the cells, and the spheres must fit them; levels without spheres stay in the view, empty.
DeviceCellList build_cell_list(const Sphere* spheres, std::size_t size, double least_radius,
                               const FieldModel& model, const Stream& stream,
                               const CellListFrame* given = nullptr);
// The same for the balls of the first frame.
inline DeviceCellList build_cell_list(const DeviceFrames::Data& balls, const FieldModel& model) {
  return build_cell_list(balls.rows.data(), balls.atoms, balls.least_radius, model, balls.work());
}

// Spheres on the host whose cell list is wanted on a device. `list` is made on the host and copied;
// if it is empty, the list is built on the device, with the cells of `frame` if that is not null.
struct ListToUpload {
  const SphereSet& spheres;
  std::optional<CellListView> list;
  const CellListFrame* frame;
};

// The list is made on the host, in `workspace`, if there are few spheres. Throws as field_list()
// does.
ListToUpload prepare_list(const SphereSet& spheres, const FieldModel& model,
                          const CellListFrame* frame, Workspace& workspace);
DeviceCellList upload_list(const ListToUpload& list, const FieldModel& model, const Stream& stream);

}  // namespace vdwmesh
