// Derivatives of the exact measures for Python, apart from those that come with the measures: along
// a motion, and all of them as a sparse matrix.
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "call.hpp"
#include "measures/union_gradients.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

// Rows of two numbers (N, 2): by how much each area and volume changes.
Array union_rates(const py::buffer& coords, const py::buffer& radii, const py::object& move,
                  const py::object& growth, double probe, std::optional<int> threads) {
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  std::vector<Vec3d> moves;
  if (!move.is_none()) moves = points_of(Numbers(move.cast<py::buffer>(), "move", 2));
  const std::vector<double> growths = numbers_of(growth, "growth");
  const auto rates =
      std::make_shared<const std::vector<SphereMeasures>>(call(threads, [&](Monitor& monitor) {
        return measure_rates(spheres_of(centers, sizes, probe), moves, growths, &monitor);
      }));
  static_assert(sizeof(SphereMeasures) == 2 * sizeof(double));
  return array_of(rates, reinterpret_cast<const double*>(rates->data()), rates->size(), 2);
}

// Where rows begin, the columns, and rows of eight numbers for the entries.
py::tuple jacobian(const py::buffer& coords, const py::buffer& radii, double probe,
                   std::optional<int> threads) {
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  const auto found = std::make_shared<const UnionJacobian>(call(threads, [&](Monitor& monitor) {
    return union_jacobian(spheres_of(centers, sizes, probe), &monitor);
  }));
  const auto* const entries = reinterpret_cast<const double*>(found->blocks.data());
  return py::make_tuple(array_of(found, found->first.data(), found->first.size()),
                        array_of(found, found->columns.data(), found->columns.size()),
                        array_of(found, entries, found->blocks.size(), 8));
}

}  // namespace

void bind_gradients(py::module_& module) {
  module.def("union_rates", &union_rates);
  module.def("union_jacobian", &jacobian);
}

}  // namespace vdwmesh::python
