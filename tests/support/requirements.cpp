#include "support/requirements.hpp"

#include <unistd.h>

#include <cstdlib>
#include <sstream>

namespace vdwmesh::testing {

bool is_required(const char* variable) {
  const char* value = std::getenv(variable);
  const std::string text = value ? value : "";
  return !text.empty() && text != "0";
}

bool has_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((folder + "/" + name).c_str(), X_OK) == 0) return true;
  }
  return false;
}

}  // namespace vdwmesh::testing
