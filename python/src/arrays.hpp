// Arrays that cross the border between Python and C++, both ways by the buffer protocol (PEP 3118).
//
// NumPy's own C interface differs between NumPy 1 and 2; the buffer protocol does not, so one build
// of the module serves both. Arrays that come in are read where they lie. Arrays that go out belong
// to C++ objects: an `Array` exports memory that it keeps alive, and numpy.asarray(array) is a
// read-only view of it, without a copy, that keeps the Array alive in turn.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::python {

namespace py = pybind11;

// Memory of a C++ object, as Python sees it. Strides are in bytes, and the format is the one of
// Python's module struct. Positive shapes only: an empty array has a shape with a zero.
struct Array {
  std::shared_ptr<const void> owner;  // what the memory belongs to
  const void* data;
  py::ssize_t item_bytes;
  std::string format;
  std::vector<py::ssize_t> shape, strides;
};

// The elements of `values`, with `columns` of them in a row (0: a plain list of elements). Element
// types are double, float and integers.
template <class T>
Array array_of(std::shared_ptr<const void> owner, const T* values, std::size_t rows,
               std::size_t columns = 0, std::size_t row_bytes = 0) {
  const auto item = static_cast<py::ssize_t>(sizeof(T));
  const auto wide = static_cast<py::ssize_t>(columns);
  const auto row =
      row_bytes > 0 ? static_cast<py::ssize_t>(row_bytes) : item * (columns > 0 ? wide : 1);
  Array array{std::move(owner), values, item, py::format_descriptor<T>::format(), {}, {}};
  array.shape.push_back(static_cast<py::ssize_t>(rows));
  array.strides.push_back(row);
  if (columns > 0) {
    array.shape.push_back(wide);
    array.strides.push_back(item);
  }
  return array;
}

// The same for a list that nothing else needs.
template <class List>
Array array_of(List&& list) {
  auto owner = std::make_shared<const std::decay_t<List>>(std::forward<List>(list));
  const auto* values = owner->data();
  const std::size_t rows = owner->size();
  return array_of(std::move(owner), values, rows);
}

// An array of strings, as NumPy's "<U4": fixed width, padded with zeros, one code point of four
// bytes for a character. Texts are UTF-8; other bytes are read as text_of() reads them.
Array array_of_text(const std::vector<std::string_view>& texts);

// Numbers, float32 or float64, of an array of Python. `name` is the argument's, for messages.
class Numbers {
 public:
  // Throws InvalidInput for an array of other numbers or of other than `dimensions` dimensions. The
  // Python layer brings everything else into such a form. Holds the array until it is destroyed,
  // which needs the GIL.
  Numbers(const py::buffer& array, const char* name, std::size_t dimensions);

  const char* name() const { return name_; }
  std::size_t size(std::size_t dimension) const {
    return static_cast<std::size_t>(info_.shape[dimension]);
  }
  bool is_float32() const { return is_float32_; }
  const std::byte* bytes() const { return static_cast<const std::byte*>(info_.ptr); }
  const std::vector<py::ssize_t>& strides() const { return info_.strides; }
  // Needs no GIL. As many indices as the array has dimensions, all in range.
  template <class... Indices>
  double operator()(Indices... indices) const {
    std::ptrdiff_t offset = 0;
    std::size_t dimension = 0;
    ((offset += static_cast<std::ptrdiff_t>(indices) * info_.strides[dimension++]), ...);
    return at(bytes() + offset);
  }

 private:
  double at(const std::byte* place) const;

  const char* name_;
  py::buffer_info info_;
  bool is_float32_;
};

// The numbers of an array of one dimension; none if it is None.
std::vector<double> numbers_of(const py::object& array, const char* name);
// Points (Å) from an array of shape (N, 3). Throws InvalidInput that names the argument and the row
// for a number that is not finite, and for no rows at all.
std::vector<Vec3d> points_of(const Numbers& rows);
// The balls of centres (N, 3) and radii (N,), grown by the probe, all in Å. Throws InvalidInput
// that names the argument and the ball: different lengths, numbers that are not finite, a radius
// below 0, a radius that is not above 0 with the probe.
SphereSet spheres_of(const Numbers& centers, const Numbers& radii, double probe);
// The radii of so many atoms, grown by the probe, with the same checks of them.
std::vector<double> grown_radii(const Numbers& radii, std::size_t atoms, double probe);

// Ids from an array of unsigned 32-bit integers of one dimension, which the Python layer makes.
std::vector<SphereId> ids_of(const py::buffer& array);

void bind_arrays(py::module_& module);

}  // namespace vdwmesh::python
