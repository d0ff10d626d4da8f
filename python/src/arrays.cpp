// Reads arrays of Python and exports arrays of C++ (arrays.hpp). Checks name the argument and the
// first element that is wrong, because callers see nothing of what lies between.
#include "arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/errors.hpp"
#include "errors.hpp"
#include "spheres/check_sphere.hpp"

namespace vdwmesh::python {
namespace {

// What an empty array points to: NumPy takes no null pointer for memory.
constexpr double kNothing = 0;

bool is_finite(const Vec3d& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

[[noreturn]] void throw_not_finite(const std::string& where, const Vec3d& p) {
  throw InvalidInput(fmt::format("{}: ({}, {}, {}) is not finite; coordinates are in angstrom",
                                 where, p.x, p.y, p.z));
}

// The format without the mark for native byte order, which NumPy puts before elements that are not
// aligned. The Python layer has brought other orders into the native one.
std::string without_order(const std::string& format) {
  const bool has_mark = format.starts_with('=') || format.starts_with('@');
  return format.substr(has_mark ? 1 : 0);
}

py::buffer_info exported(const Array& array) {
  const bool is_empty = std::ranges::count(array.shape, 0) > 0;
  const void* data = is_empty ? &kNothing : array.data;
  return {const_cast<void*>(data),
          array.item_bytes,
          array.format,
          static_cast<py::ssize_t>(array.shape.size()),
          array.shape,
          array.strides,
          true};
}

// Writes the code points of a text, of which there are at most as many as bytes.
void put_letters(std::string_view text, char32_t* to) {
  if (std::ranges::all_of(text, [](char c) { return (c & 0x80) == 0; })) {
    std::ranges::copy(text, to);
    return;
  }
  const py::object decoded = text_of(text);
  const Py_ssize_t length = PyUnicode_GetLength(decoded.ptr());
  if (!PyUnicode_AsUCS4(decoded.ptr(), reinterpret_cast<Py_UCS4*>(to), length, 0))
    throw py::error_already_set();
}

}  // namespace

Array array_of_text(const std::vector<std::string_view>& texts) {
  std::size_t width = 1;  // NumPy has no strings of no width
  for (const std::string_view text : texts) width = std::max(width, text.size());
  auto letters = std::make_shared<std::vector<char32_t>>(width * texts.size());
  for (std::size_t i = 0; i < texts.size(); ++i) put_letters(texts[i], &(*letters)[i * width]);
  const auto item = static_cast<py::ssize_t>(width * sizeof(char32_t));
  const void* data = letters->data();
  return {std::move(letters),
          data,
          item,
          fmt::format("{}w", width),
          {static_cast<py::ssize_t>(texts.size())},
          {item}};
}

Numbers::Numbers(const py::buffer& array, const char* name, std::size_t dimensions)
    : name_(name), info_(array.request()) {
  const std::string type = without_order(info_.format);
  is_float32_ = type == "f";
  if (!is_float32_ && type != "d") {
    throw InvalidInput(fmt::format("{}: needs numbers of type float32 or float64", name));
  }
  if (info_.shape.size() != dimensions) {
    throw InvalidInput(
        fmt::format("{}: has {} dimensions, not {}", name, info_.shape.size(), dimensions));
  }
}

// Arrays need not be aligned.
double Numbers::at(const std::byte* place) const {
  if (is_float32_) {
    float value;
    std::memcpy(&value, place, sizeof value);
    return static_cast<double>(value);
  }
  double value;
  std::memcpy(&value, place, sizeof value);
  return value;
}

std::vector<double> numbers_of(const py::object& array, const char* name) {
  std::vector<double> numbers;
  if (array.is_none()) return numbers;
  const Numbers given(array.cast<py::buffer>(), name, 1);
  for (std::size_t i = 0; i < given.size(0); ++i) numbers.push_back(given(i));
  return numbers;
}

std::vector<Vec3d> points_of(const Numbers& rows) {
  if (rows.size(1) != 3) {
    throw InvalidInput(fmt::format("{}: has shape ({}, {}); (N, 3) is needed", rows.name(),
                                   rows.size(0), rows.size(1)));
  }
  if (rows.size(0) == 0) throw InvalidInput(fmt::format("{}: is empty", rows.name()));
  std::vector<Vec3d> points(rows.size(0));
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = {rows(i, 0), rows(i, 1), rows(i, 2)};
    if (!is_finite(points[i])) throw_not_finite(fmt::format("{}[{}]", rows.name(), i), points[i]);
  }
  return points;
}

std::vector<double> grown_radii(const Numbers& radii, std::size_t atoms, double probe) {
  if (!std::isfinite(probe)) throw InvalidInput(fmt::format("probe: {} is not finite", probe));
  if (atoms != radii.size(0)) {
    throw InvalidInput(fmt::format("{}: has {} radii for {} atoms; each atom needs one",
                                   radii.name(), radii.size(0), atoms));
  }
  std::vector<double> grown(atoms);
  for (std::size_t i = 0; i < atoms; ++i) {
    grown[i] = grown_radius(radii(i), probe, radii.name(), i);
  }
  return grown;
}

SphereSet spheres_of(const Numbers& centers, const Numbers& radii, double probe) {
  const std::vector<Vec3d> points = points_of(centers);
  const std::vector<double> grown = grown_radii(radii, points.size(), probe);
  std::vector<Sphere> spheres(points.size());
  for (std::size_t i = 0; i < spheres.size(); ++i) spheres[i] = {points[i], grown[i]};
  return SphereSet(std::move(spheres));
}

std::vector<SphereId> ids_of(const py::buffer& array) {
  const py::buffer_info info = array.request();
  if (info.format != "I" || info.ndim != 1) throw InternalError("ids are not uint32 in a row");
  std::vector<SphereId> ids(static_cast<std::size_t>(info.shape[0]));
  const auto* bytes = static_cast<const std::byte*>(info.ptr);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    std::memcpy(&ids[i], bytes + static_cast<std::ptrdiff_t>(i) * info.strides[0], sizeof ids[i]);
  }
  return ids;
}

void bind_arrays(py::module_& module) {
  py::class_<Array>(module, "Array", py::buffer_protocol()).def_buffer(&exported);
}

}  // namespace vdwmesh::python
