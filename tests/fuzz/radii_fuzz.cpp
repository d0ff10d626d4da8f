// A radius file of any bytes.
#include <cmath>

#include "fuzz/memory_file.hpp"
#include "structure/radii.hpp"

namespace vdwmesh::fuzz {

void run_input(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(as_text(data, size));
  allow_refusal([&] {
    const RadiusTable table = RadiusTable::from_file(file.path());
    for (const char* element : {"H", "D", "C", "Zn", "X"}) {
      const auto entry = table.find("ALA", "CA", element);
      require(!entry || (std::isfinite(entry->radius) && entry->radius >= 0),
              "radii are finite and not negative");
    }
  });
}

}  // namespace vdwmesh::fuzz
