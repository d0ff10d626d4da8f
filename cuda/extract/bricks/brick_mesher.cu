// The driver of marching cubes on a device. A BrickSource (brick_source.cuh) stands for the
// surface: it finds bricks, evaluates the field in them and writes their vertices. The rest is done
// here.
//
// Counting: the source finds the candidates and writes signs and counts of each. One
// prefix sum over the counts, moved by one brick, then gives every brick the numbers of its first
// vertex and triangle. The field of all candidates is kept for emission if it fits into memory. If
// it does not, it is evaluated for as many bricks at a time as fit, and evaluated again when they
// are emitted.
//
// Emission: for a run of bricks the source writes the vertices, and one kernel for all sources the
// triangles, each to the places that their numbers say. Nothing is appended, so the mesh does not
// depend on how it was cut into runs, nor on which device made which run. A run that is made on the
// device and brought to the host is called a slab.
#include "core/first_from.hpp"
#include "core/monitor.hpp"
#include "cuda/extract/bricks/brick_mesher.cuh"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/transfer.cuh"
#include "extract/brick_search.hpp"

namespace vdwmesh {
namespace {

struct AddSums {
  __host__ __device__ BrickSums operator()(const BrickSums& a, const BrickSums& b) const {
    return {a.vertices + b.vertices, a.triangles + b.triangles};
  }
};

// One block of kCountParts threads, each adding one part to the totals. `before` has the sums
// before bricks 1 .. n; those before brick 0 are written here.
__global__ void add_up(const CountPart* parts, BrickSums* before, std::uint64_t n,
                       BrickTotals* totals) {
  const CountPart& part = parts[threadIdx.x];
  if (threadIdx.x == 0) {
    before[0] = {0, 0};
    totals->sums = before[n];
  }
  if (part.clipped_cells != 0) atomicAdd(&totals->clipped_cells, part.clipped_cells);
  if (part.surface_bricks != 0) atomicAdd(&totals->surface_bricks, part.surface_bricks);
  atomicMax(&totals->most_atoms, part.most_atoms);
}

// Index of the first of the rising keys at or above `key`.
__device__ std::uint64_t first_at_or_above(std::uint64_t key, const std::uint64_t* keys,
                                           std::uint64_t size) {
  return first_from(std::uint64_t{0}, size, [&](std::uint64_t i) { return keys[i] < key; });
}

// The same for two keys: one thread each.
__global__ void find_keys(const std::uint64_t* keys, std::uint64_t size, KeyRange range,
                          BrickRange* found) {
  const std::uint64_t key = threadIdx.x == 0 ? range.begin : range.end;
  (threadIdx.x == 0 ? found->begin : found->end) = first_at_or_above(key, keys, size);
}

// By layer of bricks: `before`, the sums over the bricks before each brick of the list, at the
// first brick of the layer's field. Behind the last layer: the sums of all. A thread for each.
__global__ void find_meshes(FieldStack stack, const std::uint64_t* keys, std::uint64_t size,
                            const BrickSums* before, BrickSums* before_mesh) {
  const std::uint64_t layer = thread_index(), layers = static_cast<std::uint64_t>(stack.bricks[2]);
  if (layer > layers) return;
  if (layer == layers) {
    before_mesh[layer] = before[size];
    return;
  }
  const std::int32_t first = stack.fields[stack.field_of_layer[layer]].first_layer;
  before_mesh[layer] = before[first_at_or_above(brick_key({0, 0, first}), keys, size)];
}

// Adds to every sum, modulo 2^64: one thread for each.
__global__ void shift_sums(BrickSums* sums, std::uint64_t size, BrickSums shift) {
  const std::uint64_t i = thread_index();
  if (i >= size) return;
  sums[i] = {sums[i].vertices + shift.vertices, sums[i].triangles + shift.triangles};
}

// The copy of a slab's array on the device into `host`, from element `first` on.
template <class T, class U>
DownloadPart part_for(Buffer<T>& host, std::uint64_t first, const DeviceArray<U>& device) {
  return {host.data() + first, device.data(), device.bytes()};
}

}  // namespace

struct MesherTally {
  CountPart parts[kCountParts];       // of the bricks of the range
  CountPart halo_parts[kCountParts];  // of the bricks around it, which nobody asks for
  BrickTotals totals;                 // of the range
  DeviceEmissionTally emission;
};

DeviceBrickMesher::DeviceBrickMesher(const BrickSource& source, const ExtractOptions& options,
                                     std::size_t sharers)
    : source_(source),
      options_(options),
      sharers_(sharers),
      marks_(source.stream().get()),
      tally_(zeros<MesherTally>(1, source.stream().get())) {}

// ---- memory ----

// Bytes that may be taken in all: the sharers of a device share what the options allow on it.
std::uint64_t DeviceBrickMesher::allowed() const { return options_.device_memory / sharers_; }

// Bytes that may still be taken.
std::uint64_t DeviceBrickMesher::room() const {
  return std::min(allowed() - std::min(taken_, allowed()), available_device_memory() / sharers_);
}

// The pool knows at once what it has to spare. room() asks the driver of the device, which takes as
// long as a small extraction, so it is asked only if the pool has too little.
bool DeviceBrickMesher::fits(std::uint64_t bytes) const {
  if (taken_ + bytes > allowed()) return false;
  return bytes <= spare_device_memory() / sharers_ || bytes <= room();
}

void DeviceBrickMesher::throw_no_room(std::uint64_t need) const {
  throw DeviceMemoryExceeded("extraction needs " + std::to_string(need) +
                             " bytes of device memory, " + std::to_string(room()) +
                             " are available: choose a coarser mesh or the cpu backend");
}

std::uint64_t DeviceBrickMesher::field_bytes(std::uint64_t bricks) const {
  return bricks * source_.kept_per_brick();
}

std::uint64_t DeviceBrickMesher::mesh_bytes(const BrickSums& from, const BrickSums& to) const {
  return indexed_mesh_bytes({to.vertices - from.vertices, to.triangles - from.triangles},
                            {.connectivity = options_.connectivity,
                             .normals = options_.normals,
                             .width = source_.label_width()});
}

// ---- counting ----

void DeviceBrickMesher::count(const KeyRange& own) {
  const std::uint64_t most = options_.memory_limit / sizeof(ActiveBrick);
  const KeyRange searched = with_halo(own, options_.connectivity);
  searched_from_ = searched.begin;
  count(source_.candidates(searched, most), own);
}

void DeviceBrickMesher::count(KeyList candidates, const KeyRange& own) {
  const Stream& stream = source_.stream();
  candidates_ = std::move(candidates);
  mark_end_of(Stage::search);
  const std::uint64_t n = candidates_.count;
  const std::uint64_t fixed = n * kBrickBytes, each = field_bytes(1);
  const bool whole = fits(fixed + n * each);
  if (!whole && fixed + each > room()) throw_no_room(fixed + each);
  // A source that keeps nothing (`each` is 0) always counts as holding its field.
  const std::uint64_t at_once = whole || each == 0 ? n : std::min(n, (room() - fixed) / each);
  holds_field_ = at_once == n;
  kept_ = DeviceArray<std::byte>(field_bytes(at_once), stream.get());
  taken_ += fixed + kept_.bytes();
  counted_.bricks = DeviceArray<ActiveBrick>(n, stream.get());
  own_ = find(own);
  const DeviceArray<BrickSums> sums(n, stream.get());
  neighbours_ = DeviceArray<TriangleNeighbours>(n, stream.get());
  // The arrows through tally_.data() only compute addresses in device memory.
  count_all({sums.data(), tally_.data()->parts}, tally_.data()->halo_parts);
  find_triangle_neighbours(candidates_, neighbours_.data(), stream);
  mark_end_of(Stage::count);
  counted_.before = DeviceArray<BrickSums>(n + 1, stream.get());
  run_cub("scan", stream.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceScan::InclusiveScan(scratch, bytes, sums.data(), counted_.before.data() + 1,
                                          AddSums{}, static_cast<std::int64_t>(n), stream.get());
  });
  BrickTotals* const totals = &tally_.data()->totals;
  launch("add_up", add_up, {1, kCountParts}, stream.get(), tally_.data()->parts,
         counted_.before.data(), n, totals);
  counted_.totals = fetch(totals, stream);
  own_to_ = counted_.totals.sums;
  if (own_.begin > 0) own_from_ = fetch(counted_.before.data() + own_.begin, stream);
  if (own_.end < candidates_.count) own_to_ = fetch(counted_.before.data() + own_.end, stream);
  halo_ = {own_from_.vertices, counted_.totals.sums.vertices - own_to_.vertices, 0};
  if (own.end != kNoBrickKey) {
    const std::uint64_t begin = find({first_with_border(own), own.end}).begin;
    const BrickSums sums_there = fetch(counted_.before.data() + begin, stream);
    halo_.naming_triangles = own_to_.triangles - sums_there.triangles;
  }
  mark_end_of(Stage::scan);
}

// The candidates of the range.
BrickRange DeviceBrickMesher::find(const KeyRange& range) const {
  if (range.begin == 0 && range.end == kNoBrickKey) return {0, candidates_.count};
  const Stream& stream = source_.stream();
  const DeviceArray<BrickRange> found(1, stream.get());
  launch("find_keys", find_keys, {1, 2}, stream.get(), candidates_.keys.data(), candidates_.count,
         range, found.data());
  return fetch(found.data(), stream);
}

// Counts the bricks of the range, and with a tally of their own those before and behind it.
void DeviceBrickMesher::count_all(const BrickCounts& counts, CountPart* halo_parts) {
  const BrickCounts halo_counts{counts.sums, halo_parts};
  count_range({0, own_.begin}, halo_counts);
  count_range(own_, counts);
  count_range({own_.end, candidates_.count}, halo_counts);
}

// In runs of as many bricks as the kept field has room for. If it has room for all, every brick has
// its own place there, else each run begins at the front.
void DeviceBrickMesher::count_range(const BrickRange& range, const BrickCounts& counts) const {
  const std::uint64_t each = source_.kept_per_brick();
  const std::uint64_t at_once = holds_field_ ? range.size() : kept_.size() / each;
  for (std::uint64_t begin = range.begin; begin < range.end; begin += at_once) {
    const std::uint64_t size = std::min(at_once, range.end - begin);
    std::byte* const kept = kept_.data() + (holds_field_ ? begin * each : 0);
    source_.count(candidates_.keys.data() + begin, size, counted_.bricks.data() + begin, kept,
                  {counts.sums + begin, counts.parts});
  }
}

MeshSize DeviceBrickMesher::size() const {
  return {own_to_.vertices - own_from_.vertices, own_to_.triangles - own_from_.triangles};
}

// ---- emission ----

std::vector<BrickSums> DeviceBrickMesher::number_apart(const FieldStack& stack) {
  const Stream& stream = source_.stream();
  std::vector<BrickSums> sums(static_cast<std::size_t>(stack.layers()) + 1);
  before_mesh_ = DeviceArray<BrickSums>(sums.size(), stream.get());
  constexpr unsigned threads = 128;
  launch("find_meshes", find_meshes, over(sums.size(), threads), stream, stack,
         candidates_.keys.data(), candidates_.count, counted_.before.data(), before_mesh_.data());
  download_parts({{sums.data(), before_mesh_.data(), before_mesh_.bytes()}}, stream);
  return sums;
}

DeviceMesh DeviceBrickMesher::emit_on_device() {
  const BrickSlab all{own_, own_from_, own_to_};
  // A mesh on the device is made in one piece, for which the whole field has to be there.
  const std::uint64_t missing = holds_field_ ? 0 : field_bytes(candidates_.count);
  const std::uint64_t need = mesh_bytes(own_from_, own_to_) + missing;
  if (!holds_field_ || !fits(need)) throw_no_room(need);
  DeviceMesh mesh = make_mesh(all);
  emit(all, mesh.view());
  check_tally();
  return mesh;
}

void DeviceBrickMesher::emit_to_host(const MeshSize& first, IndexedMesh& host, std::uint64_t share,
                                     std::uint64_t share_count) {
  check_cuda(cudaMemsetAsync(&tally_.data()->emission, 0, sizeof(DeviceEmissionTally),
                             source_.stream().get()),
             "clearing device memory");
  number_from(first);
  for (const BrickSlab& slab : plan_slabs(share, share_count)) {
    advance(options_.monitor, 0);  // no progress to tell, but a chance to cancel
    if (!holds_field_ && source_.kept_per_brick() > 0) fill_field(slab.bricks);
    if (slab.to.triangles == slab.from.triangles && slab.to.vertices == slab.from.vertices)
      continue;
    const DeviceMesh mesh = make_mesh(slab);
    DeviceMeshView part = mesh.view();
    part.first_vertex = slab.from.vertices;
    part.first_triangle = slab.from.triangles;
    mark_end_of(Stage::other);  // what the host did meanwhile is not the kernels' time
    emit(slab, part);
    download_slab(slab, mesh, first, host);
    ++slabs_;
  }
  check_tally();
}

// Numbers the first brick of the range with `first`, and all others accordingly.
void DeviceBrickMesher::number_from(const MeshSize& first) {
  const BrickSums shift{first.vertices - own_from_.vertices, first.triangles - own_from_.triangles};
  if (shift.vertices == 0 && shift.triangles == 0) return;
  constexpr unsigned threads = 256;
  const std::uint64_t n = candidates_.count + 1;
  launch("shift_sums", shift_sums, over(n, threads), source_.stream().get(), counted_.before.data(),
         n, shift);
  own_from_ = {first.vertices, first.triangles};
  own_to_ = AddSums()(own_to_, shift);
}

// Cuts a share of the range into slabs: one if it is all of the range and the mesh fits beside the
// field that is kept. Otherwise the field is given up, since a slab needs only that of its own
// bricks, and each slab takes as many bricks as fit.
std::vector<DeviceBrickMesher::BrickSlab> DeviceBrickMesher::plan_slabs(std::uint64_t share,
                                                                        std::uint64_t share_count) {
  if (own_.size() == 0) return {};
  if (share_count == 1 && holds_field_ && fits(mesh_bytes(own_from_, own_to_))) {
    return {{own_, own_from_, own_to_}};
  }
  // before[b] belongs to brick own_.begin + b.
  std::vector<BrickSums> before(own_.size() + 1);
  download_parts(
      {{before.data(), counted_.before.data() + own_.begin, before.size() * sizeof(BrickSums)}},
      source_.stream());
  const auto begin_of = [&](std::uint64_t number) -> std::uint64_t {
    if (number == share_count) return own_.size();
    const std::uint64_t triangles = size().triangles / share_count * number;
    const auto at = std::partition_point(before.begin(), before.end() - 1, [&](const BrickSums& s) {
      return s.triangles - own_from_.triangles < triangles;
    });
    return static_cast<std::uint64_t>(at - before.begin());
  };
  take_field(0);
  std::vector<BrickSlab> slabs = runs_that_fit(before, {begin_of(share), begin_of(share + 1)});
  std::uint64_t most = 0;
  for (const BrickSlab& slab : slabs) most = std::max(most, slab.bricks.size());
  take_field(most);
  return slabs;
}

// Gives up the field that is kept and takes memory for that of as many bricks. It holds none yet.
void DeviceBrickMesher::take_field(std::uint64_t bricks) {
  taken_ -= kept_.bytes();
  kept_ = DeviceArray<std::byte>();  // first, so that both are never there
  kept_ = DeviceArray<std::byte>(field_bytes(bricks), source_.stream().get());
  taken_ += kept_.bytes();
  holds_field_ = false;
}

std::vector<DeviceBrickMesher::BrickSlab> DeviceBrickMesher::runs_that_fit(
    const std::vector<BrickSums>& before, BrickRange share) {
  const std::uint64_t most = room();
  std::vector<BrickSlab> slabs;
  for (std::uint64_t begin = share.begin; begin < share.end;) {
    const auto bytes = [&](std::uint64_t end) {
      return field_bytes(end - begin) + mesh_bytes(before[begin], before[end]);
    };
    std::uint64_t end = begin + 1;
    if (bytes(end) > most) throw_no_room(bytes(end));
    while (end < share.end && bytes(end + 1) <= most) ++end;
    slabs.push_back({{own_.begin + begin, own_.begin + end}, before[begin], before[end]});
    begin = end;
  }
  return slabs;
}

// Evaluates the field of a slab by counting its bricks once more. The counts are known already, so
// they go to arrays that are thrown away.
void DeviceBrickMesher::fill_field(const BrickRange& slab) const {
  const Stream& stream = source_.stream();
  const DeviceArray<CountPart> parts(kCountParts, stream.get());
  clear(parts, stream.get());
  const DeviceArray<BrickSums> sums(slab.size(), stream.get());
  source_.count(candidates_.keys.data() + slab.begin, slab.size(),
                counted_.bricks.data() + slab.begin, kept_.data(), {sums.data(), parts.data()});
}

DeviceMesh DeviceBrickMesher::make_mesh(const BrickSlab& slab) const {
  return DeviceMesh(slab.to.vertices - slab.from.vertices, slab.to.triangles - slab.from.triangles,
                    source_.stream().get(), source_.label_width(), options_.normals,
                    options_.connectivity);
}

void DeviceBrickMesher::emit(const BrickSlab& slab, const DeviceMeshView& mesh) {
  const Stream& stream = source_.stream();
  const BrickList list = counted_.list();
  const std::uint64_t kept_from = holds_field_ ? slab.bricks.begin : 0;
  source_.emit_vertices(part_of(list, slab.bricks), counted_.totals.most_atoms,
                        kept_.data() + field_bytes(kept_from), mesh,
                        &tally_.data()->emission.clamped);
  mark_end_of(Stage::vertices);
  emit_triangles_on_device(list, neighbours_, searched_from_, before_mesh_.data(), slab.bricks,
                           mesh, &tally_.data()->emission, stream);
  mark_end_of(Stage::triangles);
}

void DeviceBrickMesher::download_slab(const BrickSlab& slab, const DeviceMesh& mesh,
                                      const MeshSize& first, IndexedMesh& host) {
  const std::uint64_t vertex = slab.from.vertices - first.vertices;
  const std::uint64_t triangle = slab.from.triangles - first.triangles;
  std::vector<DownloadPart> parts = {
      part_for(host.positions, vertex, mesh.positions),
      {host.triangles.data() + triangle, mesh.corners.data(), mesh.corners.bytes()}};
  if (mesh.vertex_spheres.atoms.size() > 0) {
    parts.push_back(part_for(host.vertex_spheres.atoms, vertex, mesh.vertex_spheres.atoms));
  }
  if (mesh.normals.size() > 0) {
    parts.push_back(part_for(host.normals, vertex, mesh.normals));
  }
  if (mesh.opposite.size() > 0) {
    parts.push_back(part_for(host.opposite, 3 * triangle, mesh.opposite));
  }
  download_parts(parts, source_.stream());
  mark_end_of(Stage::download);
}

void DeviceBrickMesher::check_tally() {
  const DeviceEmissionTally tally = fetch(&tally_.data()->emission, source_.stream());
  clamped_ = tally.clamped;
  if (tally.missing_neighbours == 0) return;
  throw InternalError("the surface continues into bricks that the search did not find, at " +
                      std::to_string(tally.missing_neighbours) + " faces of bricks");
}

// ---- times ----

void DeviceBrickMesher::mark_end_of(Stage stage) {
  marks_.mark();
  stages_.push_back(stage);
}

float DeviceBrickMesher::milliseconds_in(Stage stage) const {
  float sum = 0;
  for (std::size_t i = 0; i < stages_.size(); ++i) {
    if (stages_[i] == stage) sum += marks_.stage(i);
  }
  return sum;
}

ExtractTimings DeviceBrickMesher::timings() const {
  return {milliseconds_in(Stage::search), milliseconds_in(Stage::count),
          milliseconds_in(Stage::scan), milliseconds_in(Stage::vertices),
          milliseconds_in(Stage::triangles)};
}

ExtractStats DeviceBrickMesher::stats(const ExtractTimings& ms) const {
  ExtractStats stats;
  stats.surface_bricks = counted_.totals.surface_bricks;
  stats.grid_clipped = counted_.totals.clipped_cells;
  stats.clamped_vertices = clamped_;
  stats.slabs = slabs_;
  stats.field_seconds = (ms.search + ms.count + ms.scan) * 1e-3;
  stats.extract_seconds = (ms.vertices + ms.triangles) * 1e-3;
  stats.download_seconds = milliseconds_in(Stage::download) * 1e-3;
  return stats;
}

}  // namespace vdwmesh
