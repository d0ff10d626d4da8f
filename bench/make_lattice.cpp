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
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "batch/molecule_spheres.hpp"
#include "core/errors.hpp"
#include "core/split_mix.hpp"
#include "spheres/sphere_set.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {
namespace {

struct LatticeOptions {
  std::string file;
  ReadOptions read;
  std::uint64_t atoms = 1'000'000, seed = 1;
  double pitch = 0;  // Å; 0: no two copies can touch
  std::uint64_t first = 0, copies = ~std::uint64_t{0};
};

LatticeOptions read_arguments(int argc, char** argv) {
  LatticeOptions o;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name.substr(0, 2) != "--") {
      o.file = name;
      continue;
    }
    if (i + 1 == argc) throw InvalidInput(fmt::format("{}: needs a value", name));
    const std::string value = argv[++i];
    const auto number = [&] { return static_cast<std::uint64_t>(std::stod(value)); };  // 1e8 too
    if (name == "--assembly") {
      o.read.assembly = value;
    } else if (name == "--atoms") {
      o.atoms = number();
    } else if (name == "--seed") {
      o.seed = number();
    } else if (name == "--pitch") {
      o.pitch = std::stod(value);
    } else if (name == "--first") {
      o.first = number();
    } else if (name == "--copies") {
      o.copies = number();
    } else {
      throw InvalidInput(fmt::format("{}: is no option", name));
    }
  }
  if (o.file.empty()) throw InvalidInput("name a structure file");
  return o;
}

// Numbers in [0, 1) that depend on the seed and the copy alone.
std::array<double, 3> random_numbers(std::uint64_t seed, std::uint64_t copy) {
  std::array<double, 3> numbers;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const std::uint64_t state =
        split_mix(seed * kSplitMixStep) + (3 * copy + k + 1) * kSplitMixStep;
    numbers[k] = static_cast<double>(split_mix(state) >> 11) * 0x1p-53;
  }
  return numbers;
}

// A rotation, all of which are equally likely, as the rows of its matrix (K. Shoemake, "Uniform
// random rotations", Graphics Gems III, 1992).
std::array<Vec3d, 3> random_rotation(std::uint64_t seed, std::uint64_t copy) {
  const auto [u, v, w] = random_numbers(seed, copy);
  const double a = 2 * std::numbers::pi * v, b = 2 * std::numbers::pi * w;
  const double near = std::sqrt(1 - u), far = std::sqrt(u);
  const double x = near * std::sin(a), y = near * std::cos(a), z = far * std::sin(b),
               s = far * std::cos(b);  // a unit quaternion
  return {Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y - s * z), 2 * (x * z + s * y)},
          Vec3d{2 * (x * y + s * z), 1 - 2 * (x * x + z * z), 2 * (y * z - s * x)},
          Vec3d{2 * (x * z - s * y), 2 * (y * z + s * x), 1 - 2 * (x * x + y * y)}};
}

class Lattice {
 public:
  explicit Lattice(const LatticeOptions& options) : options_(options) {
    const SphereSet set = to_spheres(read_structure(options.file, options.read), 0);
    if (set.empty()) throw InvalidInput(options.file + ": has no atoms");
    spheres_.assign(set.spheres().begin(), set.spheres().end());
    const Box box = center_bounding_box(set);
    const Vec3d middle = box.lower + 0.5 * (box.upper - box.lower);
    double reach = 0;  // of a copy from its middle, whatever its rotation
    for (Sphere& s : spheres_) {
      s.center = s.center - middle;
      reach = std::max(reach, norm(s.center) + s.radius);
    }
    constexpr double kGap = 0.1;  // Å: more than coordinates are rounded by
    pitch_ = options.pitch > 0 ? options.pitch : 2 * reach + kGap;
    copies_ = (options.atoms + spheres_.size() - 1) / spheres_.size();
    while (side_ * side_ * side_ < copies_) ++side_;
  }

  void write(std::FILE* file) const {
    const std::uint64_t first = std::min(options_.first, copies_),
                        end = first + std::min(options_.copies, copies_ - first);
    std::fprintf(stderr, "%llu copies of %zu atoms, %g A apart; writing %llu\n",
                 static_cast<unsigned long long>(copies_), spheres_.size(), pitch_,
                 static_cast<unsigned long long>(end - first));
    for (std::uint64_t copy = first; copy < end; ++copy) write_copy(copy, file);
    if (std::fflush(file) != 0) throw FileFormatError("the lattice cannot be written in full");
  }

 private:
  Vec3d place_of(std::uint64_t copy) const {
    const std::uint64_t x = copy % side_, y = copy / side_ % side_, z = copy / side_ / side_;
    return {pitch_ * static_cast<double>(x), pitch_ * static_cast<double>(y),
            pitch_ * static_cast<double>(z)};
  }

  void write_copy(std::uint64_t copy, std::FILE* file) const {
    const std::array<Vec3d, 3> rows = random_rotation(options_.seed, copy);
    const Vec3d place = place_of(copy);
    std::string text;
    for (const Sphere& s : spheres_) {
      const Vec3d turned{dot(rows[0], s.center), dot(rows[1], s.center), dot(rows[2], s.center)};
      const Vec3d p = turned + place;
      fmt::format_to(std::back_inserter(text), "{:.3f} {:.3f} {:.3f} {}\n", p.x, p.y, p.z,
                     s.radius);
    }
    if (std::fwrite(text.data(), 1, text.size(), file) != text.size()) {
      throw FileFormatError("the lattice cannot be written in full");
    }
  }

  LatticeOptions options_;
  std::vector<Sphere> spheres_;  // of a copy, about its middle
  double pitch_ = 0;             // Å
  std::uint64_t copies_ = 0, side_ = 1;
};

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  try {
    const vdwmesh::LatticeOptions options = vdwmesh::read_arguments(argc, argv);
    vdwmesh::Lattice(options).write(stdout);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_lattice: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
