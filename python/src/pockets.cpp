// Pockets for Python: a dictionary for each, by falling volume. The classes that users see are made
// of them in _pockets.py.
#include "pockets/pockets.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "call.hpp"
#include "core/errors.hpp"
#include "measures/many_unions.hpp"
#include "pockets/pocket_tracks.hpp"
#include "requests.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

using namespace py::literals;

py::tuple place_of(const Vec3d& v) { return py::make_tuple(v.x, v.y, v.z); }

// Where only sums were taken, there is no exact figure.
std::optional<double> if_exact(PocketMeasures measures, double figure) {
  return measures == PocketMeasures::exact ? std::optional(figure) : std::nullopt;
}

py::tuple mouths_of(const Pocket& pocket, PocketMeasures measures) {
  py::list mouths;
  for (const Mouth& m : pocket.mouths) {
    mouths.append(py::dict("area"_a = if_exact(measures, m.area),
                           "rim"_a = if_exact(measures, m.rim), "area_sum"_a = m.area_sum,
                           "rim_sum"_a = m.rim_sum, "center"_a = place_of(m.center),
                           "faces"_a = m.faces));
  }
  return py::tuple(mouths);
}

py::dict dict_of(const Pocket& p, double probe, PocketMeasures measures) {
  py::list atoms, areas;
  for (const LiningSphere& s : p.lining) {
    atoms.append(s.id);
    areas.append(s.area);
  }
  const auto grown = [&](std::optional<double> clearance) {
    return clearance ? std::optional(*clearance + probe) : std::nullopt;
  };
  return py::dict(
      "kind"_a = std::string(kind_name(p.kind)), "volume"_a = if_exact(measures, p.volume),
      "area"_a = if_exact(measures, p.area), "volume_sum"_a = p.volume_sum,
      "area_sum"_a = p.area_sum, "mouths"_a = mouths_of(p, measures), "lining"_a = py::tuple(atoms),
      "lining_areas"_a = py::tuple(areas), "atoms"_a = p.spheres, "tetrahedra"_a = p.tetrahedra,
      "sinks"_a = p.sinks, "depth_alpha"_a = p.depth_alpha,
      "bottleneck_alpha"_a = p.bottleneck_alpha, "center"_a = place_of(p.clear_place),
      "depth_probe"_a = grown(p.clearance), "bottleneck_radius"_a = grown(p.bottleneck_clearance),
      "margin"_a = probe_margin(p));
}

PocketMeasures measures_of(bool exact) {
  return exact ? PocketMeasures::exact : PocketMeasures::sums;
}

py::list list_of(const PocketTable& table, double probe, PocketMeasures measures) {
  py::list list;
  for (const Pocket& pocket : table.pockets) list.append(dict_of(pocket, probe, measures));
  return list;
}

// The pockets as dictionaries, and the number of ties.
py::tuple pockets_of(const py::buffer& coords, const py::buffer& radii, double probe, bool exact,
                     std::optional<int> threads) {
  const PocketMeasures measures = measures_of(exact);
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  const PocketTable table = call(threads, [&](Monitor& monitor) {
    return pockets(spheres_of(centers, sizes, probe), {.measures = measures, .monitor = &monitor});
  });
  return py::make_tuple(list_of(table, probe, measures), table.face_ties);
}

// The pockets of frames that come in chunks, followed from one to the next.
class PocketRun {
 public:
  PocketRun(const py::buffer& radii, std::size_t atoms, double probe, bool exact, double overlap,
            std::uint64_t patience, std::optional<int> threads)
      : radii_(grown_radii(Numbers(radii, "radii", 1), atoms, probe)),
        probe_(probe),
        measures_(measures_of(exact)),
        tracker_({.least_overlap = overlap, .patience = patience}),
        threads_(threads) {}

  // For each frame its pockets, their tracks, their overlaps with these, and the ties; and why the
  // next frame has none, if one was refused. Coordinates of 1 stand for `unit`, Å.
  py::tuple next(const py::buffer& coords, double unit) {
    const Numbers places(coords, "traj", 3);
    std::vector<std::string> refused(places.size(0));
    const std::vector<PocketTable> tables =
        call(threads_, [&](Monitor& monitor) { return find(places, unit, refused, monitor); });
    py::list frames;
    for (std::size_t t = 0; t < tables.size(); ++t) {
      if (!refused[t].empty()) return py::make_tuple(frames, refused[t]);
      py::list tracks, overlaps;
      for (const TrackStep& step : tracker_.follow(tables[t].pockets)) {
        tracks.append(step.track);
        overlaps.append(step.overlap);
      }
      frames.append(py::make_tuple(list_of(tables[t], probe_, measures_), tracks, overlaps,
                                   tables[t].face_ties));
    }
    return py::make_tuple(frames, py::none());
  }

 private:
  // Frames are worked on side by side.
  std::vector<PocketTable> find(const Numbers& places, double unit,
                                std::vector<std::string>& refused, Monitor& monitor) const {
    struct NoSpace {};
    std::vector<PocketTable> tables(places.size(0));
    for_each_union<NoSpace>(tables.size(), &monitor, [&](std::size_t t, NoSpace&, Monitor* inside) {
      try {
        std::vector<Sphere> balls;
        for (std::size_t i = 0; i < radii_.size(); ++i) {
          const auto at = [&](std::size_t axis) { return unit * places(t, i, axis); };
          balls.push_back({{at(0), at(1), at(2)}, radii_[i]});
        }
        tables[t] =
            pockets(SphereSet(std::move(balls)), {.measures = measures_, .monitor = inside});
      } catch (const InvalidInput& error) {
        refused[t] = error.what();
      }
    });
    return tables;
  }

  std::vector<double> radii_;
  double probe_;
  PocketMeasures measures_;
  PocketTracker tracker_;
  std::optional<int> threads_;
};

}  // namespace

void bind_pockets(py::module_& module) {
  module.def("pockets", &pockets_of);
  py::class_<PocketRun>(module, "PocketRun")
      .def(py::init<const py::buffer&, std::size_t, double, bool, double, std::uint64_t,
                    std::optional<int>>())
      .def("next", &PocketRun::next);
}

}  // namespace vdwmesh::python
