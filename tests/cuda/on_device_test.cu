// Atoms that lie in device memory, and meshes and measures that stay there, against the CPU and
// against the same work with everything on the host: bit by bit.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "cuda/backend.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/on_device.hpp"
#include "cuda/parity.hpp"
#include "cuda/spheres/device_frames.cuh"
#include "extract/field_list.hpp"
#include "support/requirements.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class OnDevice : public Parity {};

// A copy of values in memory of the current device, from cudaMalloc() as other libraries take it.
template <class T>
class Copy {
 public:
  explicit Copy(const std::vector<T>& values) {
    void* memory = nullptr;
    EXPECT_EQ(cudaMalloc(&memory, values.size() * sizeof(T)), cudaSuccess);
    data_ = static_cast<T*>(memory);
    EXPECT_EQ(cudaMemcpy(data_, values.data(), values.size() * sizeof(T), cudaMemcpyHostToDevice),
              cudaSuccess);
  }
  ~Copy() { cudaFree(data_); }
  Copy(const Copy&) = delete;
  Copy& operator=(const Copy&) = delete;

  T* data() const { return data_; }
  const std::byte* bytes() const { return reinterpret_cast<const std::byte*>(data_); }

 private:
  T* data_ = nullptr;
};

int current_device() {
  int device = 0;
  EXPECT_EQ(cudaGetDevice(&device), cudaSuccess);
  return device;
}

// The centres of rows x, y, z, r on the device.
FrameCoordinates centers_of(const Copy<Sphere>& rows, std::size_t frames, std::size_t atoms) {
  return {.first = rows.bytes(),
          .frames = frames,
          .atoms = atoms,
          .frame_stride = static_cast<std::ptrdiff_t>(atoms * sizeof(Sphere)),
          .atom_stride = sizeof(Sphere),
          .axis_stride = sizeof(double)};
}

// Rows x, y, z, r on the device: coordinates and radii are columns of them.
struct Rows {
  explicit Rows(const SphereSet& spheres)
      : atoms(spheres.size()),
        memory(std::vector<Sphere>(spheres.spheres().begin(), spheres.spheres().end())) {}

  FrameCoordinates centers(std::size_t frames = 1) const {
    return centers_of(memory, frames, atoms / frames);
  }
  DeviceNumbers radii() const {
    return {memory.bytes() + 3 * sizeof(double), CoordinateType::float64, sizeof(Sphere)};
  }
  DeviceFrames frames(std::size_t count = 1) const {
    return DeviceFrames(current_device(), centers(count), radii(), 0);
  }

  std::size_t atoms;
  Copy<Sphere> memory;
};

std::vector<std::pair<std::string, SphereSet>> sets() {
  std::vector<Sphere> plane;  // equal x, so that y, z, radius and id decide the order
  for (int i = 0; i < 40; ++i)
    plane.push_back({{-0.0, 1.0 * (i % 5), 0.5 * (i % 3)}, 1 + 0.1 * (i % 2)});
  return {{"one ball", SphereSet({{{0.1, 0.2, 0.3}, 1.7}})},
          {"coincident", SphereSet({{{0, 0, 0}, 1.7}, {{0, 0, 0}, 1.7}, {{0, 0, 0}, 1.2}})},
          {"zeros of both signs", SphereSet({{{0, -0.0, 0}, 1.7}, {{-0.0, 0, 3}, 1.7}})},
          {"plane", SphereSet(plane)},
          {"octaves",
           SphereSet({{{0, 0, 0}, 0.5}, {{1, 0, 0}, 1}, {{2, 0, 0}, 2}, {{5, 0, 0}, 1.999}})},
          {"giant among small", crowd(300, 12, 0.1, 2.0, 5)},
          {"crowd", crowd(20000, 40, 0.8, 2.0, 6)},
          {"far apart", SphereSet({{{0, 0, 0}, 1.7}, {{4000, 0, 100}, 1.5}})}};
}

template <class T>
std::vector<T> fetched(const T* device, std::size_t size) {
  std::vector<T> host(size);
  EXPECT_EQ(cudaMemcpy(host.data(), device, size * sizeof(T), cudaMemcpyDeviceToHost), cudaSuccess);
  return host;
}

template <class T>
void expect_same_array(const T* device, const T* host, std::size_t size, const std::string& what) {
  const std::vector<T> copy = fetched(device, size);
  EXPECT_EQ(std::memcmp(copy.data(), host, size * sizeof(T)), 0) << what;
}

void expect_same_list(const CellListView& device, const CellListView& host,
                      const std::string& what) {
  ASSERT_EQ(device.size, host.size) << what;
  ASSERT_EQ(device.level_count, host.level_count) << what;
  expect_same_array(device.id.data(), host.id.data(), host.size, what + ": ids");
  expect_same_array(device.rank.data(), host.rank.data(), host.size, what + ": ranks");
  expect_same_array(device.spheres.data(), host.spheres.data(), host.size, what + ": spheres");
  for (int l = 0; l < host.level_count; ++l) {
    const CellListView::Level& level = host.levels[l];
    EXPECT_TRUE(static_cast<const CellLevel&>(device.levels[l]) == level) << what;
    const std::size_t cells = std::size_t(level.cells[0]) * level.cells[1] * level.cells[2];
    expect_same_array(device.levels[l].cell_start, level.cell_start, cells + 1, what + ": cells");
  }
}

TEST_F(OnDevice, CellListsAreThoseOfTheHost) {
  for (const auto& [name, spheres] : sets()) {
    const Rows rows(spheres);
    const DeviceFrames frames = rows.frames();
    for (const FieldKind kind : kFields) {
      const ExtractOptions options = options_of(kind, 0.5);
      const FieldModel model = make_field_model(options.field, make_grid(spheres, options.grid));
      const DeviceCellList built = build_cell_list(frames.data(), model);
      frames.data().work().wait();
      const CellList list = make_field_list(spheres, model);
      expect_same_list(built.view(), list.view(), name + " " + name_of(kind));
    }
  }
}

void expect_same_mesh(const CudaMesh& mesh, const SphereSet& spheres, const ExtractOptions& extract,
                      const RefineOptions& refine, const std::string& what) {
  IndexedMesh host = make_pipeline(Backend::cpu)->run(spheres, extract, refine).mesh;
  host.opposite = {};
  host.vertex_spheres.others = {};  // only the first sphere is handed out
  IndexedMesh device = mesh.download();
  device.vertex_spheres.others = {};
  expect_same(host, device, what);
}

TEST_F(OnDevice, MeshesAreThoseOfThePipeline) {
  for (const auto& [name, spheres] : sets()) {
    const Rows rows(spheres);
    for (const FieldKind kind : kFields) {
      ExtractOptions extract = options_of(kind, 0.6);
      extract.connectivity = Connectivity::triangles;
      for (const int subdivisions : {0, 1}) {
        if (subdivisions > 0 && spheres.size() > 1000) continue;
        RefineOptions refine;
        refine.subdivisions = subdivisions;
        refine.field = extract.field;
        refine.projection = kind == FieldKind::vdw ? Projection::vdw : Projection::field;
        if (subdivisions == 0) refine.projection = Projection::none;
        const CudaMesh mesh = mesh_on_device(rows.frames(), extract, refine);
        EXPECT_EQ(mesh.arrays().device, current_device());
        expect_same_mesh(mesh, spheres, extract, refine,
                         name + " " + name_of(kind) + " " + std::to_string(subdivisions));
      }
    }
  }
}

// The second frame lies elsewhere; the grid of the first must not reach to it.
TEST_F(OnDevice, TheMeshIsThatOfTheFirstFrame) {
  const std::vector<Sphere> first = {{{0, 0, 0}, 1.7}, {{2, 0.5, 0}, 1.5}};
  std::vector<Sphere> both = first;
  for (const Sphere& s : first) both.push_back({s.center + Vec3d{-7.3, 20, 5}, s.radius});
  const Rows rows((SphereSet(both)));
  const ExtractOptions extract = options_of(FieldKind::vdw, 0.6);
  const RefineOptions refine{.projection = Projection::none};
  expect_same_mesh(mesh_on_device(rows.frames(2), extract, refine), SphereSet(first), extract,
                   refine, "two frames");
}

std::string refusal(const auto& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

// The crease-exact mesh of the host, refined there.
ExactMesh exact_on_host(const SphereSet& spheres, const ExactMeshOptions& exact,
                        const RefineOptions& refine, std::vector<ProjectionStats>& levels) {
  ExactMesh made = make_exact_mesher(Backend::cpu)->mesh(spheres, exact);
  if (refine.subdivisions > 0) {
    RefineResult refined =
        make_refiner(Backend::cpu)->refine(spheres, std::move(made.mesh), refine);
    made.mesh = std::move(refined.mesh);
    levels = std::move(refined.levels);
  }
  made.mesh.opposite = {};
  if (refine.normals == Normals::none) made.mesh.normals = {};
  return made;
}

void expect_same_exact_mesh(const SphereSet& spheres, const ExactMeshOptions& exact,
                            const RefineOptions& refine, const std::string& what) {
  std::vector<ProjectionStats> levels;
  const ExactMesh host = exact_on_host(spheres, exact, refine, levels);
  const CudaExactMesh there = exact_mesh_on_device(DeviceFrames(spheres), exact, refine);
  EXPECT_EQ(there.mesh.arrays().triangles, host.mesh.triangle_count()) << what;
  EXPECT_EQ(there.mesh.arrays().vertices, host.mesh.vertex_count()) << what;
  EXPECT_NE(there.mesh.arrays().triangle_atoms, nullptr) << what;
  expect_same(host.mesh, there.mesh.download(), what);
  EXPECT_EQ(there.stats.split, host.stats.split) << what;
  EXPECT_EQ(there.stats.contacts, host.stats.contacts) << what;
  const std::uint64_t reduced = host.stats.points + host.stats.contacts + host.stats.joins;
  EXPECT_EQ(there.fallback.empty(), reduced == 0 && exact.min_angle == 0) << what;
  ASSERT_EQ(there.levels.size(), levels.size()) << what;
  for (std::size_t l = 0; l < levels.size(); ++l) {
    EXPECT_EQ(there.levels[l].projected, levels[l].projected) << what << ", level " << l;
    EXPECT_EQ(there.levels[l].residual_max, levels[l].residual_max) << what << ", level " << l;
  }
}

TEST_F(OnDevice, ExactMeshesAreThoseOfTheHost) {
  std::vector<Sphere> touching;
  for (int i = 0; i < 40; ++i) touching.push_back({{2.0 * (i % 5), 2.0 * (i / 5), 0}, 1});
  const std::vector<std::pair<std::string, SphereSet>> all{
      {"one ball", SphereSet({{{0.1, 0.2, 0.3}, 1.7}})},
      {"touching", SphereSet(touching)},  // contacts, so that the host makes the mesh
      {"coincident", SphereSet({{{0, 0, 0}, 1.7}, {{0, 0, 0}, 1.7}, {{0, 0, 0.4}, 1.2}})},
      {"crowd", crowd(3000, 20, 0.8, 2.0, 6)},
      {"large and small", crowd(300, 12, 0.2, 5.0, 7)}};
  for (const auto& [name, spheres] : all) {
    for (const DeviceWork work : {DeviceWork::all, DeviceWork::balanced}) {
      for (const int subdivisions : {0, 1, 2}) {
        const ExactMeshOptions exact{.edge_length = 0.5, .device_work = work};
        expect_same_exact_mesh(spheres, exact, {.subdivisions = subdivisions},
                               name + " " + std::to_string(subdivisions));
      }
    }
  }
  const SphereSet& spheres = all[3].second;
  const ExactMeshOptions exact{.edge_length = 0.6, .device_work = DeviceWork::all};
  expect_same_exact_mesh(spheres, exact, {.normals = Normals::none}, "no normals");
  expect_same_exact_mesh(spheres, exact, {.subdivisions = 1, .normals = Normals::none},
                         "no normals, refined");
  expect_same_exact_mesh(spheres, exact, {.subdivisions = 1, .projection = Projection::none},
                         "not projected");
  const std::vector<double> lengths(spheres.size(), 0.7);
  expect_same_exact_mesh(spheres, {.edge_lengths = lengths, .min_angle = 15}, {.subdivisions = 1},
                         "bounded angles");
}

// A mesh that does not fit the device beside the patches that it keeps is refused.
TEST_F(OnDevice, ExactMeshesThatDoNotFit) {
  const SphereSet spheres = crowd(3000, 20, 0.8, 2.0, 6);
  ExactMeshOptions exact{.edge_length = 0.5, .device_work = DeviceWork::all};
  const CudaExactMesh all = exact_mesh_on_device(DeviceFrames(spheres), exact, {});
  const IndexedMesh mesh = all.mesh.download();
  exact.device_memory = 3 * indexed_mesh_bytes(mesh);
  const CudaExactMesh less = exact_mesh_on_device(DeviceFrames(spheres), exact, {});
  EXPECT_EQ(hash(less.mesh.download()), hash(mesh));
  exact.device_memory = indexed_mesh_bytes(mesh);
  EXPECT_THROW(exact_mesh_on_device(DeviceFrames(spheres), exact, {}), DeviceMemoryExceeded);
  exact = {.edge_length = 0.5, .memory_limit = 1 << 20};
  EXPECT_THROW(exact_mesh_on_device(DeviceFrames(spheres), exact, {}), LimitExceeded);
  RefineOptions refine{.subdivisions = 1};
  refine.device_memory = indexed_mesh_bytes(mesh);
  EXPECT_THROW(exact_mesh_on_device(DeviceFrames(spheres), {.edge_length = 0.5}, refine),
               DeviceMemoryExceeded);
}

TEST_F(OnDevice, ExactMeshesOfWrongInput) {
  const DeviceFrames balls(crowd(100, 6, 1, 2, 3));
  EXPECT_THROW(exact_mesh_on_device(balls, {.edge_length = -1}, {}), InvalidInput);
  EXPECT_THROW(exact_mesh_on_device(balls, {}, {.subdivisions = -1}), InvalidInput);
  EXPECT_THROW(exact_mesh_on_device(balls, {}, {.subdivisions = 40}), InvalidInput);
  const RefineOptions to_field{.subdivisions = 1, .projection = Projection::field};
  EXPECT_THROW(exact_mesh_on_device(balls, {}, to_field), InvalidInput);
  EXPECT_THROW(DeviceFrames(SphereSet{}), InvalidInput);
  std::vector<Sphere> wrong(3, Sphere{{0, 0, 0}, 1});
  wrong[1].center.y = kNan;
  const Copy<Sphere> memory(wrong);
  const FrameCoordinates centers = centers_of(memory, 1, 3);
  const std::vector<double> radii(3, 1.5);
  EXPECT_THROW(exact_mesh_on_device(DeviceFrames(current_device(), centers, radii, 0), {}, {}),
               InvalidFrame);
}

// A mesh that is not closed is refused with the words of the CPU, which name an edge.
TEST_F(OnDevice, OpenMeshesAreRefusedAlike) {
  const SphereSet spheres = crowd(100, 6, 1, 2, 3);
  IndexedMesh open = mesh_union(spheres, {.edge_length = 0.8}).mesh;
  std::swap(open.triangles[700], open.triangles.back());
  open.triangles.resize(open.triangle_count() - 1);
  open.triangle_spheres = Buffer<SphereId>();
  std::vector<std::string> words;
  for (const Backend backend : {Backend::cpu, Backend::cuda}) {
    words.push_back(refusal(
        [&] { make_refiner(backend)->refine(spheres, open, RefineOptions{.subdivisions = 1}); }));
  }
  EXPECT_NE(words[0].find("is not run back by exactly one other triangle"), std::string::npos);
  EXPECT_EQ(words[0], words[1]);
}

// float32 coordinates in nm, atoms in reverse, axes far apart, every second number skipped; radii
// as float32 on the device or as doubles on the host.
TEST_F(OnDevice, ReadsCoordinatesOfAnyLayout) {
  const SphereSet given = crowd(50, 5, 1, 2, 21);
  const std::size_t n = given.size();
  std::vector<float> numbers(6 * n), sizes(n);
  std::vector<Sphere> expected;
  std::vector<double> grown;
  for (std::size_t i = 0; i < n; ++i) {
    Sphere s{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto x = static_cast<float>(given[i].center[axis] / 10);
      numbers[2 * (static_cast<std::size_t>(axis) * n + (n - 1 - i))] = x;
      s.center[axis] = 10 * static_cast<double>(x);
    }
    sizes[i] = static_cast<float>(given[i].radius);
    grown.push_back(static_cast<double>(sizes[i]));
    s.radius = grown.back() + 1.4;
    expected.push_back(s);
  }
  const Copy<float> places(numbers), radii(sizes);
  constexpr auto item = static_cast<std::ptrdiff_t>(sizeof(float));
  const auto count = static_cast<std::ptrdiff_t>(n);
  const FrameCoordinates centers{.first = places.bytes() + 2 * item * (count - 1),
                                 .type = CoordinateType::float32,
                                 .frames = 1,
                                 .atoms = n,
                                 .frame_stride = 0,
                                 .atom_stride = -2 * item,
                                 .axis_stride = 2 * item * count,
                                 .unit = 10};
  const DeviceNumbers column{radii.bytes(), CoordinateType::float32, item};
  for (const DeviceFrames& frames : {DeviceFrames(current_device(), centers, column, 1.4),
                                     DeviceFrames(current_device(), centers, grown, 1.4)}) {
    expect_same_array(frames.data().rows.data(), expected.data(), n, "rows");
    const SphereSet spheres(expected);
    const Box balls = bounding_box(spheres);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(frames.balls().lower[axis], balls.lower[axis]);
      EXPECT_EQ(frames.balls().upper[axis], balls.upper[axis]);
    }
  }
}

TEST_F(OnDevice, CopiesBallsOfTheHost) {
  const SphereSet spheres = crowd(50, 5, 1, 2, 21);
  const DeviceFrames frames(spheres);
  expect_same_array(frames.data().rows.data(), &spheres[0], 50, "rows");
  EXPECT_EQ(frames.valid_frames(), 1u);
}

TEST_F(OnDevice, RefusesWhatIsNoAtom) {
  std::vector<Sphere> balls(20, Sphere{{0, 0, 0}, 1});
  balls[17].center.y = kNan;
  const Copy<Sphere> memory(balls);
  const FrameCoordinates centers = centers_of(memory, 2, 10);
  std::vector<double> radii(10, 1.5);
  const DeviceFrames frames(current_device(), centers, radii, 0);
  EXPECT_EQ(frames.valid_frames(), 1u);
  ASSERT_TRUE(frames.invalid());
  EXPECT_EQ(frames.invalid()->frame(), 1u);
  EXPECT_EQ(frames.invalid()->atom(), 7u);
  for (const double wrong : {-1.0, kNan, std::numeric_limits<double>::infinity()}) {
    radii[4] = wrong;
    const Copy<double> there(radii);
    const DeviceNumbers column{there.bytes(), CoordinateType::float64, sizeof(double)};
    const auto on_host = [&] { DeviceFrames(current_device(), centers, radii, 0); };
    const auto on_device = [&] { DeviceFrames(current_device(), centers, column, 0); };
    EXPECT_EQ(refusal(on_host).find("radii[4]: "), 0u) << refusal(on_host);
    EXPECT_EQ(refusal(on_host), refusal(on_device));
  }
  radii[4] = 1e300;  // finite, but no SphereSet takes it
  EXPECT_NE(DeviceFrames(current_device(), centers, radii, 0).invalid(), std::nullopt);
  EXPECT_EQ(refusal([&] { device_of(balls.data(), "coords"); }).find("coords: does not lie"), 0u);
  EXPECT_EQ(device_of(memory.data(), "coords"), current_device());
}

// A lattice, most of whose balls are left to the host, in two frames.
TEST_F(OnDevice, MeasuresAreThoseOfTheHost) {
  std::vector<Sphere> balls;
  for (int i = 0; i < 128; ++i) {
    const double shift = i < 64 ? 0 : 0.013 * (i % 7);
    balls.push_back({{1.0 * (i % 4) + shift, 1.0 * (i / 4 % 4), 1.0 * (i / 16 % 4)}, 0.75});
  }
  const Rows rows{SphereSet(balls)};
  const std::vector<double> radii(64, 0.75);
  FrameCoordinates on_host = rows.centers(2);
  on_host.first = reinterpret_cast<const std::byte*>(balls.data());
  const auto measurer = make_union_measurer(Backend::cuda);
  const std::vector<SphereId> some{3, 40, 41};
  for (const bool all : {true, false}) {
    FrameOptions options;
    options.per_sphere = PerSphere::keep;
    options.measurer = measurer.get();
    if (!all) options.measures.measured = some;
    std::vector<ExactUnion> expected, found;
    measure_frames(expected, radii, on_host, options);
    const CudaMeasures there = measure_on_device(found, rows.frames(2), options);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_GT(found[0].fallback_spheres, 0u);
    const std::vector<SphereMeasures> kept = fetched(there.rows(), 128);
    for (std::size_t t = 0; t < 2; ++t) {
      EXPECT_EQ(found[t].area, expected[t].area);
      EXPECT_EQ(found[t].volume, expected[t].volume);
      EXPECT_EQ(found[t].fallback_spheres, expected[t].fallback_spheres);
      for (std::size_t i = 0; i < 64; ++i) {
        const SphereMeasures& a = expected[t].per_sphere[i];
        const SphereMeasures& b = kept[64 * t + i];
        EXPECT_EQ(std::isnan(a.area), std::isnan(b.area));
        if (std::isnan(a.area)) continue;
        EXPECT_EQ(a.area, b.area) << "frame " << t << ", atom " << i;
        EXPECT_EQ(a.volume, b.volume) << "frame " << t << ", atom " << i;
      }
    }
  }
}

// The same lattice: derivatives that stay on the device are those of copies on the host.
TEST_F(OnDevice, GradientsAreThoseOfTheHost) {
  std::vector<Sphere> balls;
  std::vector<double> weights;
  for (int i = 0; i < 128; ++i) {
    const double shift = i < 64 ? 0 : 0.013 * (i % 7);
    balls.push_back({{1.0 * (i % 4) + shift, 1.0 * (i / 4 % 4), 1.0 * (i / 16 % 4)}, 0.75});
    weights.push_back(0.25 * (i % 64 % 5) - 0.5);  // alike in both frames
  }
  balls[64].center.x = 9;  // touches its neighbour in y, and no others
  balls[65].center = {9, 1.5, 0};
  const Rows rows{SphereSet(balls)};
  const Stream stream;
  const DeviceArray<double> there = upload(weights.data(), 64, stream.get());
  stream.wait();
  const std::vector<std::size_t> offsets{0, 64, 128};
  BatchGradients expected;
  make_union_measurer(Backend::cuda)
      ->gradients_into(expected, {.spheres = balls.data(), .size = 128, .offsets = offsets},
                       {.area = weights.data()});
  std::vector<ExactUnion> found;
  std::vector<std::uint64_t> kinks;
  const CudaMeasures left =
      gradients_on_device(found, kinks, rows.frames(2), {.area = there.data()}, {});
  EXPECT_GT(found.at(0).fallback_spheres, 0u);
  EXPECT_EQ(found.at(1).area, expected.measures.totals.at(1).area);
  EXPECT_EQ(kinks, expected.kink_spheres);
  EXPECT_EQ(kinks, (std::vector<std::uint64_t>{0, 2}));
  expect_same_array(left.gradients(), expected.per_sphere.data(), 128, "gradients");
  expect_same_array(left.rows(), expected.measures.per_sphere.data(), 128, "measures");
}

// Sets of 1, 63 and 64 balls of one array, with and without derivatives.
TEST_F(OnDevice, SetsAreThoseOfTheHost) {
  const SphereSet spheres = crowd(128, 6, 1, 2, 11);
  const Rows rows(spheres);
  std::vector<double> weights;
  for (int i = 0; i < 128; ++i) weights.push_back(0.5 - 0.01 * i);
  const Stream stream;
  const DeviceArray<double> there = upload(weights.data(), weights.size(), stream.get());
  stream.wait();
  const std::vector<std::size_t> offsets{0, 1, 64, 128};
  BatchGradients expected;
  BatchMeasures found, plain;
  std::vector<std::uint64_t> kinks;
  make_union_measurer(Backend::cuda)
      ->gradients_into(expected,
                       {.spheres = spheres.spheres().data(), .size = 128, .offsets = offsets},
                       {.volume = weights.data()});
  const BatchWeights device_weights{.volume = there.data()};
  const CudaMeasures left = sets_on_device(found, kinks, rows.frames(), offsets, &device_weights);
  const CudaMeasures measured = sets_on_device(plain, kinks, rows.frames(), offsets, nullptr);
  ASSERT_EQ(found.totals.size(), 3u);
  EXPECT_EQ(kinks, (std::vector<std::uint64_t>{0, 0, 0}));
  for (std::size_t set = 0; set < 3; ++set) {
    EXPECT_EQ(found.totals[set].area, expected.measures.totals[set].area) << set;
    EXPECT_EQ(plain.totals[set].volume, expected.measures.totals[set].volume) << set;
  }
  expect_same_array(left.gradients(), expected.per_sphere.data(), 128, "gradients");
  expect_same_array(measured.rows(), expected.measures.per_sphere.data(), 128, "measures");
  EXPECT_EQ(measured.gradients(), nullptr);
  EXPECT_THROW(
      sets_on_device(plain, kinks, rows.frames(), std::vector<std::size_t>{0, 5, 5, 128}, nullptr),
      InvalidInput);
}

// A mesh that is used after its atoms and later meshes are gone.
TEST_F(OnDevice, ResultsOutliveWhatMadeThem) {
  const SphereSet spheres = crowd(200, 6, 1, 2, 3), others = crowd(200, 6, 1, 2, 4);
  ExtractOptions extract;
  const RefineOptions refine{.subdivisions = 0, .projection = Projection::none};
  const CudaMesh kept = mesh_on_device(Rows(spheres).frames(), extract, refine);
  for (int i = 0; i < 5; ++i) mesh_on_device(Rows(others).frames(), extract, refine);
  release_device_memory();
  mesh_on_device(Rows(others).frames(), extract, refine);
  expect_same_mesh(kept, spheres, extract, refine, "kept");
}

// Waits some milliseconds, then writes the spheres.
__global__ void write_late(const Sphere* from, Sphere* to, int count) {
  const long long start = clock64();
  while (clock64() - start < 20'000'000) {
  }
  for (int i = 0; i < count; ++i) to[i] = from[i];
}

TEST_F(OnDevice, WaitsForTheStreamThatMakesTheAtoms) {
  const SphereSet spheres = crowd(100, 6, 1, 2, 3);
  const Rows source(spheres);
  const Rows late(SphereSet(std::vector<Sphere>(100, Sphere{{0, 0, 0}, 1})));
  const Stream stream;
  write_late<<<1, 1, 0, stream.get()>>>(source.memory.data(), late.memory.data(), 100);
  wait_for_stream(current_device(), reinterpret_cast<std::uintptr_t>(stream.get()));
  expect_same_array(late.frames().data().rows.data(), &spheres[0], 100, "rows");
}

}  // namespace
}  // namespace vdwmesh::testing
