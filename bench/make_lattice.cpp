// Large sets of spheres: copies of a structure on a cubic lattice, each turned by a rotation of its
// own, as an XYZR file on standard output. For the figures of docs/scale.md.
//
//   make_lattice FILE [--assembly NAME] [--atoms N] [--seed S] [--pitch P] [--first I] [--copies M]
//
// There are as many copies as N atoms take (default: a million). They stand P Å apart; without
// --pitch so far that no two of them can touch. --first and --copies write some of them only,
// exactly as they stand in the whole file, so that the whole can be checked against sums over its
// parts. Memory is that of one structure, whatever N.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <string>
#include <string_view>

#include "core/errors.hpp"
#include "lattice.hpp"

namespace vdwmesh {
namespace {

struct Arguments {
  LatticeOptions lattice;
  std::uint64_t first = 0, copies = ~std::uint64_t{0};
};

Arguments read_arguments(int argc, char** argv) {
  Arguments o;
  o.lattice =
      read_lattice_options(argc, argv, [&](std::string_view name, const std::string& value) {
        if (name == "--first") {
          o.first = count_of(value);
        } else if (name == "--copies") {
          o.copies = count_of(value);
        } else {
          return false;
        }
        return true;
      });
  return o;
}

void write_copy(const Lattice& lattice, std::uint64_t copy, std::FILE* file) {
  std::string text;
  lattice.for_each_sphere(copy, [&](std::size_t, const Sphere& s) {
    fmt::format_to(std::back_inserter(text), "{:.3f} {:.3f} {:.3f} {}\n", s.center.x, s.center.y,
                   s.center.z, s.radius);
  });
  if (std::fwrite(text.data(), 1, text.size(), file) != text.size()) {
    throw FileFormatError("the lattice cannot be written in full");
  }
}

void write(const Arguments& arguments, std::FILE* file) {
  const Lattice lattice(arguments.lattice);
  const std::uint64_t copies = lattice.copies();
  const std::uint64_t first = std::min(arguments.first, copies),
                      end = first + std::min(arguments.copies, copies - first);
  std::fprintf(stderr, "%llu copies of %zu atoms, %g A apart; writing %llu\n",
               static_cast<unsigned long long>(copies), lattice.atoms_of_copy(), lattice.pitch(),
               static_cast<unsigned long long>(end - first));
  for (std::uint64_t copy = first; copy < end; ++copy) write_copy(lattice, copy, file);
  if (std::fflush(file) != 0) throw FileFormatError("the lattice cannot be written in full");
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  try {
    vdwmesh::write(vdwmesh::read_arguments(argc, argv), stdout);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_lattice: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
