// Chooses the reader or writer of a mesh file by its format and connects it with the file system.
// Writers write into a ByteSink: an OutputFile, or a StringSink for encode_mesh(). Readers get the
// whole file as one string_view. formats.hpp declares one reader and one writer per format.
#include "mesh/mesh_io.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <system_error>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/large_pages.hpp"
#include "core/letters.hpp"
#include "mesh/formats/formats.hpp"
#include "surface/triangle_check.hpp"

namespace vdwmesh {
namespace {

namespace fs = std::filesystem;

bool is_finite(const Vec3d& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// Throws unless the mesh is as the writers of formats.hpp may assume. The loop in parallel only
// finds whether all is well; the message names the first bad vertex, for any number of threads.
void check_writable(const formats::MeshView& view) {
  const IndexedMesh& mesh = view.mesh;
  check_array_sizes(mesh);
  check_triangles(mesh.triangles, mesh.vertex_count());
  if (view.patches) check_patches(*view.patches);
  const std::size_t colors = view.sphere_colors.size();
  const bool has_atoms = colors > 0 && !mesh.vertex_spheres.empty();
  const auto atom_of = [&](std::size_t v) {
    return has_atoms ? mesh.vertex_spheres.atoms[v] : kNoSphere;
  };
  if (!(view.scale > 0 && std::isfinite(view.scale)))
    throw InvalidInput(fmt::format("a scale of {}; needs a finite number above 0", view.scale));
  const auto is_good = [&](std::size_t v) {
    return is_finite(view.position(v)) && (atom_of(v) == kNoSphere || atom_of(v) < colors);
  };
  std::atomic<bool> all_good = true;
  for_each_index(mesh.vertex_count(), [&](std::size_t v) {
    if (!is_good(v)) all_good = false;
  });
  if (all_good) return;
  std::size_t v = 0;
  while (is_good(v)) ++v;
  const Vec3d p = view.position(v);
  if (!is_finite(p)) throw InvalidInput(fmt::format("vertex {} is at {} {} {}", v, p.x, p.y, p.z));
  throw InvalidInput(
      fmt::format("vertex {} lies on sphere {}, but there are {} colours", v, atom_of(v), colors));
}

// The mesh gets the normals of its triangles if the format has normals and the mesh has none.
formats::Warnings write(formats::MeshView view, MeshFormat format, ByteSink& sink) {
  check_writable(view);
  Buffer<Vec3f> normals;
  if (view.mesh.normals.empty() && format != MeshFormat::off && format != MeshFormat::stl &&
      format != MeshFormat::msh && format != MeshFormat::msh4 && format != MeshFormat::three_mf) {
    normals = normals_of_triangles(view.mesh);
  }
  view.normals = normals.empty() ? std::span(view.mesh.normals) : std::span(normals);
  formats::Warnings warnings;
  switch (format) {
    case MeshFormat::ply:
      formats::write_ply(view, sink);
      break;
    case MeshFormat::obj:
      formats::write_obj(view, sink);
      break;
    case MeshFormat::off:
      formats::write_off(view, sink);
      break;
    case MeshFormat::stl:
      formats::write_stl(view, sink, warnings);
      break;
    case MeshFormat::glb:
      formats::write_glb(view, sink, warnings);
      break;
    case MeshFormat::msh:
      formats::write_msh(view, sink);
      break;
    case MeshFormat::msh4:
      formats::write_msh4(view, sink);
      break;
    case MeshFormat::vtp:
      formats::write_vtp(view, sink);
      break;
    case MeshFormat::vtu:
      formats::write_vtu(view, sink);
      break;
    case MeshFormat::three_mf:
      formats::write_3mf(view, sink);
      break;
  }
  return warnings;
}

std::vector<std::string> write(const formats::MeshView& view, const fs::path& path,
                               const Monitor* monitor) {
  const MeshFormat format = mesh_format(path);
  OutputFile file(path);
  file.watch(monitor);
  std::vector<std::string> warnings = write(view, format, file);
  file.commit();
  return warnings;
}

formats::Warnings write(std::span<const NamedMesh> meshes, MeshFormat format, ByteSink& sink) {
  for (const NamedMesh& m : meshes) check_writable({.mesh = m.mesh});
  formats::Warnings warnings;
  if (format == MeshFormat::glb) {
    formats::write_glb(meshes, sink, warnings);
  } else if (format == MeshFormat::obj) {
    formats::write_obj(meshes, sink);
  } else if (format == MeshFormat::three_mf) {
    formats::write_3mf(meshes, sink);
  } else {
    throw InvalidInput("a file of several meshes is .glb, .obj or .3mf");
  }
  return warnings;
}

// Calls use(view) with a view of a half-edge mesh, which has a colour for each vertex.
template <class Use>
auto with_view(const SurfaceMesh& mesh, const Use& use) {
  const IndexedMesh arrays = to_indexed_mesh(mesh);
  const std::span colors(mesh.vertex_colors(), mesh.n_vertices());
  std::vector<RgbColor> copied;
  copied.reserve(colors.size());
  for (const SurfaceMesh::Color& c : colors) copied.push_back({c[0], c[1], c[2]});
  return use(formats::MeshView{.mesh = arrays, .vertex_colors = copied});
}

// A file open for reading. The destructor closes it, also after an exception.
class OpenFile {
 public:
  explicit OpenFile(const fs::path& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int descriptor() const { return descriptor_; }  // negative if open() failed; errno says why

 private:
  int descriptor_;
};

// A whole file in memory. A copy is safer than a mapping of the file: another process cannot change
// it while a reader, which has checked sizes and counts, works on it.
class FileBytes {
 public:
  explicit FileBytes(const fs::path& path) {
    const OpenFile file(path);
    if (file.descriptor() < 0) fail();
    struct stat status {};
    if (::fstat(file.descriptor(), &status) != 0) fail();
    if (!S_ISREG(status.st_mode)) throw FileFormatError("is not a regular file");
    bytes_.resize(static_cast<std::size_t>(status.st_size));
    advise_large_pages(bytes_.data(), bytes_.size());
    read_all(file.descriptor());
  }
  std::string_view view() const { return {bytes_.data(), bytes_.size()}; }

 private:
  // Fills bytes_. Throws if the file is shorter than its size was, which happens if another process
  // writes it at the same time.
  void read_all(int descriptor) {
    std::size_t size = 0;
    while (size < bytes_.size()) {
      const ssize_t got = ::read(descriptor, bytes_.data() + size, bytes_.size() - size);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail();
      if (got == 0) break;
      size += static_cast<std::size_t>(got);
    }
    if (size != bytes_.size()) {
      throw FileFormatError(fmt::format(
          "gave {} bytes where its size is {}: it changed while being read, so try again", size,
          bytes_.size()));
    }
  }
  // Reports errno. read_mesh() completes the message with the name of the file.
  [[noreturn]] static void fail() {
    throw FileFormatError("cannot be read: " + std::generic_category().message(errno));
  }

  Buffer<char> bytes_;
};

}  // namespace

std::optional<MeshFormat> find_mesh_format(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".ply") return MeshFormat::ply;
  if (extension == ".obj") return MeshFormat::obj;
  if (extension == ".off") return MeshFormat::off;
  if (extension == ".stl") return MeshFormat::stl;
  if (extension == ".glb") return MeshFormat::glb;
  if (extension == ".msh" || extension == ".msh2") return MeshFormat::msh;
  if (extension == ".msh4") return MeshFormat::msh4;
  if (extension == ".vtp") return MeshFormat::vtp;
  if (extension == ".vtu") return MeshFormat::vtu;
  if (extension == ".3mf") return MeshFormat::three_mf;
  return std::nullopt;
}

MeshFormat mesh_format(const fs::path& path) {
  if (const auto format = find_mesh_format(path)) return *format;
  throw InvalidInput(fmt::format(
      "{}: the name of a mesh file ends in .ply .obj .off .stl .glb .msh .msh4 .vtp .vtu or .3mf",
      path.string()));
}

std::vector<std::string> write_mesh(const IndexedMesh& mesh, const fs::path& path,
                                    std::span<const RgbColor> sphere_colors, const Monitor* monitor,
                                    MeshEncoding encoding, double scale) {
  return write({.mesh = mesh, .sphere_colors = sphere_colors, .encoding = encoding, .scale = scale},
               path, monitor);
}

std::vector<std::string> write_mesh(const PatchedMesh& mesh, const fs::path& path,
                                    std::span<const RgbColor> sphere_colors, const Monitor* monitor,
                                    MeshEncoding encoding, double scale) {
  return write({.mesh = mesh.mesh,
                .sphere_colors = sphere_colors,
                .patches = &mesh,
                .encoding = encoding,
                .scale = scale},
               path, monitor);
}

bool holds_several_meshes(MeshFormat format) {
  return format == MeshFormat::glb || format == MeshFormat::obj || format == MeshFormat::three_mf;
}

std::vector<std::string> write_meshes(std::span<const NamedMesh> meshes, const fs::path& path,
                                      const Monitor* monitor) {
  const MeshFormat format = mesh_format(path);
  OutputFile file(path);
  file.watch(monitor);
  std::vector<std::string> warnings = write(meshes, format, file);
  file.commit();
  return warnings;
}

std::vector<std::string> write_mesh(const SurfaceMesh& mesh, const fs::path& path,
                                    const Monitor* monitor) {
  return with_view(mesh, [&](const auto& view) { return write(view, path, monitor); });
}

EncodedMesh encode_mesh(const IndexedMesh& mesh, MeshFormat format, MeshEncoding encoding) {
  StringSink sink;
  formats::Warnings warnings = write({.mesh = mesh, .encoding = encoding}, format, sink);
  return {std::move(sink).take(), std::move(warnings)};
}

EncodedMesh encode_meshes(std::span<const NamedMesh> meshes, MeshFormat format) {
  StringSink sink;
  formats::Warnings warnings = write(meshes, format, sink);
  return {std::move(sink).take(), std::move(warnings)};
}

EncodedMesh encode_mesh(const SurfaceMesh& mesh, MeshFormat format) {
  return with_view(mesh, [&](const auto& view) {
    StringSink sink;
    formats::Warnings warnings = write(view, format, sink);
    return EncodedMesh{std::move(sink).take(), std::move(warnings)};
  });
}

MeshFile read_mesh(const fs::path& path, std::uint64_t memory_limit) {
  const MeshFormat format = mesh_format(path);
  try {
    return decode_mesh(FileBytes(path).view(), format, memory_limit);
  } catch (const FileFormatError& error) {
    throw FileFormatError(fmt::format("{}: {}", path.string(), error.what()));
  } catch (const LimitExceeded& error) {
    throw LimitExceeded(fmt::format("{}: {}", path.string(), error.what()));
  }
}

MeshFile decode_mesh(std::string_view bytes, MeshFormat format, std::uint64_t memory_limit) {
  switch (format) {
    case MeshFormat::ply:
      return formats::read_ply(bytes);
    case MeshFormat::obj:
      return formats::read_obj(bytes);
    case MeshFormat::off:
      return formats::read_off(bytes);
    case MeshFormat::stl:
      return formats::read_stl(bytes);
    case MeshFormat::glb:
      return formats::read_glb(bytes, memory_limit);
    case MeshFormat::msh:
    case MeshFormat::msh4:
    case MeshFormat::vtp:
    case MeshFormat::vtu:
    case MeshFormat::three_mf:
      throw InvalidInput(
          ".msh .msh4 .vtp .vtu and .3mf are written here and not read; .ply .stl .obj .off .glb "
          "are");
  }
  throw InvalidInput("no such mesh format");
}

}  // namespace vdwmesh
