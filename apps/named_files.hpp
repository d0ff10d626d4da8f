// The files that a command line names, checked before any work. Two of its options must not write
// the same file, and none may write a file that another reads.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace vdwmesh::apps {

// Whether the name is that of a VTKHDF file, which only ranks write: it ends in .vtkhdf, whose case
// does not matter.
bool is_vtkhdf(const std::filesystem::path& path);

// Names that lead to the same file count as the same, be it by links or by "./". Every function
// throws InvalidInput that names both options where the file is taken. An empty name is no file.
class NamedFiles {
 public:
  // "-" is standard input, which nothing overwrites.
  void add_input(std::string_view option, const std::filesystem::path& path);
  // "-" is standard output, which takes one output; devices and pipes may be named twice. Throws
  // what check_writable() throws as well.
  void add_output(std::string_view option, const std::filesystem::path& path);
  // One of the files in the folder that `option` names, which need not be there yet.
  void add_output_in(std::string_view option, const std::filesystem::path& folder,
                     const std::filesystem::path& name);

 private:
  enum class Use { reads, writes };
  struct Named {
    std::string option;
    std::filesystem::path path;
    Use use;
  };
  void add(Named named);

  std::vector<Named> files_;
};

}  // namespace vdwmesh::apps
