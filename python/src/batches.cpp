// Exact measures of many structures for Python. A BatchRun keeps the source of the structures and
// hands out rows in chunks, each measured on all cores without the GIL.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "batch/batch.hpp"
#include "call.hpp"
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

}  // namespace

void bind_batches(py::module_& module) {
  py::class_<BatchRun>(module, "BatchRun")
      .def(py::init<const std::vector<std::filesystem::path>&, std::uint64_t, std::uint64_t,
                    const py::kwargs&>())
      .def("next", &BatchRun::next);
}

}  // namespace vdwmesh::python
