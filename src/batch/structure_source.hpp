// Where the structures of a batch come from: files, folders, archives and lists, one after the
// other, without keeping more than their names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "structure/reader.hpp"

namespace vdwmesh {

// A structure that has not been parsed yet.
struct NamedStructure {
  std::string name;  // the path of a file, or the name of a member in its archive
  // The bytes of a member, which may be gzipped; nothing for a file, which is read by its name.
  std::optional<std::string> bytes;
  std::string fault;  // why the bytes cannot be read; empty if they can
};

class StructureSource {
 public:
  enum class Content { read, skip };

  virtual ~StructureSource() = default;
  // The next structure, or nothing behind the last. `skip` gives its name alone. Throws
  // FileFormatError if a folder, list or archive cannot be read on.
  virtual std::optional<NamedStructure> next(Content content) = 0;
  // How many names were passed over because their extensions are not those of structure files.
  virtual std::uint64_t left_out() const = 0;
};

struct SourceOptions {
  // Of all structures; by_extension: each name decides, and files of folders and members of
  // archives with other extensions are left out.
  StructureFormat format = StructureFormat::by_extension;
  // Bytes: members of archives that are longer have a fault.
  std::uint64_t largest_member = ~std::uint64_t{0};
};

// The structures of all inputs, in the order given. An input is
// - a folder: the files in it and in its folders, in the order of their paths, byte by byte;
// - a tar archive, plain or packed with gzip, bzip2, xz or Zstandard (by its name: .tar, .tar.gz,
//   .tgz, ...): its members in their order;
// - a structure file, by the extensions that read_structure() knows;
// - any other file: a list, with the path of a structure file on each line;
// - "-": standard input, a tar archive or a list, whichever its first bytes are.
// Throws InvalidInput for an input that is not there. The sources are opened as they come.
std::unique_ptr<StructureSource> open_structures(std::vector<std::filesystem::path> inputs,
                                                 const SourceOptions& options = {});

// The number of structures in the inputs, which takes a pass over archives and lists. Throws as
// open_structures() and next() do, and InvalidInput for "-", which can be read only once.
std::uint64_t count_structures(const std::vector<std::filesystem::path>& inputs,
                               const SourceOptions& options = {});

}  // namespace vdwmesh
