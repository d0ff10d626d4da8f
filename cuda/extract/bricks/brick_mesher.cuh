// Marching cubes on one device: count the bricks of a range, then emit them, to the device as one
// mesh or to the host in runs.
#pragma once

#include <vector>

#include "cuda/extract/bricks/brick_source.cuh"

namespace vdwmesh {

struct MesherTally;  // device memory that the mesher's kernels add to; begins as zeros

class DeviceBrickMesher {
 public:
  // `sharers` meshers work on the current device at the same time, each with its part of the free
  // memory. Source and options must outlive the mesher.
  DeviceBrickMesher(const BrickSource& source, const ExtractOptions& options,
                    std::size_t sharers = 1);

  // Finds the candidates, counts what they hold and numbers it: the bricks of `own`, and around
  // them those of its halo. Once per mesher. Throws LimitExceeded, and DeviceMemoryExceeded if not
  // even one brick's field fits beside what is kept of every brick.
  void count(const KeyRange& own = {});
  // The same for candidates that are known (keys, rising).
  void count(KeyList candidates, const KeyRange& own = {});

  // What the bricks of the range hold.
  MeshSize size() const;
  // The vertices of the bricks around the range.
  HaloVertices halo() const { return halo_; }

  // For bricks of a stack: numbers vertices and triangles of each field's mesh from 0. Returns, by
  // layer of bricks, how many vertices and triangles the meshes before that of the layer's field
  // have, and behind them the sums of all meshes. emit_on_device() puts the meshes one behind the
  // other.
  std::vector<BrickSums> number_apart(const FieldStack& stack);

  // Emits the range into a mesh on the device, whose size the caller has checked. Throws
  // DeviceMemoryExceeded if it does not fit.
  DeviceMesh emit_on_device();

  // Emits one of `share_count` shares of the range, which have about as many triangles each, to its
  // place in a mesh on the host that has room for the range. It goes in slabs, runs of bricks that
  // fit the device, whose field is evaluated again if it was not kept. `first`: the numbers of the
  // range's first vertex and triangle in the whole mesh, as for SurfacePart::emit.
  void emit_to_host(const MeshSize& first, IndexedMesh& host, std::uint64_t share = 0,
                    std::uint64_t share_count = 1);

  std::uint64_t candidates() const { return candidates_.count; }
  // What the kernels took so far; waits for them.
  ExtractTimings timings() const;
  ExtractStats stats() const { return stats(timings()); }
  ExtractStats stats(const ExtractTimings& milliseconds) const;

 private:
  enum class Stage : std::uint8_t { search, count, scan, vertices, triangles, download, other };
  struct BrickSlab {
    BrickRange bricks;
    BrickSums from, to;  // numbers of its first vertex and triangle, and of those behind it
  };

  std::uint64_t allowed() const;
  std::uint64_t room() const;
  bool fits(std::uint64_t bytes) const;
  [[noreturn]] void throw_no_room(std::uint64_t need) const;
  std::uint64_t field_bytes(std::uint64_t bricks) const;
  std::uint64_t mesh_bytes(const BrickSums& from, const BrickSums& to) const;

  void count_all(const BrickCounts& counts, CountPart* halo_parts);
  void count_range(const BrickRange& range, const BrickCounts& counts) const;
  BrickRange find(const KeyRange& range) const;
  void number_from(const MeshSize& first);
  std::vector<BrickSlab> plan_slabs(std::uint64_t share, std::uint64_t share_count);
  std::vector<BrickSlab> runs_that_fit(const std::vector<BrickSums>& before, BrickRange share);
  void take_field(std::uint64_t bricks);
  void fill_field(const BrickRange& slab) const;
  DeviceMesh make_mesh(const BrickSlab& slab) const;
  void emit(const BrickSlab& slab, const DeviceMeshView& mesh);
  void download_slab(const BrickSlab& slab, const DeviceMesh& mesh, const MeshSize& first,
                     IndexedMesh& host);
  void check_tally();
  void mark_end_of(Stage stage);
  float milliseconds_in(Stage stage) const;

  const BrickSource& source_;
  const ExtractOptions& options_;
  std::size_t sharers_;
  StageMarks marks_;
  std::vector<Stage> stages_;        // between one mark and the next
  std::uint64_t taken_ = 0;          // bytes of device memory, beside meshes and slabs' fields
  KeyList candidates_;               // of the range and its halo
  std::uint64_t searched_from_ = 0;  // the lowest key that a candidate may have
  BrickRange own_{0, 0};             // those of the range
  DeviceArray<std::byte> kept_;      // BrickSource::kept_per_brick() of each brick
  bool holds_field_ = false;         // of all candidates
  DeviceCountedBricks counted_;
  BrickSums own_from_{0, 0}, own_to_{0, 0};  // sums before the range and behind it
  HaloVertices halo_;
  DeviceArray<BrickSums> before_mesh_;  // by layer of bricks; empty if all are of one mesh
  DeviceArray<TriangleNeighbours> neighbours_;
  DeviceArray<MesherTally> tally_;
  std::uint64_t clamped_ = 0, slabs_ = 0;
};

}  // namespace vdwmesh
