// A radius file of any bytes.
#include <cmath>

#include "fuzz/memory_file.hpp"
#include "structure/radii.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vdwmesh;
  using namespace vdwmesh::fuzz;
  const MemoryFile file(as_text(data, size));
  allow_refusal([&] {
    const RadiusTable table = RadiusTable::from_file(file.path());
    for (const char* element : {"H", "D", "C", "Zn", "X"}) {
      const auto entry = table.find("ALA", "CA", element);
      require(!entry || (std::isfinite(entry->radius) && entry->radius >= 0),
              "radii are finite and not negative");
    }
  });
  return 0;
}
