// What ranks take for copies of a structure that they have in memory: the exact area and volume of
// all, or one mesh of them in the memory of the ranks. Reads and writes no large file, so that the
// work on the spheres alone is timed. For the figures of docs/scale.md.
//
//   mpirun -n P ranks_bench FILE [--atoms N] [--exact off|counts] [--mesh SPACING] [--repeats R]
//          [--backend cpu|cuda] [--threads T] [--devices D] [--stages 1] [--check 1]
//
// There are as many copies as N atoms take (lattice.hpp; default: a million). --threads is of one
// rank; without it a rank takes the processors that it is bound to. Times are by the clock, from
// all ranks ready to all ranks done; the first repetition includes the start of a device, and
// memory that nobody has written before, which later ones use again. --devices meshes without the
// other ranks' part of the work, by the extractor of one process, on so many devices (with one rank
// only). --stages does the steps of the mesh once more one by one, and times each. --check closes
// with two proofs:
//
// - The directed edges of all triangles, by the numbers of their vertices in the whole mesh, cancel
//   out: each has its reverse. Every undirected edge has a pseudo-random number of 64 bits, which
//   is added for one direction and subtracted for the other, and the sum over all ranks is 0. If
//   some edge did not cancel, that would have a chance of 2^-64. So the mesh is closed and
//   oriented, and its Euler characteristic is V - F / 2.
// - The copies do not touch. Each is meshed alone, in the grid of the whole, and the numbers of
//   vertices and triangles, the Euler characteristics and the volumes add up to those of the whole,
//   volumes to the last bit, because they are summed without rounding. The ranks share the copies:
//   rank r of P takes copies r, r + P, ...
//
// It ends with an error if one of the proofs fails.
#include <fmt/format.h>
#include <sched.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <bit>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "cuda/backend.hpp"
#include "distributed/host_memory.hpp"
#include "distributed/shares/surface_piece.hpp"
#include "distributed/shares/surface_shares.hpp"
#include "distributed/together/part_together.hpp"
#include "distributed/together/union_together.hpp"
#include "lattice.hpp"
#include "measures/exact_sum.hpp"
#include "memory.hpp"

namespace vdwmesh {
namespace {

struct Arguments {
  LatticeOptions lattice;
  std::string exact;   // empty: no exact measures
  double spacing = 0;  // Å; 0: no mesh
  int repeats = 1, threads = 0, devices = 0;
  Backend backend = Backend::cpu;
  bool stages = false, check = false;
};

Arguments read_arguments(int argc, char** argv) {
  Arguments o;
  o.lattice =
      read_lattice_options(argc, argv, [&](std::string_view name, const std::string& value) {
        if (name == "--exact") {
          o.exact = value;
        } else if (name == "--mesh") {
          o.spacing = std::stod(value);
        } else if (name == "--repeats") {
          o.repeats = std::stoi(value);
        } else if (name == "--threads") {
          o.threads = std::stoi(value);
        } else if (name == "--devices") {
          o.devices = std::stoi(value);
        } else if (name == "--backend") {
          o.backend = value == "cuda" ? Backend::cuda : Backend::cpu;
        } else if (name == "--stages") {
          o.stages = value == "1";
        } else if (name == "--check") {
          o.check = value == "1";
        } else {
          return false;
        }
        return true;
      });
  return o;
}

std::size_t usable_processors() {
  cpu_set_t processors;
  CPU_ZERO(&processors);
  if (::sched_getaffinity(0, sizeof processors, &processors) != 0) return 1;
  return static_cast<std::size_t>(CPU_COUNT(&processors));
}

double largest(const std::vector<double>& values) { return *std::ranges::max_element(values); }

double mean(const std::vector<double>& values) {
  return std::reduce(values.begin(), values.end()) / static_cast<double>(values.size());
}

// Seconds until all ranks have done the work, and those that the ranks do not wait: their mean, and
// the most of one.
struct RankSeconds {
  double all = 0, mean = 0, most = 0;
};

// Collective.
RankSeconds seconds_of(const Ranks& ranks, const std::function<void()>& work) {
  using Clock = std::chrono::steady_clock;
  ranks.sum(std::uint64_t{0});
  const Clock::time_point begin = Clock::now();
  const double before = ranks.seconds_of_work();
  work();
  const double own = ranks.seconds_of_work() - before;
  ranks.sum(std::uint64_t{0});
  const double all = std::chrono::duration<double>(Clock::now() - begin).count();
  const std::vector<double> each = ranks.of_all(own);
  return {all, mean(each), largest(each)};
}

// A line of /proc/self/status in MiB; 0 if there is none.
double status_mib(std::string_view key) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (std::string_view(line).starts_with(key)) return std::stod(line.substr(key.size())) / 1024;
  }
  return 0;
}

// What a closed mesh, or a part of one, adds to the sums of the whole.
struct Tally {
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t edges = 0;  // modulo 2^64: 0 of a closed, oriented mesh
  ExactSum volume;          // Å³

  void add(const Tally& other) {
    vertices += other.vertices;
    triangles += other.triangles;
    edges += other.edges;
    volume.add(other.volume);
  }
};

std::uint64_t signed_number(std::uint64_t from, std::uint64_t to) {
  const auto number = [](std::uint64_t a, std::uint64_t b) {
    return split_mix(split_mix(a * kSplitMixStep) + b * kSplitMixStep);
  };
  return from < to ? number(from, to) : -number(to, from);
}

// Adds up triangles whose corners have these numbers and positions. The origin of the volume is the
// middle of the copy that a triangle belongs to: triangles of a closed mesh need one origin, and
// the closer it is, the less is lost by rounding.
template <class NumberOf, class PositionOf>
Tally tally(const Buffer<Triangle>& triangles, double pitch, const NumberOf& number_of,
            const PositionOf& position_of) {
  Tally all;
  all.triangles = triangles.size();
  if (triangles.empty()) return all;
  const Tally sums = join_blocks(
      triangles.size(),
      [&](std::size_t first, std::size_t end) {
        Tally sum;
        for (std::size_t t = first; t < end; ++t) {
          const auto& [a, b, c] = triangles[t];
          const std::uint64_t i = number_of(a), j = number_of(b), k = number_of(c);
          sum.edges += signed_number(i, j) + signed_number(j, k) + signed_number(k, i);
          const Vec3d p = position_of(a);
          const Vec3d middle{pitch * std::round(p.x / pitch), pitch * std::round(p.y / pitch),
                             pitch * std::round(p.z / pitch)};
          sum.volume.add(dot(p - middle, cross(position_of(b) - middle, position_of(c) - middle)) /
                         6);
        }
        return sum;
      },
      [](Tally& sum, const Tally& part) { sum.add(part); });
  all.add(sums);
  return all;
}

// Of all ranks. Collective; the result is that of the first rank.
Tally sum_of(const Ranks& ranks, const Tally& mine) {
  Tally all;
  for (const Tally& tally : ranks.collect(std::span<const Tally>(&mine, 1))) all.add(tally);
  return all;
}

// The positions of the vertices of other ranks that the triangles of a piece have. Collective.
std::vector<Vec3d> positions_elsewhere(const Ranks& ranks, const SurfacePiece& piece) {
  std::vector<std::vector<std::uint64_t>> wanted(static_cast<std::size_t>(ranks.count()));
  for (const std::uint64_t number : piece.elsewhere) {
    wanted[piece.numbers.owner_of(number)].push_back(number);
  }
  std::vector<std::vector<Vec3d>> sent;
  for (const std::vector<std::uint64_t>& numbers : ranks.exchange(wanted)) {
    sent.emplace_back();
    for (const std::uint64_t number : numbers) {
      sent.back().push_back(piece.mesh.positions[piece.numbers.own_vertex(number).value()]);
    }
  }
  std::vector<Vec3d> positions;  // owners, and so the parts, are in the order of the numbers
  for (const std::vector<Vec3d>& from : ranks.exchange(sent)) {
    positions.insert(positions.end(), from.begin(), from.end());
  }
  return positions;
}

class Bench {
 public:
  Bench(const Ranks& ranks, const Arguments& arguments)
      : ranks_(ranks), arguments_(arguments), lattice_(arguments.lattice) {
    std::vector<Sphere> made;
    if (ranks.is_first()) {
      made.resize(lattice_.copies() * lattice_.atoms_of_copy());
      tbb::parallel_for(std::uint64_t{0}, lattice_.copies(), [&](std::uint64_t copy) {
        Sphere* const first = made.data() + copy * lattice_.atoms_of_copy();
        lattice_.for_each_sphere(copy, [&](std::size_t i, const Sphere& s) { first[i] = s; });
      });
    }
    of_spheres_ = HostArray<Sphere>(ranks, made);
    spheres_ = SphereSet::view(of_spheres_.span());
  }

  void run() {
    say("{} ranks, {} threads in the first; {} spheres, {} copies\n", ranks_.count(),
        arguments_.threads, spheres_.size(), lattice_.copies());
    if (!arguments_.exact.empty()) measure();
    if (arguments_.spacing > 0) mesh();
    if (arguments_.stages) time_stages();
    if (arguments_.check) check();
  }

 private:
  template <class... Values>
  void say(fmt::format_string<Values...> format, const Values&... values) const {
    if (!ranks_.is_first()) return;
    fmt::vprint(fmt::string_view(format), fmt::make_format_args(values...));
    std::fflush(stdout);
  }

  // The most of the ranks that are not the first, and the first; a rank's own pages, without the
  // spheres and other files that ranks share. Collective.
  void say_memory() const {
    const std::vector<double> each =
        ranks_.of_all(status_mib("VmHWM:") - status_mib("RssShmem:") - status_mib("RssFile:"));
    double most = 0;
    for (std::size_t rank = 1; rank < each.size(); ++rank) most = std::max(most, each[rank]);
    say("  memory at its peak: first rank {:.0f} MiB, the most of another {:.0f} MiB\n", each[0],
        most);
  }

  void measure() {
    UnionTogetherOptions wanted;
    wanted.topology =
        arguments_.exact == "counts" ? TopologyRequest::counts : TopologyRequest::none;
    if (wanted.topology == TopologyRequest::none) wanted.backend = arguments_.backend;
    for (int repeat = 0; repeat < arguments_.repeats; ++repeat) {
      UnionTogether result;
      const RankSeconds seconds =
          seconds_of(ranks_, [&] { result = union_together(ranks_, spheres_, wanted); });
      say("exact {:.3f} s{} (work {:.3f}, at most {:.3f}): area {:.17g} volume {:.17g}\n",
          seconds.all, result.backend == Backend::cuda ? " on devices" : "", seconds.mean,
          seconds.most, result.area, result.volume);
    }
    say_memory();
  }

  ExtractOptions options() const {
    ExtractOptions options;
    options.grid.spacing = arguments_.spacing;
    return options;
  }

  void mesh() {
    for (int repeat = 0; repeat < arguments_.repeats; ++repeat) {
      if (arguments_.devices > 0) {
        extract();
        continue;
      }
      IndexedMesh memory;
      if (piece_) memory = std::move(piece_->mesh);
      const RankSeconds seconds = seconds_of(ranks_, [&] {
        piece_.emplace(
            mesh_together(ranks_, spheres_, options(), arguments_.backend, std::move(memory)));
      });
      const ExtractStats& stats = piece_->stats;
      say("mesh {:.3f} s (work {:.3f}, at most {:.3f}): {} vertices, {} triangles; at most {:.3f} "
          "field, {:.3f} extract, {:.3f} download; {} slabs {}\n",
          seconds.all, seconds.mean, seconds.most, piece_->whole.vertices, piece_->whole.triangles,
          largest(ranks_.of_all(stats.field_seconds)),
          largest(ranks_.of_all(stats.extract_seconds)),
          largest(ranks_.of_all(stats.download_seconds)), stats.slabs, piece_->fallback);
    }
    if (!piece_) return;
    const std::uint64_t bytes = indexed_mesh_bytes(piece_->mesh);
    const auto triangles = static_cast<double>(piece_->mesh.triangle_count());
    say("  a rank's share of the mesh: at most {:.0f} MiB; {:.3f} of the mean triangles\n",
        largest(ranks_.of_all(static_cast<double>(bytes) / 0x1p20)),
        largest(ranks_.of_all(triangles)) * ranks_.count() /
            static_cast<double>(piece_->whole.triangles));
    say_memory();
  }

  void extract() {
    const auto extractor = make_extractor(arguments_.backend);
    ExtractOptions wanted = options();
    wanted.devices = arguments_.devices;
    const double seconds =
        seconds_of(ranks_, [&] { extractor->extract_into(extracted_, spheres_, wanted); }).all;
    say("extract {:.3f} s on {} devices: {} vertices, {} triangles; {:.3f} field, {:.3f} extract, "
        "{:.3f} download; {} slabs {}\n",
        seconds, arguments_.devices, extracted_.mesh.vertex_count(),
        extracted_.mesh.triangle_count(), extracted_.stats.field_seconds,
        extracted_.stats.extract_seconds, extracted_.stats.download_seconds, extracted_.stats.slabs,
        extracted_.fallback);
  }

  void time_stages() {
    // The last mesh's memory, as a repeated mesh has it: new memory would have to be cleared first.
    IndexedMesh made;
    if (piece_) made = std::move(piece_->mesh);
    piece_.reset();
    const bool is_alone = ranks_.count() == 1;
    const auto stage = [&](const char* name, const std::function<void()>& work) {
      const RankSeconds seconds = seconds_of(ranks_, work);
      say("  {:<10} {:.3f} s (work {:.3f}, at most {:.3f})\n", name, seconds.all, seconds.mean,
          seconds.most);
    };
    ExtractOptions wanted = options();
    FieldModel model;
    std::vector<std::uint64_t> begins;
    ChosenSpheres near;
    std::unique_ptr<SurfacePart> part;
    stage("grid", [&] {
      model = make_field_model(wanted.field, grid_together(ranks_, spheres_, wanted.grid));
    });
    stage("shares", [&] { begins = share_bricks(ranks_, spheres_, model); });
    wanted.grid.given = model.grid;
    const HaloCounts halo = halo_counts(ranks_, arguments_.backend);
    stage("near", [&] {
      if (!is_alone) near = spheres_near(ranks_, spheres_, model, begins, halo);
    });
    stage("count", [&] {
      const SphereSet chosen =
          SphereSet::view(is_alone ? spheres_.spheres() : std::span<const Sphere>(near.spheres));
      part = count_together(ranks_, chosen, near.ids, begins, halo, wanted, arguments_.backend);
    });
    stage("emit", [&] { ranks_.together([&] { part->emit({}, made); }); });
  }

  Tally tally_of_whole() const {
    const SurfacePiece& piece = *piece_;
    const std::vector<Vec3d> elsewhere = positions_elsewhere(ranks_, piece);
    const std::size_t own = piece.numbers.own();
    Tally mine = tally(
        piece.mesh.triangles, lattice_.pitch(),
        [&](std::uint32_t corner) { return piece.number_of(corner); },
        [&](std::uint32_t corner) {
          return corner < own ? piece.mesh.positions[corner] : elsewhere[corner - own];
        });
    mine.vertices = own;
    return sum_of(ranks_, mine);
  }

  // Copies are dealt out to the ranks in turn.
  Tally tally_of_copies() const {
    const FieldModel model = make_field_model(FieldOptions(), make_grid(spheres_, options().grid));
    ExtractOptions wanted = options();
    wanted.grid.given = model.grid;
    const auto extractor = make_extractor(arguments_.backend);
    const auto first = static_cast<std::uint64_t>(ranks_.number());
    const auto step = static_cast<std::uint64_t>(ranks_.count());
    Tally mine;
    ExtractResult result;
    for (std::uint64_t copy = first; copy < lattice_.copies(); copy += step) {
      const std::size_t begin = copy * lattice_.atoms_of_copy();
      extractor->extract_into(
          result, SphereSet::view(spheres_.spheres().subspan(begin, lattice_.atoms_of_copy())),
          wanted);
      Tally one = tally(
          result.mesh.triangles, lattice_.pitch(), [](std::uint32_t v) { return v; },
          [&](std::uint32_t v) { return result.mesh.positions[v]; });
      if (one.edges != 0) fmt::print("the mesh of copy {} is not closed\n", copy);
      one.vertices = result.mesh.vertex_count();
      mine.add(one);
    }
    return sum_of(ranks_, mine);
  }

  void say_tally(const char* name, double seconds, const Tally& t) const {
    say("  {:<10} {:.3f} s: V {} F {} Euler characteristic {}, {}, volume {:.17g}\n", name, seconds,
        t.vertices, t.triangles,
        static_cast<std::int64_t>(t.vertices) - static_cast<std::int64_t>(t.triangles / 2),
        t.edges == 0 ? "closed and oriented" : "NOT CLOSED", t.volume.nearest());
  }

  void check() {
    if (!piece_) piece_.emplace(mesh_together(ranks_, spheres_, options(), arguments_.backend));
    Tally whole, copies;
    const double first = seconds_of(ranks_, [&] { whole = tally_of_whole(); }).all;
    say_tally("the whole", first, whole);
    piece_.reset();
    const double second = seconds_of(ranks_, [&] { copies = tally_of_copies(); }).all;
    say_tally("the copies", second, copies);
    const bool equal = whole.edges == 0 && copies.edges == 0 && whole.vertices == copies.vertices &&
                       whole.triangles == copies.triangles &&
                       whole.volume.nearest() == copies.volume.nearest();
    ranks_.together([&] {
      if (ranks_.is_first() && !equal)
        throw InternalError("a mesh is not closed, or the copies are not the whole");
    });
    say("  the copies add up to the whole\n");
  }

  const Ranks& ranks_;
  const Arguments& arguments_;
  Lattice lattice_;
  HostArray<Sphere> of_spheres_;
  SphereSet spheres_;
  std::optional<SurfacePiece> piece_;
  ExtractResult extracted_;
};

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  using namespace vdwmesh;
  const Ranks ranks(argc, argv);
  apps::keep_freed_memory();
  try {
    Arguments arguments = read_arguments(argc, argv);
    if (arguments.threads == 0) arguments.threads = static_cast<int>(usable_processors());
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(arguments.threads));
    Bench(ranks, arguments).run();
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ranks_bench: %s\n", error.what());
    if (!ranks.all_failed()) ranks.abort(EXIT_FAILURE);
    return EXIT_FAILURE;
  }
}
