// Fills OpenGL's vertex and index buffers from CUDA. The driver maps the buffers into the address
// space of CUDA. Vertices are uploaded in slices, and a kernel converts them with the formula that
// the host uses (render/surface_vertex.hpp), so the bytes are the same. Triangle indices and the
// values of triangles are copied as they are.
#include <cuda_gl_interop.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "core/errors.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/memory/device_memory.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/pictures/gl_fill.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;
// Vertices of a slice. A vertex takes at most 52 bytes while it is uploaded (position 24, normal
// 12, colour 12, value 4), so a slice takes at most 52 MiB of device memory beside the buffers.
constexpr std::uint64_t kSlice = std::uint64_t{1} << 20;

// Writes vertex v of a slice, relative to `origin`. One thread per vertex.
__global__ void make_vertices(VertexArrays arrays, std::uint64_t count, Vec3d origin,
                              SurfaceVertex* vertices) {
  const std::uint64_t v = std::uint64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (v < count) vertices[v] = surface_vertex(arrays, v, origin);
}

// Maps OpenGL buffers of the thread's current context into device memory, until give_back() or the
// end of the object. OpenGL must not use the buffers during that time.
class SharedBuffers {
 public:
  // `names` are OpenGL names of at most three buffers; the name 0 is skipped. Throws CudaError if
  // the driver cannot share one of the buffers.
  SharedBuffers(std::span<const unsigned> names, cudaStream_t stream) : stream_(stream) {
    try {
      for (const unsigned name : names) share(name);
      check_cuda(cudaGraphicsMapResources(count_, resources_.data(), stream_),
                 "mapping OpenGL buffers");
      mapped_ = true;
    } catch (...) {
      release();
      throw;
    }
  }
  ~SharedBuffers() { release(); }
  SharedBuffers(const SharedBuffers&) = delete;
  SharedBuffers& operator=(const SharedBuffers&) = delete;

  // The device memory of a buffer. `which` counts the buffers that were not skipped, in order.
  template <class T>
  T* memory(std::size_t which) const {
    void* pointer = nullptr;
    std::size_t bytes = 0;
    check_cuda(cudaGraphicsResourceGetMappedPointer(&pointer, &bytes, resources_[which]),
               "memory of an OpenGL buffer");
    return static_cast<T*>(pointer);
  }

  // Gives the buffers back to OpenGL, which then sees everything written in the stream so far.
  // mapped_ is cleared first, so that the destructor does not try again after a failure.
  void give_back() {
    mapped_ = false;
    check_cuda(cudaGraphicsUnmapResources(count_, resources_.data(), stream_),
               "unmapping OpenGL buffers");
  }

 private:
  // Registers a buffer that CUDA will only write, and write in full.
  void share(unsigned name) {
    if (name == 0) return;
    check_cuda(cudaGraphicsGLRegisterBuffer(&resources_[static_cast<std::size_t>(count_)], name,
                                            cudaGraphicsRegisterFlagsWriteDiscard),
               "sharing an OpenGL buffer");
    ++count_;
  }
  // Undoes what the constructor has done so far; ignores errors.
  void release() {
    if (mapped_) cudaGraphicsUnmapResources(count_, resources_.data(), stream_);
    mapped_ = false;
    while (count_ > 0)
      cudaGraphicsUnregisterResource(resources_[static_cast<std::size_t>(--count_)]);
  }

  cudaStream_t stream_;
  std::array<cudaGraphicsResource_t, 3> resources_{};
  int count_ = 0;
  bool mapped_ = false;
};

// Uploads array[first .. first + count); an absent array (null) stays absent.
template <class T>
DeviceArray<T> upload_slice(const T* array, std::uint64_t first, std::uint64_t count,
                            cudaStream_t stream) {
  return array ? upload(array + first, count, stream) : DeviceArray<T>();
}

// Uploads one slice of the vertices and launches the kernel that converts it. The device arrays are
// given back in stream order, that is, after the kernel, although their owners end before it runs.
void write_slice(const VertexArrays& host, std::uint64_t first, std::uint64_t count,
                 const Vec3d& origin, SurfaceVertex* vertices, cudaStream_t stream) {
  const auto positions = upload_slice(host.positions, first, count, stream);
  const auto normals = upload_slice(host.normals, first, count, stream);
  const auto colors = upload_slice(host.colors, first, count, stream);
  const auto values = upload_slice(host.values, first, count, stream);
  const VertexArrays device{positions.data(), normals.data(), colors.data(), values.data(),
                            host.color};
  launch("make_vertices", make_vertices, over(count, kThreads), stream, device, count, origin,
         vertices + first);
}

template <class T>
void copy_to_device(std::span<const T> from, T* to, cudaStream_t stream) {
  check_cuda(cudaMemcpyAsync(to, from.data(), from.size_bytes(), cudaMemcpyHostToDevice, stream),
             "upload");
}

// Fills all mapped buffers: vertices, indices, and triangle values if triangles are painted.
void write_buffers(const SurfaceArrays& arrays, const Vec3d& origin, const SharedBuffers& buffers,
                   cudaStream_t stream) {
  auto* vertices = buffers.memory<SurfaceVertex>(0);
  for (std::uint64_t first = 0; first < arrays.vertex_count; first += kSlice) {
    const std::uint64_t count = std::min(kSlice, arrays.vertex_count - first);
    write_slice(arrays.vertices, first, count, origin, vertices, stream);
  }
  copy_to_device(arrays.triangles, buffers.memory<Triangle>(1), stream);
  if (arrays.triangle_values.empty()) return;
  copy_to_device(arrays.triangle_values, buffers.memory<float>(2), stream);
}

// Why the current CUDA device cannot write OpenGL's buffers: OpenGL draws on another one. Empty if
// it is the same device.
std::string other_device(int gl_device) {
  int device = 0;
  check_cuda(cudaGetDevice(&device), "current device");
  if (device == gl_device) return {};
  return "OpenGL draws on CUDA device " + std::to_string(gl_device) + ", CUDA computes on device " +
         std::to_string(device);
}

}  // namespace

std::string fill_with_cuda(const SurfaceArrays& arrays, const SurfaceTarget& target,
                           const Vec3d& origin, int gl_device) {
  const unsigned names[] = {target.vertex_buffer(), target.index_buffer(),
                            target.triangle_value_buffer()};
  std::optional<DeviceScope> scope;
  std::optional<Stream> stream;
  std::optional<SharedBuffers> buffers;
  // A failure in this block only means that the buffers cannot be shared. Its message is returned
  // as the reason.
  try {
    scope.emplace();
    if (const std::string reason = other_device(gl_device); !reason.empty()) return reason;
    stream.emplace();
    buffers.emplace(names, stream->get());
  } catch (const BackendUnavailable& error) {
    return error.what();
  } catch (const CudaError& error) {
    return error.what();
  } catch (const DeviceMemoryExceeded& error) {
    return error.what();
  }
  try {
    write_buffers(arrays, origin, *buffers, stream->get());
  } catch (const DeviceMemoryExceeded& error) {
    return error.what();
  }
  buffers->give_back();
  stream->wait();
  return {};
}

}  // namespace vdwmesh
