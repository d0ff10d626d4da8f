// lay_out_vtkhdf(): HDF5 makes a scratch file of the same length, which takes no room for arrays
// that nobody has written. It reserves each array in one run of bytes and says where that is. What
// lies between the arrays is then read from the scratch file.
//
// HDF5 does not get the real file. For collective calls its parallel driver sets views of a file,
// with which implementations of MPI have lost bytes (pieces.hpp); and where it cannot close a file,
// because the disk is full, it fails once more when MPI ends, by a segmentation fault (1.10.8).
#include "distributed/files/vtkhdf_layout.hpp"

#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <numeric>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "distributed/files/vtkhdf_file.hpp"

namespace vdwmesh {
namespace {

// What kind of failure HDF5 met at the place where the last one came from.
std::string kind_of_failure() {
  std::array<char, 128> text{};
  const auto keep = [](unsigned place, const H5E_error2_t* error, void* to) -> herr_t {
    auto& first = *static_cast<std::array<char, 128>*>(to);
    if (place == 0) H5Eget_msg(error->min_num, nullptr, first.data(), first.size());
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep, &text);
  return fmt::format("HDF5: {}", text.data());
}

// The reason that the system gave is said if it gave one: HDF5's own words are many lines.
[[noreturn]] void fail() {
  const int error = errno;
  throw FileFormatError(error != 0 ? std::generic_category().message(error) : kind_of_failure());
}

// HDF5 returns negative numbers for failures.
template <class T>
T checked(T result) {
  if (result < 0) fail();
  return result;
}

// An object of HDF5, which is closed at the end of its life.
class Object {
 public:
  using Close = herr_t (*)(hid_t);
  Object(hid_t id, Close close) : id_(checked(id)), close_(close) {}
  ~Object() {
    if (id_ >= 0) close_(id_);
  }
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;

  hid_t id() const { return id_; }
  void close() {
    const hid_t id = id_;
    id_ = H5I_INVALID_HID;
    checked(close_(id));
  }

 private:
  hid_t id_;
  Close close_;
};

// A name for mkstemp() in the folder for temporary files.
std::string scratch_name() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  const char* const wanted = std::getenv("TMPDIR");
  return ((error && wanted ? wanted : folder) / "vdwmesh-XXXXXX").string();
}

// A file of this process. The last six letters of the name are replaced.
class ScratchFile {
 public:
  explicit ScratchFile(std::string& name) {
    descriptor_ = ::mkstemp(name.data());
    name_ = name;
    if (descriptor_ < 0) fail();
  }
  ~ScratchFile() {
    ::close(descriptor_);
    remove_name();
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  const std::string& name() const { return name_; }
  // Nobody needs the name once the file is open; without one it goes with the process.
  void remove_name() {
    if (!name_.empty()) ::unlink(name_.c_str());
    name_.clear();
  }
  void resize(std::uint64_t bytes) {
    if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) fail();
  }
  std::uint64_t size() const {
    const off_t end = ::lseek(descriptor_, 0, SEEK_END);
    if (end < 0) fail();
    return static_cast<std::uint64_t>(end);
  }
  VtkHdfBytes read(std::uint64_t begin, std::uint64_t end) const {
    VtkHdfBytes part{begin, std::vector<char>(end - begin)};
    const ssize_t got =
        ::pread(descriptor_, part.bytes.data(), part.bytes.size(), static_cast<off_t>(begin));
    if (got < 0 || static_cast<std::uint64_t>(got) != end - begin) fail();
    return part;
  }

 private:
  std::string name_;
  int descriptor_ = -1;
};

Object make_file(const std::string& name) {
  return {H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose};
}

Object make_group(const Object& parent, const char* name) {
  return {H5Gcreate2(parent.id(), name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose};
}

// No times are kept, so that the same mesh gives the same bytes.
Object make_array(const Object& group, const char* name, hid_t type,
                  const std::vector<hsize_t>& extents) {
  const Object space(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr),
                     H5Sclose);
  const Object creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  checked(H5Pset_layout(creation.id(), H5D_CONTIGUOUS));
  checked(H5Pset_alloc_time(creation.id(), H5D_ALLOC_TIME_EARLY));
  checked(H5Pset_fill_time(creation.id(), H5D_FILL_TIME_NEVER));
  checked(H5Pset_obj_track_times(creation.id(), 0));
  return {H5Dcreate2(group.id(), name, type, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
          H5Dclose};
}

// VTK keeps a number for each part of a grid. There is one part.
void write_count(const Object& group, const char* name, std::uint64_t count) {
  const Object array = make_array(group, name, H5T_NATIVE_INT64, {1});
  checked(H5Dwrite(array.id(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &count));
}

void write_attributes(const Object& group) {
  const std::array<std::int64_t, 2> version{1, 0};
  constexpr std::string_view kType = "UnstructuredGrid";
  const hsize_t numbers = version.size();
  const Object pair(H5Screate_simple(1, &numbers, nullptr), H5Sclose);
  const Object of_version(
      H5Acreate2(group.id(), "Version", H5T_NATIVE_INT64, pair.id(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  checked(H5Awrite(of_version.id(), H5T_NATIVE_INT64, version.data()));
  const Object letters(H5Tcopy(H5T_C_S1), H5Tclose);
  checked(H5Tset_size(letters.id(), kType.size()));
  checked(H5Tset_strpad(letters.id(), H5T_STR_NULLPAD));
  const Object one(H5Screate(H5S_SCALAR), H5Sclose);
  const Object of_type(
      H5Acreate2(group.id(), "Type", letters.id(), one.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  checked(H5Awrite(of_type.id(), letters.id(), kType.data()));
}

// Makes the arrays that the ranks fill, and keeps account of where they are.
class Arrays {
 public:
  std::uint64_t reserve(const Object& group, const char* name, hid_t type,
                        const std::vector<hsize_t>& extents) {
    const Object array = make_array(group, name, type, extents);
    const haddr_t place = H5Dget_offset(array.id());
    if (place == HADDR_UNDEF) fail();
    const hsize_t bytes = std::accumulate(extents.begin(), extents.end(),
                                          hsize_t{H5Tget_size(type)}, std::multiplies<>());
    runs_.emplace_back(place, place + bytes);
    return place;
  }

  // What the file has before, between and behind them.
  std::vector<VtkHdfBytes> read_around(const ScratchFile& file) {
    std::ranges::sort(runs_);
    runs_.emplace_back(file.size(), file.size());
    std::vector<VtkHdfBytes> around;
    std::uint64_t done = 0;
    for (const auto& [begin, end] : runs_) {
      if (begin > done) around.push_back(file.read(done, begin));
      done = end;
    }
    return around;
  }

 private:
  std::vector<std::pair<std::uint64_t, std::uint64_t>> runs_;  // [first byte, byte behind)
};

VtkHdfPlaces fill(const Object& file, const MeshSize& size, Arrays& arrays) {
  const auto& [vertices, triangles] = size;
  const Object root = make_group(file, "VTKHDF");
  write_attributes(root);
  write_count(root, "NumberOfPoints", vertices);
  write_count(root, "NumberOfCells", triangles);
  write_count(root, "NumberOfConnectivityIds", 3 * triangles);
  const Object of_points = make_group(root, "PointData");
  VtkHdfPlaces places;
  places.points = arrays.reserve(root, "Points", H5T_NATIVE_DOUBLE, {vertices, 3});
  places.normals = arrays.reserve(of_points, "Normals", H5T_NATIVE_FLOAT, {vertices, 3});
  places.colors = arrays.reserve(of_points, "RGB", H5T_NATIVE_UINT8, {vertices, 3});
  places.atoms = arrays.reserve(of_points, "atom", H5T_NATIVE_INT32, {vertices});
  places.connectivity = arrays.reserve(root, "Connectivity", H5T_NATIVE_INT64, {3 * triangles});
  places.offsets = arrays.reserve(root, "Offsets", H5T_NATIVE_INT64, {triangles + 1});
  places.types = arrays.reserve(root, "Types", H5T_NATIVE_UINT8, {triangles});
  return places;
}

// The length of the file, or somewhat more.
std::uint64_t most_bytes(const MeshSize& size) {
  constexpr std::uint64_t kAround = 1 << 20, kOfVertex = 24 + 12 + 3 + 4, kOfTriangle = 24 + 8 + 1;
  return kAround + kOfVertex * size.vertices + kOfTriangle * size.triangles;
}

// The file that is laid out is the scratch file with this name.
VtkHdfLayout lay_out(const MeshSize& size, std::string& name) {
  errno = 0;
  ScratchFile scratch(name);
  scratch.resize(most_bytes(size));  // fails here, if at all, where a limit forbids so long a file
  Object file = make_file(scratch.name());
  scratch.remove_name();
  Arrays arrays;
  VtkHdfLayout layout;
  layout.places = fill(file, size, arrays);
  file.close();
  layout.around = arrays.read_around(scratch);
  return layout;
}

}  // namespace

bool has_vtkhdf() { return true; }

VtkHdfLayout lay_out_vtkhdf(const MeshSize& size) {
  H5dont_atexit();  // HDF5 would clear up once more when MPI has ended already
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // nothing but our one line is printed
  std::string name = scratch_name();
  try {
    return lay_out(size, name);
  } catch (const FileFormatError& error) {
    throw FileFormatError(
        fmt::format("the scratch file {} cannot be written: {}; TMPDIR names another folder for it",
                    name, error.what()));
  }
}

}  // namespace vdwmesh
