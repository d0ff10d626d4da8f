// Exact measures of many structures for Python: of files, and of sets of balls that stand one after
// another in arrays. A BatchRun keeps the source of the files and hands out rows in chunks, each
// measured on all cores without the GIL.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "arrays.hpp"
#include "batch/batch.hpp"
#include "call.hpp"
#include "cuda/backend.hpp"
#include "cuda_array.hpp"
#include "errors.hpp"
#include "requests.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

namespace py = pybind11;
using namespace py::literals;

py::dict dict_of(const BatchRow& row) {
  py::object method = py::none();
  if (row.method) method = py::cast(name_of(*row.method));
  py::object error = py::none();
  if (row.error) error = message_of(*row.error);
  return py::dict(
      "name"_a = text_of(row.name), "atoms"_a = row.atoms, "left_out"_a = row.left_out,
      "assumed_radii"_a = row.assumed_radii, "guessed_elements"_a = row.guessed_elements,
      "method"_a = method, "area"_a = row.area, "volume"_a = row.volume,
      "components"_a = row.components, "tunnels"_a = row.tunnels, "voids"_a = row.voids,
      "euler_characteristic"_a = row.euler_characteristic,
      "fallback_atoms"_a = row.fallback_spheres, "doubtful_atoms"_a = row.doubtful_spheres,
      "warnings"_a = messages_of(row.warnings), "error"_a = error);
}

class BatchRun {
 public:
  // Part `part` of `parts`, from 0. Does not count the structures if there is one part.
  BatchRun(const std::vector<std::filesystem::path>& inputs, std::uint64_t part,
           std::uint64_t parts, const py::kwargs& given)
      : threads_(given["threads"].cast<std::optional<int>>()) {
    options_.read = read_options_of(given);
    const ExactOptions exact = exact_options_of(given);
    options_.probe = exact.probe;
    options_.method = exact.method;
    options_.topology = exact.topology;
    const SourceOptions of_source{.format = options_.read.format};
    call(threads_, [&](Monitor&) {
      source_ = open_structures(inputs, of_source);
      if (parts == 1) return 0;
      const BatchPart own = part_of(part, parts, count_structures(inputs, of_source));
      for (std::uint64_t i = 0; i < own.first; ++i) source_->next(StructureSource::Content::skip);
      left_ = own.count;
      return 0;
    });
  }

  // The rows of the next structures, up to `most` of them; none behind the last.
  py::list next(std::uint64_t most) {
    std::vector<BatchRow> rows;
    call(threads_, [&](Monitor& monitor) {
      BatchOptions options = options_;
      options.monitor = options.read.monitor = &monitor;
      return run_batch(*source_, std::min(most, left_), options,
                       [&](const BatchRow& row) { rows.push_back(row); });
    });
    left_ -= rows.size();
    py::list found;
    for (const BatchRow& row : rows) found.append(dict_of(row));
    return found;
  }

 private:
  BatchOptions options_;
  std::optional<int> threads_;
  std::unique_ptr<StructureSource> source_;
  std::uint64_t left_ = ~std::uint64_t{0};  // structures of the part
};

// A column of rows that `owner` keeps alive.
template <class Row>
Array column_of(const std::shared_ptr<const BatchGradients>& owner, const std::vector<Row>& rows,
                const double& first, std::size_t columns = 0) {
  return array_of(owner, &first, rows.size(), columns, sizeof(Row));
}

// Areas and volumes of the sets and of the atoms; and, if asked for, the derivatives by the atoms
// (N, 8) and how many atoms of each set may have none.
py::dict dict_of(BatchGradients&& result, bool gradient) {
  const auto kept = std::make_shared<const BatchGradients>(std::move(result));
  const std::vector<SphereMeasures>&totals = kept->measures.totals,
        &atoms = kept->measures.per_sphere;
  py::object slopes = py::none();
  if (gradient) {
    slopes = py::make_tuple(column_of(kept, kept->per_sphere, kept->per_sphere[0].area_center.x, 8),
                            kept->kink_spheres);
  }
  return py::dict("area"_a = column_of(kept, totals, totals[0].area),
                  "volume"_a = column_of(kept, totals, totals[0].volume),
                  "atom_area"_a = column_of(kept, atoms, atoms[0].area),
                  "atom_volume"_a = column_of(kept, atoms, atoms[0].volume),
                  "fallback_atoms"_a = kept->measures.fallback_spheres, "gradient"_a = slopes);
}

// The device's measurer for so many atoms, where it pays or is asked for, or the CPU's.
std::unique_ptr<UnionMeasurer> measurer_for(const std::string& device, std::size_t atoms) {
  const Backend asked = backend_of(device);
  const bool pays = asked == Backend::cuda || atoms >= kBallsWorthADevice;
  return make_union_measurer(pays ? asked : Backend::cpu);
}

// Sets of the balls (N, 3), of which set i begins at offsets[i].
py::dict measure_many(const py::buffer& coords, const py::buffer& radii,
                      const std::vector<std::size_t>& offsets, const py::object& area_weights,
                      const py::object& volume_weights, bool gradient, double probe,
                      std::optional<int> threads, const std::string& device) {
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  const std::vector<double> areas = numbers_of(area_weights, "weights"),
                            volumes = numbers_of(volume_weights, "weights");
  BatchGradients result;
  call(threads, [&](Monitor& monitor) {
    const SphereSet balls = spheres_of(centers, sizes, probe);
    SphereBatch batch = batch_of(balls);
    batch.offsets = offsets;
    const auto measurer = measurer_for(device, batch.size);
    if (gradient) {
      measurer->gradients_into(result, batch,
                               {.area = areas.empty() ? nullptr : areas.data(),
                                .volume = volumes.empty() ? nullptr : volumes.data()},
                               &monitor);
    } else {
      measurer->measure_into(result.measures, batch, &monitor);
    }
    return 0;
  });
  return dict_of(std::move(result), gradient);
}

// The same for coordinates in device memory, where "atoms_there" and "slopes_there" are left too.
py::dict measure_many_there(const py::tuple& coords, const py::object& radii,
                            const std::vector<std::size_t>& offsets, const py::object& area_weights,
                            const py::object& volume_weights, bool gradient, double probe,
                            std::optional<int> threads) {
  const DeviceFrames balls = frames_of(coords, radii, 1, probe);
  require_valid(balls);
  const DeviceWeights weights(coords, area_weights, volume_weights, balls.atoms());
  BatchGradients result;
  const auto there = call(threads, [&](Monitor& monitor) {
    return std::make_shared<const CudaMeasures>(
        sets_on_device(result.measures, result.kink_spheres, balls, offsets,
                       gradient ? &weights.batch() : nullptr, &monitor));
  });
  const std::vector<std::size_t> shape{balls.atoms()};
  py::object slopes = py::none();
  if (gradient) slopes = slopes_there(there, shape, result.kink_spheres);
  py::dict found = dict_of(std::move(result), false);
  found["atoms_there"] = measures_there(there, shape);
  found["slopes_there"] = slopes;
  return found;
}

}  // namespace

void bind_batches(py::module_& module) {
  py::class_<BatchRun>(module, "BatchRun")
      .def(py::init<const std::vector<std::filesystem::path>&, std::uint64_t, std::uint64_t,
                    const py::kwargs&>())
      .def("next", &BatchRun::next);
  module.def("measure_many", &measure_many);
  module.def("measure_many_on_device", &measure_many_there);
}

}  // namespace vdwmesh::python
