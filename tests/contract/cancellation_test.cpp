// A stage asks its monitor many times whether to stop. Whichever question is answered with yes, it
// ends with Cancelled, and nothing of it is left for the next run.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "analysis/distances.hpp"
#include "analysis/mesh_measures.hpp"
#include "contract/extractor_contract.hpp"
#include "creases/exact_mesher.hpp"
#include "measures/exact_union.hpp"
#include "measures/frame_measures.hpp"
#include "structure/reader.hpp"

namespace vdwmesh::testing {
namespace {

// Says yes to the question of the given number and to all that follow.
class StopAtQuestion : public Monitor {
 public:
  explicit StopAtQuestion(std::int64_t number) : number_(number) {}
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return ++asked_ >= number_; }
  std::int64_t asked() const { return asked_; }

 private:
  std::int64_t number_;
  mutable std::atomic<std::int64_t> asked_{0};
};

// `stage` runs under a monitor and returns what can be compared: a hash, or a figure.
template <class Stage>
void expect_stops_at_every_question(const Stage& stage) {
  StopAtQuestion never(std::numeric_limits<std::int64_t>::max());
  const auto whole = stage(&never);
  ASSERT_GT(never.asked(), 0);
  constexpr std::int64_t kRuns = 60;  // about, however many questions there are
  const std::int64_t step = 1 + never.asked() / kRuns;
  for (std::int64_t k = 1; k <= never.asked(); k += step) {
    StopAtQuestion monitor(k);
    // How many questions there are may depend on how the threads share the work.
    try {
      stage(&monitor);
      EXPECT_LT(monitor.asked(), k) << "question " << k << " was answered with yes";
    } catch (const Cancelled&) {
      EXPECT_GE(monitor.asked(), k);
    }
  }
  EXPECT_EQ(stage(nullptr), whole);
}

class Cancellation : public BackendTest, public ::testing::WithParamInterface<Backend> {
 protected:
  void SetUp() override { need(GetParam()); }
  const SphereSet spheres_ = cluster(12, 1);
};
VDWMESH_INSTANTIATE_BACKENDS(Cancellation);

TEST_P(Cancellation, OfExtractionAndRefinement) {
  for (const FieldKind kind : {FieldKind::vdw, FieldKind::blinn}) {
    expect_stops_at_every_question([&](Monitor* monitor) {
      ExtractOptions extract;
      extract.field.kind = kind;
      extract.grid.spacing = 0.8;
      extract.monitor = monitor;
      RefineOptions refine;
      refine.subdivisions = 2;
      refine.field = extract.field;
      refine.projection = kind == FieldKind::vdw ? Projection::vdw : Projection::field;
      refine.monitor = monitor;
      return hash(make_pipeline(GetParam())->run(spheres_, extract, refine).mesh);
    });
  }
}

TEST(CancellationOnTheCpu, OfTheCreaseExactMesher) {
  const SphereSet spheres = cluster(15, 1);
  expect_stops_at_every_question([&](Monitor* monitor) {
    return hash(mesh_union(spheres, {.edge_length = 0.5, .monitor = monitor}).mesh);
  });
}

TEST(CancellationOnTheCpu, OfTheExactUnion) {
  const SphereSet spheres = cluster(40, 1);
  for (const UnionMethod method : {UnionMethod::cgal, UnionMethod::arcs, UnionMethod::both}) {
    expect_stops_at_every_question([&](Monitor* monitor) {
      return exact_union(spheres, {method, monitor}).area;
    });
  }
}

TEST(CancellationOnTheCpu, OfCertificates) {
  const SphereSet spheres = cluster(40, 1);
  for (const UnionMethod method : {UnionMethod::cgal, UnionMethod::arcs}) {
    expect_stops_at_every_question([&](Monitor* monitor) {
      const UnionOptions options{.method = method, .monitor = monitor, .certify = true};
      return exact_union(spheres, options).certificate->area.lower;
    });
  }
}

// As many atoms as fit several checks, as PDB and as mmCIF.
TEST(CancellationOnTheCpu, OfReading) {
  std::string pdb, cif = "data_X\nloop_\n";
  for (const char* column :
       {"group_PDB", "id", "type_symbol", "label_atom_id", "label_alt_id", "label_comp_id",
        "label_asym_id", "label_seq_id", "Cartn_x", "Cartn_y", "Cartn_z"}) {
    cif += std::string("_atom_site.") + column + "\n";
  }
  for (int i = 0; i < 30'000; ++i) {
    pdb += fmt::format(
        "ATOM  {:5} CA   GLY A{:4}    {:8.3f}{:8.3f}{:8.3f}  1.00  0.00           C  \n",
        i % 100'000, i % 10'000, 0.1 * (i % 1000), 4.0 * (i / 1000), 0.0);
    cif += fmt::format("ATOM {} C CA . GLY A {} {} {} 0\n", i + 1, i, 0.1 * (i % 1000),
                       4.0 * (i / 1000));
  }
  for (const auto& [name, text] : {std::pair("x.pdb", pdb), std::pair("x.cif", cif)}) {
    expect_stops_at_every_question([&, &name = name, &text = text](Monitor* monitor) {
      ReadOptions options;
      options.altloc = "all";
      options.monitor = monitor;
      return read_structure(name, text, options).atoms.size();
    });
  }
}

TEST(CancellationOnTheCpu, OfMeasuresOfFrames) {
  const SphereSet spheres = cluster(30, 1);
  std::vector<double> radii;
  for (const Sphere& s : spheres.spheres()) radii.push_back(s.radius);
  // The same frame six times.
  const FrameCoordinates frames{
      .first = reinterpret_cast<const std::byte*>(&spheres.spheres()[0].center),
      .frames = 6,
      .atoms = spheres.size(),
      .atom_stride = sizeof(Sphere),
      .axis_stride = sizeof(double)};
  for (const TopologyRequest topology : {TopologyRequest::counts, TopologyRequest::full}) {
    expect_stops_at_every_question([&](Monitor* monitor) {
      std::vector<ExactUnion> found;
      measure_frames(found, radii, frames, {{.monitor = monitor, .topology = topology}});
      return found[5].area;
    });
  }
}

TEST(CancellationOnTheCpu, OfDistances) {
  const SphereSet spheres = cluster(20, 1);
  const IndexedMesh mesh = make_extractor(Backend::cpu)->extract(spheres, {}).mesh;
  expect_stops_at_every_question([&](Monitor* monitor) {
    const MeshDistances found = distances(mesh, spheres, {1, 1, kNoMemoryLimit, monitor});
    return found.mesh_to_surface.mean + found.surface_to_mesh.mean;
  });
  expect_stops_at_every_question([&](Monitor* monitor) {
    double sum = 0;
    for (const float distance : vertex_distances(mesh, spheres, monitor)) sum += distance;
    return sum;
  });
}

// Also where every triangle meets every other one, so that nothing but the pairs takes time.
TEST(CancellationOnTheCpu, OfTheSearchForSelfIntersections) {
  IndexedMesh pile = make_extractor(Backend::cpu)->extract(cluster(20, 1), {}).mesh;
  pile.triangles.insert(pile.triangles.end(), 500, pile.triangles.front());
  expect_stops_at_every_question(
      [&](Monitor* monitor) { return self_intersections(pile, monitor); });
}

}  // namespace
}  // namespace vdwmesh::testing
