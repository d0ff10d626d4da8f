// The folder of shared files of this checkout, the only path compiled into the tests.
#include "support/shared_files.hpp"

#include <cstdlib>

namespace vdwmesh::testing {

std::filesystem::path shared_path(const std::string& relative) {
  const char* root = std::getenv("VDWMESH_SHARED");
  return std::filesystem::path(root ? root : VDWMESH_SHARED_DIR) / relative;
}

std::string plain_or_gzipped(const std::string& relative) {
  const std::string gzipped = relative + ".gz";
  const bool only_gzipped = !std::filesystem::exists(shared_path(relative)) &&
                            std::filesystem::exists(shared_path(gzipped));
  return only_gzipped ? gzipped : relative;
}

}  // namespace vdwmesh::testing
