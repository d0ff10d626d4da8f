// The first rank reads, because a parallel file system is slow for many readers of one small file,
// and because standard input is there alone.
//
// Where a line or a copy is not as it should be, or is one to be left out, the first rank begins
// again as the plain program does, which knows what to say of it.
#include "ranks/shared_structure.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "core/fixed_blocks.hpp"
#include "steps/steps.hpp"
#include "structure/read/unexpanded.hpp"

namespace vdwmesh::apps {
namespace {

// Makes a sphere, if it may be one of a set.
bool put_sphere(const Vec3d& center, double radius, Sphere& place) {
  place = {center, radius};
  return radius > 0 && !is_far(center);
}

// Where the spheres of the pieces begin that count so many each, and where the last ones end.
std::vector<std::uint64_t> begins_of(std::span<const std::uint64_t> counts) {
  std::vector<std::uint64_t> begins(counts.size() + 1);
  std::inclusive_scan(counts.begin(), counts.end(), begins.begin() + 1);
  return begins;
}

// The copies, or what is left of them, that are within a share of an assembly.
template <class Visit>
void for_each_copy(const SharedStructure& s, std::uint64_t size, const ShareOfArray& share,
                   const Visit& visit) {
  const std::uint64_t begin = begin_of_part(size, share.number, share.count),
                      end = begin_of_part(size, share.number + 1, share.count);
  const std::span<const UnitAtom> atoms = s.atoms.span();
  tbb::parallel_for(std::size_t{0}, s.copies.size(), [&](std::size_t c) {
    const UnitCopy& copy = s.copies[c];
    const std::uint64_t first = std::max(begin, copy.begin),
                        last = std::min(end, copy.begin + copy.count);
    for (std::uint64_t i = first; i < last; ++i) visit(i, atoms[copy.first + i - copy.begin], copy);
  });
}

std::uint64_t size_of_assembly(const SharedStructure& s) {
  return s.copies.empty() ? 0 : s.copies.back().begin + s.copies.back().count;
}

class Loader {
 public:
  Loader(const Ranks& ranks, const InputOptions& options, Session& session)
      : ranks_(ranks), options_(options), session_(session) {}

  // Collective.
  SharedStructure run(AtomRecords records) {
    ranks_.together([&] {
      if (ranks_.is_first()) read(records);
    });
    shared_.origin = ranks_.shared(shared_.origin);
    if (shared_.origin == SphereOrigin::lines) make_of_lines();
    if (shared_.origin == SphereOrigin::assembly) make_copies();
    if (shared_.origin == SphereOrigin::records) {
      shared_.of_spheres = HostArray<Sphere>(ranks_, read_.spheres());
    }
    ranks_.together([&] {
      shared_.spheres = SphereSet::view(shared_.of_spheres.span());
      if (ranks_.is_first()) describe();
    });
    session_.end_stage(&Timing::read);
    return std::move(shared_);
  }

 private:
  // On the first rank.
  void read(AtomRecords records) {
    if (records == AtomRecords::needless && options_.sample.empty()) {
      text_ = read_sphere_text(options_.path, read_options(options_, session_));
      if (text_) {
        shared_.origin = SphereOrigin::lines;
        shared_.molecule = std::move(text_->molecule);
        return;
      }
    }
    if (!options_.sample.empty()) {
      take(read_sample(options_.sample, read_options(options_, session_)));
      return;
    }
    unexpanded_ = read_unexpanded(options_.path, read_options(options_, session_));
    // The area by polarity is of single atoms.
    const bool is_assembly = records == AtomRecords::needless && !unexpanded_.copies.empty() &&
                             !unexpanded_.molecule.has_polarity;
    if (is_assembly) {
      list_copies();
    } else {
      take(expanded(std::move(unexpanded_)));
    }
  }

  // On the first rank.
  void take(Molecule molecule) {
    shared_.molecule = std::move(molecule);
    read_ = to_spheres(shared_.molecule, options_.probe);
  }

  // On the first rank.
  void list_copies() {
    shared_.origin = SphereOrigin::assembly;
    for (const Atom& atom : unexpanded_.molecule.atoms) {
      unit_.push_back({atom.position, atom.radius, element_color(atom.element)});
    }
    for (const ChainCopy& copy : unexpanded_.copies) {
      shared_.copies.push_back({copy.first, size_of_assembly(shared_), copy.count, copy.map});
    }
  }

  // Collective.
  void make_of_lines() {
    const std::uint64_t first = ranks_.shared(std::uint64_t{text_ ? text_->first : 0});
    const HostMemory in_memory(
        ranks_, text_ ? std::as_bytes(std::span(text_->bytes.data(), text_->bytes.size()))
                      : std::span<const std::byte>());
    text_.reset();
    const std::string_view whole(reinterpret_cast<const char*>(in_memory.bytes().data()),
                                 in_memory.bytes().size());
    const std::string_view text = whole.substr(first);
    const std::vector<std::string_view> pieces = pieces_of_spheres(text);
    const std::vector<std::uint64_t> begins = begins_of(counts_of(pieces));
    bool is_sound = begins.back() > 0 && begins.back() < kNoSphere;
    if (is_sound) {
      is_sound = fill(begins.back(), [&](const ShareOfArray& share, std::span<Sphere> all) {
        std::atomic<bool> are_sound = true;
        tbb::parallel_for(begin_of_part(pieces.size(), share.number, share.count),
                          begin_of_part(pieces.size(), share.number + 1, share.count),
                          [&](std::uint64_t p) {
                            if (!take_lines(pieces[p], all.data() + begins[p])) are_sound = false;
                          });
        return are_sound.load();
      });
    }
    if (!is_sound) {
      begin_again(
          [&] { return read_structure(options_.path, whole, read_options(options_, session_)); });
    }
  }

  bool take_lines(std::string_view piece, Sphere* next) const {
    bool are_sound = true;
    const bool are_read = read_spheres(piece, [&](const Vec3d& center, double radius) {
      are_sound = put_sphere(center, radius + options_.probe, *next++) && are_sound;
    });
    return are_read && are_sound;
  }

  // Each rank counts the spheres of some pieces. Collective.
  std::vector<std::uint64_t> counts_of(const std::vector<std::string_view>& pieces) const {
    std::vector<std::uint64_t> counts(pieces.size());
    const auto rank = static_cast<std::uint64_t>(ranks_.number()),
               ranks = static_cast<std::uint64_t>(ranks_.count());
    tbb::parallel_for(begin_of_part(pieces.size(), rank, ranks),
                      begin_of_part(pieces.size(), rank + 1, ranks),
                      [&](std::uint64_t p) { counts[p] = count_spheres(pieces[p]); });
    ranks_.add_up(counts);
    return counts;
  }

  // Collective.
  void make_copies() {
    shared_.atoms = HostArray<UnitAtom>(ranks_, unit_);
    unit_ = std::vector<UnitAtom>();
    ranks_.share(shared_.copies);
    const std::uint64_t size = size_of_assembly(shared_);
    const bool is_sound = fill(size, [&](const ShareOfArray& share, std::span<Sphere> all) {
      std::atomic<bool> are_sound = true;
      for_each_copy(shared_, size, share,
                    [&](std::uint64_t i, const UnitAtom& atom, const UnitCopy& copy) {
                      const double radius = atom.radius + options_.probe;
                      if (!put_sphere(copy.map(atom.position), radius, all[i])) are_sound = false;
                    });
      return are_sound.load();
    });
    if (!is_sound) {
      begin_again([&] { return expanded(std::move(unexpanded_)); });
      return;
    }
    shared_.molecule = std::move(unexpanded_.molecule);
    shared_.molecule.atoms = std::vector<Atom>();
  }

  // Makes the spheres by make(share, all), which returns false if some cannot be. Returns false if
  // that happens on any rank. Collective.
  template <class Make>
  bool fill(std::uint64_t size, const Make& make) {
    bool is_sound = true;
    shared_.of_spheres = HostArray<Sphere>(
        ranks_, size,
        [&](const ShareOfArray& share, std::span<Sphere> all) { is_sound = make(share, all); });
    return ranks_.sum(std::uint64_t{!is_sound}) == 0;
  }

  // Collective.
  template <class ReadMolecule>
  void begin_again(const ReadMolecule& read_molecule) {
    shared_ = {};
    ranks_.together([&] {
      if (ranks_.is_first()) take(read_molecule());
    });
  }

  // On the first rank. An atom of a list of spheres is one of the file.
  void describe() {
    Molecule& molecule = shared_.molecule;
    const std::size_t size = shared_.spheres.size();
    if (shared_.origin == SphereOrigin::lines) molecule.atoms_read = molecule.atoms_used = size;
    describe_input(molecule, options_, session_);
    if (shared_.origin == SphereOrigin::records) return;
    session_.report.input.spheres = session_.report.input.measured = size;
  }

  const Ranks& ranks_;
  const InputOptions& options_;
  Session& session_;
  SharedStructure shared_;
  SphereSet read_;                  // of the records
  std::optional<SphereText> text_;  // while nobody else has it
  UnexpandedMolecule unexpanded_;
  std::vector<UnitAtom> unit_;  // until all have it
};

}  // namespace

SharedStructure load_together(const Ranks& ranks, const InputOptions& options, AtomRecords records,
                              Session& session) {
  return Loader(ranks, options, session).run(records);
}

HostArray<RgbColor> share_colors(const Ranks& ranks, const SharedStructure& structure) {
  const std::uint64_t size = structure.spheres.size();
  if (structure.origin == SphereOrigin::lines) {
    const RgbColor color = element_color(Atom().element);
    return {ranks, size, [&](const ShareOfArray& share, std::span<RgbColor> all) {
              const std::uint64_t begin = begin_of_part(size, share.number, share.count),
                                  end = begin_of_part(size, share.number + 1, share.count);
              std::ranges::fill(all.subspan(begin, end - begin), color);
            }};
  }
  if (structure.origin == SphereOrigin::assembly) {
    return {ranks, size, [&](const ShareOfArray& share, std::span<RgbColor> all) {
              for_each_copy(structure, size, share,
                            [&](std::uint64_t i, const UnitAtom& atom, const UnitCopy&) {
                              all[i] = atom.color;
                            });
            }};
  }
  std::vector<RgbColor> colors;
  ranks.together([&] { colors = element_colors(structure.molecule); });
  return {ranks, colors};
}

}  // namespace vdwmesh::apps
