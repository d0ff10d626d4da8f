// Makes the balls of atoms whose coordinates lie in device memory. One kernel reads coordinates and
// radii where they lie, whatever their type and strides, writes the balls in rows, checks them, and
// finds the boxes around those of the first frame. Only the boxes and the index of the first bad
// row come to the host, which then says what is wrong with it.
#include <algorithm>
#include <string>

#include "cuda/cuda_backend.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/ordered_bits.cuh"
#include "cuda/memory/transfer.cuh"
#include "cuda/spheres/device_frames.cuh"
#include "measures/batch_frames.hpp"
#include "spheres/check_sphere.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;
constexpr unsigned kMostBlocks = 264;  // two for each multiprocessor of an H200

// Where a kernel reads the atoms.
struct AtomSource {
  FrameCoordinates centers;
  DeviceNumbers radii;
  double probe;
};

// A box in ordered bits; begins empty.
struct BoxBits {
  OrderedBits lower[3] = {kMostBits, kMostBits, kMostBits}, upper[3] = {0, 0, 0};

  __device__ void include(const Vec3d& lowest, const Vec3d& highest) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = min(lower[axis], ordered(lowest[axis]));
      upper[axis] = max(upper[axis], ordered(highest[axis]));
    }
  }
  // Joins the boxes of the lanes of a warp into `all`. All lanes call it.
  __device__ void join_warp_into(BoxBits& all) const {
    for (int axis = 0; axis < 3; ++axis) {
      const OrderedBits least = least_of_warp(lower[axis]), most = largest_of_warp(upper[axis]);
      if (threadIdx.x % kWarp != 0) continue;
      atomicMin(&all.lower[axis], least);
      atomicMax(&all.upper[axis], most);
    }
  }
  // Adding 0 turns -0 into 0, so that a box does not depend on the order of equal numbers.
  Box box() const {
    Box found{};
    for (int axis = 0; axis < 3; ++axis) {
      found.lower[axis] = from_ordered(lower[axis]) + 0.0;
      found.upper[axis] = from_ordered(upper[axis]) + 0.0;
    }
    return found;
  }
};

struct Survey {
  BoxBits balls, centers;
  OrderedBits least_radius = kMostBits;
  // Index of the first row that is no sphere, and of the first atom whose radius is none.
  unsigned long long bad_row = ~0ull, bad_radius = ~0ull;
};

__device__ double number_at(CoordinateType type, const std::byte* place) {
  if (type == CoordinateType::float64) return *reinterpret_cast<const double*>(place);
  return static_cast<double>(*reinterpret_cast<const float*>(place));
}

__device__ Vec3d center_at(const FrameCoordinates& from, std::uint64_t frame, std::uint64_t atom) {
  const std::byte* x = from.first + static_cast<std::ptrdiff_t>(frame) * from.frame_stride +
                       static_cast<std::ptrdiff_t>(atom) * from.atom_stride;
  Vec3d center{};
  for (int axis = 0; axis < 3; ++axis) {
    center[axis] = from.unit * number_at(from.type, x + axis * from.axis_stride);
  }
  return center;
}

// A thread for each row of a share of them, frames × atoms in all; the warps join what they found.
__global__ void gather_balls(AtomSource from, Sphere* rows, Survey* survey) {
  Survey own;
  const std::uint64_t count = from.centers.frames * from.centers.atoms;
  const std::uint64_t step = static_cast<std::uint64_t>(gridDim.x) * blockDim.x;
  for (std::uint64_t i = thread_index(); i < count; i += step) {
    const std::uint64_t atom = i % from.centers.atoms;
    const double radius = number_at(
        from.radii.type, from.radii.first + static_cast<std::ptrdiff_t>(atom) * from.radii.stride);
    const Vec3d c = center_at(from.centers, i / from.centers.atoms, atom);
    const double r = radius + from.probe;
    rows[i] = {c, r};
    if (!is_radius(radius, from.probe))
      atomicMin(&survey->bad_radius, static_cast<unsigned long long>(atom));
    if (!is_sphere({c, r})) atomicMin(&survey->bad_row, static_cast<unsigned long long>(i));
    if (i < from.centers.atoms) {  // the first frame, which alone is ever meshed
      own.centers.include(c, c);
      own.balls.include({c.x - r, c.y - r, c.z - r}, {c.x + r, c.y + r, c.z + r});
    }
    own.least_radius = min(own.least_radius, ordered(r));
  }
  own.balls.join_warp_into(survey->balls);
  own.centers.join_warp_into(survey->centers);
  const OrderedBits least = least_of_warp(own.least_radius);
  if (threadIdx.x % kWarp == 0) atomicMin(&survey->least_radius, least);
}

// A value in device memory, once the work that writes it is done.
template <class T>
T value_at(const void* place) {
  T value{};
  check_cuda(cudaMemcpy(&value, place, sizeof value, cudaMemcpyDeviceToHost), "download");
  return value;
}

double number_on_host(CoordinateType type, const std::byte* place) {
  if (type == CoordinateType::float64) return value_at<double>(place);
  return static_cast<double>(value_at<float>(place));
}

void check_size(const FrameCoordinates& centers) {
  if (centers.atoms == 0 || centers.frames == 0)
    throw InvalidInput("there are no frames or no atoms");
  if (centers.atoms >= kNoSphere / centers.frames) {
    throw InvalidInput(std::to_string(centers.frames) + " frames of " +
                       std::to_string(centers.atoms) + " atoms; at most " +
                       std::to_string(kNoSphere - 1) + " balls fit");
  }
}

// Fills `data` with the balls and with what is known of them.
void gather(DeviceFrames::Data& data, const AtomSource& from) {
  const Stream& stream = data.work();
  const std::size_t count = data.frames * data.atoms;
  data.rows = DeviceArray<Sphere>(count, stream);
  const Survey start;
  const DeviceArray<Survey> survey = upload(&start, 1, stream);
  launch("gather_balls", gather_balls,
         {std::min(blocks_for(count, kThreads), kMostBlocks), kThreads}, stream, from,
         data.rows.data(), survey.data());
  const Survey found = fetch(survey.data(), stream);
  if (found.bad_radius != ~0ull) {
    const auto offset = static_cast<std::ptrdiff_t>(found.bad_radius) * from.radii.stride;
    const double radius = number_on_host(from.radii.type, from.radii.first + offset);
    grown_radius(radius, from.probe, "radii", found.bad_radius);  // throws, but for huge ones
  }
  data.valid_frames = data.frames;
  if (found.bad_row != ~0ull) {
    const Sphere row = value_at<Sphere>(data.rows.data() + found.bad_row);
    data.valid_frames = found.bad_row / data.atoms;
    data.invalid = invalid_ball(row, data.valid_frames, found.bad_row % data.atoms);
  }
  data.balls = found.balls.box();
  data.centers = found.centers.box();
  data.least_radius = from_ordered(found.least_radius);
}

std::shared_ptr<const DeviceFrames::Data> made(int device, const FrameCoordinates& centers,
                                               const DeviceNumbers& radii,
                                               std::span<const double> host_radii, double probe) {
  check_size(centers);
  const DeviceScope scope(device);
  auto data = std::make_shared<DeviceFrames::Data>(device);
  data->frames = centers.frames;
  data->atoms = centers.atoms;
  data->stream.emplace();
  const DeviceArray<double> uploaded = upload(host_radii.data(), host_radii.size(), data->work());
  AtomSource from{centers, radii, probe};
  if (!host_radii.empty()) {
    from.radii = {reinterpret_cast<const std::byte*>(uploaded.data()), CoordinateType::float64,
                  sizeof(double)};
  }
  gather(*data, from);
  return data;
}

}  // namespace

DeviceFrames::Data::~Data() {
  const QuietDeviceScope scope(device);
  rows = {};
  stream.reset();
}

DeviceFrames::DeviceFrames(int device, const FrameCoordinates& centers, const DeviceNumbers& radii,
                           double probe)
    : data_(made(device, centers, radii, {}, probe)) {}

DeviceFrames::DeviceFrames(int device, const FrameCoordinates& centers,
                           std::span<const double> radii, double probe) {
  if (radii.size() != centers.atoms) {
    throw InvalidInput(std::to_string(radii.size()) + " radii for " +
                       std::to_string(centers.atoms) + " atoms; each atom needs one");
  }
  data_ = made(device, centers, {}, radii, probe);
}

DeviceFrames::DeviceFrames(const SphereSet& balls) {
  const DeviceScope scope;
  int device = 0;
  check_cuda(cudaGetDevice(&device), "device");
  const Stream stream;
  const DeviceArray<Sphere> rows = upload(balls.spheres().data(), balls.size(), stream.get());
  stream.wait();
  const auto* const first = reinterpret_cast<const std::byte*>(rows.data());
  constexpr auto kRow = static_cast<std::ptrdiff_t>(sizeof(Sphere));
  static_assert(sizeof(Sphere) == 4 * sizeof(double));
  data_ = made(device,
               {.first = first,
                .frames = 1,
                .atoms = balls.size(),
                .frame_stride = 0,
                .atom_stride = kRow,
                .axis_stride = sizeof(double)},
               {first + offsetof(Sphere, radius), CoordinateType::float64, kRow}, {}, 0);
}

std::size_t DeviceFrames::atoms() const { return data_->atoms; }
std::size_t DeviceFrames::valid_frames() const { return data_->valid_frames; }
const std::optional<InvalidFrame>& DeviceFrames::invalid() const { return data_->invalid; }
const Box& DeviceFrames::balls() const { return data_->balls; }
const Box& DeviceFrames::centers() const { return data_->centers; }
double DeviceFrames::least_radius() const { return data_->least_radius; }

int device_of(const void* address, const char* name) {
  if (usable_devices().empty()) {
    throw BackendUnavailable(
        std::string(name) +
        ": is on a CUDA device, but the CUDA backend is not there: " + find_cuda_devices().reason);
  }
  cudaPointerAttributes found{};
  check_cuda(cudaPointerGetAttributes(&found, address), "address");
  if (found.type != cudaMemoryTypeDevice && found.type != cudaMemoryTypeManaged) {
    throw InvalidInput(std::string(name) + ": does not lie in the memory of a CUDA device");
  }
  return found.device;
}

void copy_to_host(void* to, const void* from, std::size_t bytes, int device) {
  const DeviceScope scope(device);
  const Stream stream;
  download_parts({{to, from, bytes}}, stream);
}

void wait_for_stream(int device, std::uintptr_t stream) {
  const DeviceScope scope(device);
  check_cuda(cudaStreamSynchronize(reinterpret_cast<cudaStream_t>(stream)),
             "waiting for the device");
}

}  // namespace vdwmesh
