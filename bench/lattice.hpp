// Copies of a structure on a cubic lattice, each turned by a rotation of its own: large sets of
// spheres, whose parts do not touch. For the figures of docs/scale.md.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "batch/molecule_spheres.hpp"
#include "core/errors.hpp"
#include "core/order/split_mix.hpp"
#include "spheres/sphere_set.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {

// A number that may be written as 1e8.
inline std::uint64_t count_of(const std::string& text) {
  return static_cast<std::uint64_t>(std::stod(text));
}

struct LatticeOptions {
  std::string file;
  ReadOptions read;
  std::uint64_t atoms = 1'000'000, seed = 1;  // as many copies as these atoms take
  double pitch = 0;                           // Å; 0: no two copies can touch
};

// Reads the command line of a bench that makes a lattice: the name of the structure file, and
// options with a value each. take(name, value) takes an option of the bench's own, and returns
// whether there is one of that name. Throws InvalidInput.
template <class Take>
LatticeOptions read_lattice_options(int argc, char** argv, const Take& take) {
  LatticeOptions lattice;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name.substr(0, 2) != "--") {
      lattice.file = name;
      continue;
    }
    if (i + 1 == argc) throw InvalidInput(std::string(name) + ": needs a value");
    const std::string value = argv[++i];
    if (name == "--assembly") {
      lattice.read.assembly = value;
    } else if (name == "--atoms") {
      lattice.atoms = count_of(value);
    } else if (name == "--seed") {
      lattice.seed = count_of(value);
    } else if (name == "--pitch") {
      lattice.pitch = std::stod(value);
    } else if (!take(name, value)) {
      throw InvalidInput(std::string(name) + ": is no option");
    }
  }
  if (lattice.file.empty()) throw InvalidInput("name a structure file");
  return lattice;
}

class Lattice {
 public:
  explicit Lattice(const LatticeOptions& options) : seed_(options.seed) {
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

  std::uint64_t copies() const { return copies_; }
  std::size_t atoms_of_copy() const { return spheres_.size(); }
  double pitch() const { return pitch_; }  // Å

  // Where the middle of a copy stands, Å: on multiples of the pitch.
  Vec3d place_of(std::uint64_t copy) const {
    const std::uint64_t x = copy % side_, y = copy / side_ % side_, z = copy / side_ / side_;
    return {pitch_ * static_cast<double>(x), pitch_ * static_cast<double>(y),
            pitch_ * static_cast<double>(z)};
  }

  // Calls visit(i, sphere) for the spheres of a copy, in the order of the structure.
  template <class Visit>
  void for_each_sphere(std::uint64_t copy, const Visit& visit) const {
    const std::array<Vec3d, 3> rows = random_rotation(seed_, copy);
    const Vec3d place = place_of(copy);
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
      const Vec3d& c = spheres_[i].center;
      const Vec3d turned{dot(rows[0], c), dot(rows[1], c), dot(rows[2], c)};
      visit(i, Sphere{turned + place, spheres_[i].radius});
    }
  }

 private:
  // Numbers in [0, 1) that depend on the seed and the copy alone.
  static std::array<double, 3> random_numbers(std::uint64_t seed, std::uint64_t copy) {
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
  static std::array<Vec3d, 3> random_rotation(std::uint64_t seed, std::uint64_t copy) {
    const auto [u, v, w] = random_numbers(seed, copy);
    const double a = 2 * std::numbers::pi * v, b = 2 * std::numbers::pi * w;
    const double near = std::sqrt(1 - u), far = std::sqrt(u);
    const double x = near * std::sin(a), y = near * std::cos(a), z = far * std::sin(b),
                 s = far * std::cos(b);  // a unit quaternion
    return {Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y - s * z), 2 * (x * z + s * y)},
            Vec3d{2 * (x * y + s * z), 1 - 2 * (x * x + z * z), 2 * (y * z - s * x)},
            Vec3d{2 * (x * z - s * y), 2 * (y * z + s * x), 1 - 2 * (x * x + y * y)}};
  }

  std::uint64_t seed_;
  std::vector<Sphere> spheres_;  // of a copy, about its middle
  double pitch_ = 0;             // Å
  std::uint64_t copies_ = 0, side_ = 1;
};

}  // namespace vdwmesh
