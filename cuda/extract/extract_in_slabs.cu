#include <algorithm>
#include <memory>
#include <optional>

#include "cuda/extract/extract_in_slabs.cuh"
#include "cuda/extract/mesh_bricks.cuh"
#include "cuda/memory/device.cuh"
#include "cuda/memory/download.cuh"
#include "cuda/memory/run_on_threads.hpp"
#include "extract/blended/field_sample.hpp"
#include "extract/limits.hpp"

namespace vdwmesh {
namespace {

[[noreturn]] void throw_no_room(std::uint64_t need, std::uint64_t have) {
  throw DeviceMemoryExceeded("extraction needs " + std::to_string(need) +
                             " bytes of device memory, " + std::to_string(have) +
                             " are available: choose a larger spacing or the cpu backend");
}

struct Slab {
  BrickRange bricks;
  BrickSums from, to;  // numbers of its vertices and triangles
};

// What one device does.
class SlabWorker {
 public:
  // `sharers` workers share the device's memory.
  SlabWorker(int device, std::size_t sharers, const CellListView& list, const FieldModel& model,
             const ExtractOptions& options)
      : device_(device), sharers_(sharers), model_(model), options_(options), list_(list) {}

  // All bricks: candidates, counts, numbers.
  void count() {
    use_device(device_);
    stream_.emplace();
    device_list_.emplace(list_, stream_->get());
    field_.emplace(device_list_->view(), model_, *stream_);
    marks_.emplace(stream_->get());
    room_ = std::min(options_.device_memory, available_device_memory() / sharers_);
    candidates_ = candidate_bricks_on_device(context(), options_.memory_limit / sizeof(ActiveBrick),
                                             *stream_);
    marks_->mark();
    const std::uint64_t fixed = candidates_.count * kBrickBytes;
    if (fixed + field_bytes(1) > room_) throw_no_room(fixed + field_bytes(1), room_);
    room_ -= fixed;
    const std::uint64_t at_once = bricks_at_once();
    values_ = DeviceArray<float>(at_once * values_per_brick(), stream_->get());
    counted_ = count_and_scan(
        candidates_,
        [&](ActiveBrick* bricks, const BrickCounts& counts) {
          for (std::uint64_t begin = 0; begin < candidates_.count; begin += at_once) {
            count_range({begin, std::min(begin + at_once, candidates_.count)}, bricks, counts);
          }
        },
        *marks_, *stream_);
    holds_field_ = at_once >= candidates_.count;
  }

  const BrickTotals& totals() const { return counted_.totals; }

  // Share `k` of `shares` of the bricks, by triangles.
  void emit(std::uint64_t k, std::uint64_t shares, IndexedMesh& host) {
    use_device(device_);
    const DeviceArray<DeviceEmissionTally> tally(1, stream_->get());
    clear(tally, stream_->get());
    neighbours_ = find_triangle_neighbours(candidates_, *stream_);
    for (const Slab& slab : slabs_of(k, shares)) {
      emit_slab(slab, tally.data(), host);
      ++slabs_;
    }
    const DeviceEmissionTally noticed = fetch(tally.data(), *stream_);
    check_tally(noticed);
    clamped_ = noticed.clamped;
  }

  std::uint64_t clamped() const { return clamped_; }
  std::uint64_t slabs() const { return slabs_; }
  double field_seconds() const {
    return (marks_->stage(0) + marks_->stage(1) + marks_->stage(2)) * 1e-3;
  }
  double emit_seconds() const { return emit_seconds_; }
  double download_seconds() const { return download_seconds_; }

 private:
  const FieldContext& context() const { return field_->context(); }
  std::uint64_t values_per_brick() const {
    return model_.kind == FieldKind::vdw ? 0 : std::uint64_t{kBrickValues};
  }
  std::uint64_t field_bytes(std::uint64_t bricks) const {
    return bricks * values_per_brick() * sizeof(float);
  }
  std::uint64_t bricks_at_once() const {
    const std::uint64_t each = field_bytes(1);
    return each == 0 ? candidates_.count : std::min(candidates_.count, room_ / each);
  }
  std::uint64_t mesh_bytes(const BrickSums& from, const BrickSums& to) const {
    return indexed_mesh_bytes({to.vertices - from.vertices, to.triangles - from.triangles},
                              {.connectivity = options_.connectivity, .normals = options_.normals});
  }

  void count_range(const BrickRange& range, ActiveBrick* bricks, const BrickCounts& counts) const {
    count_bricks_on_device(context(), candidates_.keys.data() + range.begin, range.size(),
                           bricks + range.begin, values_.data(),
                           {counts.sums + range.begin, counts.parts}, *stream_);
  }

  // The slabs of a share: one where the mesh and what is kept of the field fit, else runs of as
  // many bricks as do.
  std::vector<Slab> slabs_of(std::uint64_t k, std::uint64_t shares) {
    const std::uint64_t bricks = candidates_.count;
    if (bricks == 0) return {};
    const std::uint64_t all = mesh_bytes({0, 0}, totals().sums);
    if (shares == 1 && holds_field_ && field_bytes(bricks) + all <= room_) {
      return {{{0, bricks}, {0, 0}, totals().sums}};
    }
    std::vector<BrickSums> before(bricks + 1);
    download_parts({{before.data(), counted_.before.data(), before.size() * sizeof(BrickSums)}},
                   *stream_);
    const auto share_begin = [&](std::uint64_t share) -> std::uint64_t {
      if (share == shares) return bricks;
      const std::uint64_t triangles = totals().sums.triangles / shares * share;
      const auto at =
          std::partition_point(before.begin(), before.end() - 1,
                               [&](const BrickSums& s) { return s.triangles < triangles; });
      return static_cast<std::uint64_t>(at - before.begin());
    };
    const std::uint64_t end = share_begin(k + 1);
    std::vector<Slab> slabs;
    for (std::uint64_t begin = share_begin(k); begin < end;) {
      std::uint64_t to = begin + 1;
      const auto bytes = [&](std::uint64_t last) {
        return field_bytes(last - begin) + mesh_bytes(before[begin], before[last]);
      };
      if (bytes(to) > room_) throw_no_room(bytes(to), room_);
      while (to < end && bytes(to + 1) <= room_) ++to;
      slabs.push_back({{begin, to}, before[begin], before[to]});
      begin = to;
    }
    make_room_for_fields(slabs);
    return slabs;
  }

  // From here on the field is made again, slab by slab.
  void make_room_for_fields(const std::vector<Slab>& slabs) {
    std::uint64_t most = 0;
    for (const Slab& slab : slabs) most = std::max(most, slab.bricks.size());
    holds_field_ = false;
    values_ = DeviceArray<float>();
    values_ = DeviceArray<float>(most * values_per_brick(), stream_->get());
  }

  void emit_slab(const Slab& slab, DeviceEmissionTally* tally, IndexedMesh& host) {
    advance(options_.monitor, 0);
    if (!holds_field_ && values_per_brick() > 0) recount(slab.bricks);
    const BrickSums &from = slab.from, &to = slab.to;
    const std::uint64_t vertices = to.vertices - from.vertices;
    const std::uint64_t triangles = to.triangles - from.triangles;
    if (triangles == 0 && vertices == 0) return;
    const DeviceMesh mesh(vertices, triangles, stream_->get(), LabelWidth::one, options_.normals,
                          options_.connectivity);
    DeviceMeshView part = mesh.view();
    part.first_vertex = from.vertices;
    part.first_triangle = from.triangles;
    emit_vertices_on_device(context(), part_of(counted_.list(), slab.bricks), totals().most_atoms,
                            values_.data(), part, &tally->clamped, *stream_);
    emit_triangles_on_device(counted_.list(), neighbours_, slab.bricks, part, tally, *stream_);
    std::vector<DownloadPart> parts = {
        {host.positions.data() + from.vertices, mesh.positions.data(), mesh.positions.bytes()},
        {host.vertex_spheres.atoms.data() + from.vertices, mesh.vertex_spheres.atoms.data(),
         mesh.vertex_spheres.atoms.bytes()},
        {host.triangles.data() + from.triangles, mesh.corners.data(), mesh.corners.bytes()}};
    if (options_.normals == Normals::gradients) {
      parts.push_back(
          {host.normals.data() + from.vertices, mesh.normals.data(), mesh.normals.bytes()});
    }
    if (options_.connectivity == Connectivity::half_edges) {
      parts.push_back(
          {host.opposite.data() + 3 * from.triangles, mesh.opposite.data(), mesh.opposite.bytes()});
    }
    marks_->mark();
    download_parts(parts, *stream_);
    marks_->mark();
    emit_seconds_ += marks_->stage(marked_) * 1e-3;
    download_seconds_ += marks_->stage(marked_ + 1) * 1e-3;
    marked_ += 2;
  }

  // The field of a slab; what is counted along the way is known.
  void recount(const BrickRange& slab) const {
    const DeviceArray<CountPart> parts(kCountParts, stream_->get());
    clear(parts, stream_->get());
    const DeviceArray<BrickSums> sums(slab.size(), stream_->get());
    count_bricks_on_device(context(), candidates_.keys.data() + slab.begin, slab.size(),
                           counted_.bricks.data() + slab.begin, values_.data(),
                           {sums.data(), parts.data()}, *stream_);
  }

  int device_;
  std::size_t sharers_;
  FieldModel model_;
  ExtractOptions options_;
  CellListView list_;
  std::optional<Stream> stream_;
  std::optional<DeviceCellList> device_list_;
  std::optional<DeviceField> field_;
  std::optional<StageMarks> marks_;
  std::uint64_t room_ = 0;  // bytes, beside what is kept of every brick
  KeyList candidates_;
  DeviceArray<float> values_;
  bool holds_field_ = false;  // of all candidates
  CountedBricks counted_;
  DeviceArray<TriangleNeighbours> neighbours_;  // of all candidates
  std::uint64_t clamped_ = 0, slabs_ = 0;
  std::size_t marked_ = 3;  // stages before the next slab
  double emit_seconds_ = 0, download_seconds_ = 0;
};

void make_checked_room(const BrickSums& sums, const ExtractOptions& options, double spacing,
                       IndexedMesh& host) {
  const MeshSize size{sums.vertices, sums.triangles};
  const MeshArrays arrays{.connectivity = options.connectivity, .normals = options.normals};
  check_mesh_limits({size, arrays, 0, spacing}, options.memory_limit);
  if (options.on_size) options.on_size(size);
  make_room(host, size, arrays);
}

// The usable devices, the current one first.
std::vector<int> devices_from_current() {
  int current = 0;
  check_cuda(cudaGetDevice(&current), "device");
  std::vector<int> devices = usable_devices();
  std::ranges::rotate(devices, std::ranges::find(devices, current));
  return devices;
}

}  // namespace

ExtractResult extract_to_host(const SphereSet& spheres, const ExtractOptions& options) {
  if (options.devices < 1) throw InvalidInput("the number of devices must be at least 1");
  ExtractResult result;
  result.grid = make_grid(spheres, options.grid);
  const FieldModel model = make_field_model(options.field, result.grid);
  const CellList list = make_field_list(spheres, model);
  const DeviceScope scope;
  const std::vector<int> present = devices_from_current();
  const auto shares = static_cast<std::size_t>(options.devices);
  const std::size_t sharers = (shares + present.size() - 1) / present.size();
  std::vector<std::unique_ptr<SlabWorker>> workers;
  for (std::size_t k = 0; k < shares; ++k) {
    workers.push_back(std::make_unique<SlabWorker>(present[k % present.size()], sharers,
                                                   list.view(), model, options));
  }
  begin_stage(options.monitor, "field", 1);
  run_on_threads(shares, [&](std::size_t k) { workers[k]->count(); });
  advance(options.monitor, 1);
  begin_stage(options.monitor, "extract", 1);
  make_checked_room(workers[0]->totals().sums, options, result.grid.spacing, result.mesh);
  run_on_threads(shares, [&](std::size_t k) { workers[k]->emit(k, shares, result.mesh); });
  advance(options.monitor, 1);
  result.stats.grid_clipped = workers[0]->totals().clipped_cells;
  result.stats.surface_bricks = workers[0]->totals().surface_bricks;
  for (const std::unique_ptr<SlabWorker>& worker : workers) {
    result.stats.clamped_vertices += worker->clamped();
    result.stats.slabs += worker->slabs();
    result.stats.field_seconds = std::max(result.stats.field_seconds, worker->field_seconds());
    result.stats.extract_seconds = std::max(result.stats.extract_seconds, worker->emit_seconds());
    result.stats.download_seconds =
        std::max(result.stats.download_seconds, worker->download_seconds());
  }
  return result;
}

}  // namespace vdwmesh
