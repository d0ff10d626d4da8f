// Vertex buffers filled by CUDA against those the host fills, byte by byte as OpenGL has them.
// Skips where OpenGL does not draw on a CUDA device; VDWMESH_REQUIRE_CUDA_GL=1 makes that a
// failure.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "cuda/backend.hpp"
#include "cuda/cuda_source.hpp"
#include "cuda/refused_memory.hpp"
#include "render/opengl/egl_context.hpp"
#include "render/opengl/surface_buffers.hpp"
#include "render/renderer.hpp"
#include "support/requirements.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

constexpr Vec3d kOrigin{311.7, -12.9, 0.3};
constexpr std::uint64_t kPerSlice = std::uint64_t{1} << 20;  // vertices that are uploaded at a time

std::mt19937 seeded() { return std::mt19937(20); }

// Triangles of neighbours in a list of random points about kOrigin.
IndexedMesh scattered(std::size_t points) {
  std::mt19937 random = seeded();
  std::uniform_real_distribution<double> about(-40, 40);
  IndexedMesh mesh;
  mesh.positions.resize(points);
  mesh.normals.resize(points);
  for (std::size_t v = 0; v < points; ++v) {
    const Vec3d p{about(random), about(random), about(random)};
    mesh.positions[v] = p + kOrigin;
    mesh.normals[v] = cast<float>((1 / norm(p)) * p);
  }
  for (std::uint32_t v = 0; v + 2 < points; ++v) mesh.triangles.push_back({v, v + 1, v + 2});
  return mesh;
}

std::vector<float> random_values(std::size_t count, float lower, float upper) {
  std::mt19937 random = seeded();
  std::uniform_real_distribution<float> value(lower, upper);
  std::vector<float> values(count);
  std::ranges::generate(values, [&] { return value(random); });
  values[count / 2] = std::numeric_limits<float>::quiet_NaN();
  return values;
}

// Also halves of a byte and what lies beyond its ends.
VertexColors random_colors(std::size_t count) {
  std::mt19937 random = seeded();
  std::uniform_int_distribution<int> halves(-20, 530);
  const auto channel = [&] { return static_cast<float>(halves(random)) / 510; };
  VertexColors colors;
  for (std::size_t v = 0; v < count; ++v)
    colors.colors.push_back({channel(), channel(), channel()});
  return colors;
}

// One of each kind.
std::vector<Paint> paints_for(const IndexedMesh& mesh) {
  const ColorScale scale{ColorMap::viridis, 0, 1, "", {}};
  return {Rgb{0.1f, 0.5f, 0.9f}, random_colors(mesh.vertex_count()),
          VertexValues{random_values(mesh.vertex_count(), -1, 2), scale},
          TriangleValues{random_values(mesh.triangle_count(), -1, 2), scale}};
}

std::vector<char> read_buffer(unsigned name, std::uint64_t bytes) {
  std::vector<char> content(bytes);
  glBindBuffer(GL_COPY_READ_BUFFER, name);
  glGetBufferSubData(GL_COPY_READ_BUFFER, 0, static_cast<GLsizeiptr>(bytes), content.data());
  check_gl("reading a buffer");
  return content;
}

struct Content {
  std::vector<char> vertices, triangles, values;
};

Content filled_by(const SurfaceSource& source) {
  const SurfaceBuffers buffers(source, kOrigin);
  Content content;
  content.vertices =
      read_buffer(buffers.vertex_buffer(), source.vertex_count() * sizeof(SurfaceVertex));
  content.triangles =
      read_buffer(buffers.index_buffer(), source.triangle_count() * sizeof(Triangle));
  if (source.paint() == PaintKind::triangle_value) {
    content.values =
        read_buffer(buffers.triangle_value_buffer(), source.triangle_count() * sizeof(float));
  }
  return content;
}

void expect_same(const Content& a, const Content& b, const std::string& what) {
  const auto first_difference = [](const std::vector<char>& x, const std::vector<char>& y) {
    return std::ranges::mismatch(x, y).in1 - x.begin();
  };
  EXPECT_TRUE(a.vertices == b.vertices)
      << what << ", vertices from byte " << first_difference(a.vertices, b.vertices);
  EXPECT_TRUE(a.triangles == b.triangles)
      << what << ", triangles from byte " << first_difference(a.triangles, b.triangles);
  EXPECT_TRUE(a.values == b.values)
      << what << ", values from byte " << first_difference(a.values, b.values);
}

void miss(const std::string& what, const char* required_by) { VDWMESH_MISSING(required_by, what); }

class HostFill : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      context_ = std::make_unique<EglContext>();
    } catch (const BackendUnavailable& error) {
      miss(error.what(), "VDWMESH_REQUIRE_EGL");
    }
  }
  void expect_picture_of_the_host(std::optional<int> gl_device) const {
    const IndexedMesh mesh = testing::icosphere(5);
    RenderOptions options;
    options.width = 320;  // with room for a colour bar
    options.height = 240;
    const Renderer renderer;
    for (const Paint& paint : paints_for(mesh)) {
      const MeshSource host(mesh, paint);
      const CudaSource source(host, gl_device);
      EXPECT_TRUE(renderer.draw(host, options).pixels == renderer.draw(source, options).pixels);
      EXPECT_EQ(source.obstacle().empty(), gl_device.has_value()) << source.obstacle();
    }
  }
  std::unique_ptr<EglContext> context_;
};

TEST_F(HostFill, DrawsTheSamePicture) { expect_picture_of_the_host({}); }

// The bytes of the host, and the reason.
TEST_F(HostFill, StandsInWhereOpenGlIsNotOnTheCudaDevice) {
  const EglContext::Use use(*context_);
  const IndexedMesh mesh = scattered(33);
  constexpr int kNoSuchDevice = 1 << 20;
  for (const std::optional<int> device :
       {std::optional<int>(), std::optional<int>(kNoSuchDevice)}) {
    for (const Paint& paint : paints_for(mesh)) {
      const MeshSource host(mesh, paint);
      const CudaSource source(host, device);
      expect_same(filled_by(host), filled_by(source), "fallback");
      EXPECT_NE(source.obstacle(), "");
    }
  }
}

class CudaFill : public HostFill {
 protected:
  void SetUp() override {
    HostFill::SetUp();
    if (!context_) {
      if (!HasFailure()) miss("no OpenGL context", "VDWMESH_REQUIRE_CUDA_GL");
      return;
    }
    const DeviceList list = cuda_devices();
    if (list.devices.empty()) return miss(list.reason, "VDWMESH_REQUIRE_CUDA_GL");
    if (context_->cuda_device()) return;
    miss("OpenGL draws on " + context_->device() + ", which is not a CUDA device",
         "VDWMESH_REQUIRE_CUDA_GL");
  }

  void expect_bytes_of_the_host(const IndexedMesh& mesh) const {
    const EglContext::Use use(*context_);
    const std::vector<Paint> paints = paints_for(mesh);
    for (std::size_t i = 0; i < paints.size(); ++i) {
      const MeshSource host(mesh, paints[i]);
      const CudaSource source(host, context_->cuda_device());
      expect_same(filled_by(host), filled_by(source),
                  fmt::format("{} vertices, paint {}", mesh.vertex_count(), i));
      EXPECT_EQ(source.obstacle(), "");
    }
  }
};

TEST_F(CudaFill, WritesTheBytesOfTheHost) {
  for (const std::size_t points :
       {std::size_t{3}, std::size_t{31}, std::size_t{32}, std::size_t{33}, std::size_t{100'000}}) {
    expect_bytes_of_the_host(scattered(points));
  }
}

TEST_F(CudaFill, WritesTheBytesOfTheHostInSlices) {
  expect_bytes_of_the_host(scattered(2 * kPerSlice + 1));
}

// The host fills the buffers where the device has no memory for what is on its way into them.
TEST_F(CudaFill, LeavesToTheHostWhatTheDeviceHasNoMemoryFor) {
  const EglContext::Use use(*context_);
  const IndexedMesh mesh = scattered(33);
  const testing::RefusedMemory refused;
  for (const Paint& paint : paints_for(mesh)) {
    const MeshSource host(mesh, paint);
    const CudaSource source(host, context_->cuda_device());
    expect_same(filled_by(host), filled_by(source), "no device memory");
    EXPECT_NE(source.obstacle().find("device memory"), std::string::npos) << source.obstacle();
  }
}

TEST_F(CudaFill, DrawsThePictureOfTheHost) { expect_picture_of_the_host(context_->cuda_device()); }

}  // namespace
}  // namespace vdwmesh
