// two_probe_shell(): union-find over the faces of both surfaces, and sums over each set of faces.
//
// Claim: the surfaces meet in contact patches of the large probe alone. Proof: let a point of the
// large surface be on no atom. A large probe touches it, and in that probe a small one touches it,
// which overlaps no atom and is clear of all, so that it can move on and reach the point. So the
// point is not on the small surface.
//
// The boundary of the shell is therefore made of the saddles and concave patches of both surfaces,
// and of what the small probe's contact patches have beyond the large one's (ContactWalls). Each of
// its closed pieces bounds one pocket. The space outside S(large) is connected and unbounded, so it
// lies outside the outer boundary of each pocket: a closed piece with a mouth is the outer boundary
// of a pocket, and one without is an island, the whole surface of a part of S(small).
//
// Claim: each pocket has one mouth, a connected part of S(large)'s boundary less contact patches.
// Proof: it has one, because the space outside S(small) is connected. Each loop around the mouth is
// on one atom, and bounds a disk inside of it. The mouth and these disks are a closed surface. The
// pocket does not cross it, because it is in no atom and inside S(large); nor does the space
// outside S(large). So the pocket is on its inner side, and all other mouths are on the outer side.
//
// Where regions were joined that are apart, a pocket has several mouths; where they were not joined
// that are one, pieces are not closed. Both are checked.
//
// Volumes are fluxes of the position about an atom at each closed piece: outwards through patches
// of the large surface, inwards through those of the small one.
#include "excluded/two_probe_shell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "core/errors.hpp"
#include "core/sum.hpp"
#include "excluded/probes/surface_faces.hpp"
#include "excluded/two_probes/contact_walls.hpp"
#include "spheres/box.hpp"

namespace vdwmesh {
namespace {

using namespace excluded;

// A share of the area, as for the whole surface: rounding leaves some 1e-12 of it.
constexpr double kClosedShell = 1e-6;

// A closed piece of the shell's boundary.
struct ClosedPiece {
  std::optional<Vec3d> home = {};          // Å: the centre of an atom
  WideSum volume, area, mouth_area;        // Å³; Å² of walls, and of the mouth
  WideSum x, y, z;                         // ∫ n dA
  std::vector<std::uint32_t> mouths = {};  // sets of the large surface's faces, each once
  std::vector<SphereId> lining = {};       // as WallPart has them
  Box box = empty_box();                   // Å: around the atoms that it touches

  double closure() const {
    return norm(Vec3d{x.value(), y.value(), z.value()}) / (area.value() + mouth_area.value());
  }
};

// A face in Å, with the flux about the home of its closed piece; its normal points out of the
// solid of its own probe.
struct MeasuredFace {
  double area, flux;
  Vec3d vector;
};

class ShellDivider {
 public:
  ShellDivider(const SphereSet& atoms, const KeptSurface& small, const KeptSurface& large)
      : atoms_(atoms),
        kept_{&small, &large},
        walls_(small, large, atoms.size()),
        faces_{faces_of(small, walls_.node_count()), faces_of(large, 0)} {
    faces_[1].first = faces_[0].end();
  }

  void run(TwoProbeShell& shell) {
    join(shell);
    if (!shell.doubt.empty()) return;
    for (const WallPart& part : parts_) add_wall(part);
    for (std::size_t s = 0; s < 2; ++s) {
      add_saddles(s);
      add_concave(s);
    }
    collect(shell);
  }

 private:
  static SurfaceFaces faces_of(const KeptSurface& kept, std::size_t first) {
    return {kept.grown->surface, *kept.records, kept.outer, first};
  }

  void join(TwoProbeShell& shell) {
    DisjointSets sets(faces_[1].end()), mouths(faces_[1].end());
    std::uint64_t unsettled = 0, unmatched = 0;
    parts_ = walls_.join(sets, unsettled);
    for (std::size_t s = 0; s < 2; ++s) {
      const AccessibleSurface& surface = faces_[s].surface;
      for (std::uint32_t i = 0; i < surface.arcs.size(); ++i) {
        if (!surface.counts(surface.arcs[i], kept_[s]->outer)) continue;
        for (std::uint32_t k = 0; k < 2; ++k) {
          sets.join(faces_[s].half(i, k), walls_.node(s, 2 * i + k));
        }
      }
      faces_[s].join_saddles(sets);
      unmatched += faces_[s].join_creases(sets);
    }
    faces_[1].join_saddles(mouths);
    faces_[1].join_creases(mouths);
    if (unsettled > 0) {
      shell.doubt = fmt::format(
          "contact patches of both probes on {} atoms are too near each other to be told apart",
          unsettled);
    } else if (unmatched > 0) {
      shell.doubt = fmt::format("{} concave patches do not fit their neighbours", unmatched);
    }
    pieces_.resize(std::move(sets).number_sets(piece_of_));
    std::move(mouths).number_sets(mouth_of_);
  }

  // The closed piece of a face that touches these atoms.
  template <class Atoms>
  ClosedPiece& at(std::uint32_t face, const Atoms& touched) {
    ClosedPiece& piece = pieces_[piece_of_[face]];
    for (const SphereId id : touched) {
      if (!piece.home) piece.home = atoms_[id].center;
      include(piece.box, atoms_[id]);
    }
    return piece;
  }

  // Normals of the small surface point into the shell.
  void add(std::size_t s, std::uint32_t face, const MeasuredFace& m) {
    ClosedPiece& piece = pieces_[piece_of_[face]];
    const double sign = s == 0 ? -1 : 1;
    piece.volume.add(sign * m.flux);
    piece.x.add(sign * m.vector.x);
    piece.y.add(sign * m.vector.y);
    piece.z.add(sign * m.vector.z);
    if (s == 0) {
      piece.area.add(m.area);
    } else {
      piece.mouth_area.add(m.area);
      if (std::ranges::find(piece.mouths, mouth_of_[face]) == piece.mouths.end()) {
        piece.mouths.push_back(mouth_of_[face]);
      }
    }
  }

  void add_wall(const WallPart& part) {
    const Sphere& atom = atoms_[part.atom];
    const double r = atom.radius;
    ClosedPiece& piece = at(part.node, std::array{part.atom});
    piece.lining.push_back(part.atom);
    add(0, part.node,
        {r * r * part.solid_angle,
         flux_through(r, atom.center - *piece.home, part.solid_angle, part.vector),
         (r * r) * part.vector});
  }

  // Scaled positions and fluxes, in units of the surface's scale.
  Vec3d home_of(std::size_t s, const ClosedPiece& piece) const {
    return std::ldexp(1.0, -kept_[s]->grown->exponent) * *piece.home;
  }
  void add_scaled(std::size_t s, std::uint32_t face, const MeasuredFace& m) {
    const int e = kept_[s]->grown->exponent;
    add(s, face,
        {std::ldexp(m.area, 2 * e), std::ldexp(m.flux, 3 * e), std::ldexp(1.0, 2 * e) * m.vector});
  }

  void add_saddles(std::size_t s) {
    const AccessibleSurface& surface = faces_[s].surface;
    const std::vector<SphereId>& ids = kept_[s]->grown->triangulation.ids;
    for (std::uint32_t i = 0; i < surface.arcs.size(); ++i) {
      const RolledArc& arc = surface.arcs[i];
      if (!surface.counts(arc, kept_[s]->outer)) continue;
      const Profile profile = profile_of(arc);
      for (std::size_t k = 0; k < 2; ++k) {
        const std::uint32_t face = faces_[s].half(i, k);
        const ClosedPiece& piece = at(face, std::array{ids[arc.ball[0]], ids[arc.ball[1]]});
        const SaddleMeasures m = measure_saddle(arc, surface.probe_radius, profile, k);
        const Vec3d middle = surface.place(arc, home_of(s, piece));
        add_scaled(s, face, {m.area, m.flux + dot(middle, m.vector) / 3, m.vector});
      }
    }
  }

  void add_concave(std::size_t s) {
    const AccessibleSurface& surface = faces_[s].surface;
    const std::vector<SphereId>& ids = kept_[s]->grown->triangulation.ids;
    const double p = surface.probe_radius;
    for (std::uint32_t i = 0; i < kept_[s]->records->pieces.size(); ++i) {
      const ConcavePiece& c = kept_[s]->records->pieces[i];
      const Probe& probe = surface.probes[c.probe];
      const std::uint32_t face = faces_[s].piece(i);
      const auto& v = surface.triangle_of(probe.corner).vertices;
      const ClosedPiece& piece = at(face, std::array{ids[v[0]], ids[v[1]], ids[v[2]]});
      const Vec3d x = surface.place(probe, home_of(s, piece));
      add_scaled(s, face,
                 {p * p * c.solid_angle, -flux_through(p, x, c.solid_angle, c.vector),
                  (-p * p) * c.vector});
    }
  }

  void collect(TwoProbeShell& shell) {
    std::vector<const ClosedPiece*> outer, islands;
    for (const ClosedPiece& piece : pieces_) {
      if (!piece.home) continue;
      shell.closure = std::max(shell.closure, piece.closure());
      (piece.mouths.empty() ? islands : outer).push_back(&piece);
    }
    std::vector<ShellPocket> pockets;
    for (const ClosedPiece* piece : outer) pockets.push_back(pocket_of(*piece));
    std::size_t unplaced = 0;
    for (const ClosedPiece* island : islands) {
      const std::size_t around = pocket_around(*island, outer);
      if (around == outer.size()) {
        ++unplaced;
        continue;
      }
      ShellPocket& pocket = pockets[around];
      pocket.volume += island->volume.value();
      pocket.area += island->area.value();
      ++pocket.islands;
      const ShellPocket walls = pocket_of(*island);
      pocket.lining.insert(pocket.lining.end(), walls.lining.begin(), walls.lining.end());
      std::ranges::sort(pocket.lining);
    }
    if (!(shell.closure <= kClosedShell)) {
      shell.doubt = fmt::format("the boundary of a pocket is not closed by {:.1e} of its area",
                                shell.closure);
    } else if (std::ranges::any_of(pockets, [](const auto& p) { return p.mouths != 1; })) {
      shell.doubt = "a pocket has several mouths, so that contact patches are joined wrongly";
    } else if (unplaced > 0) {
      shell.doubt =
          fmt::format("{} parts of the small probe's solid lie in no pocket for certain", unplaced);
    } else {
      std::ranges::stable_sort(pockets, std::greater(), &ShellPocket::volume);
      shell.pockets = std::move(pockets);
    }
  }

  static ShellPocket pocket_of(const ClosedPiece& piece) {
    ShellPocket pocket{.volume = piece.volume.value(),
                       .area = piece.area.value(),
                       .mouth_area = piece.mouth_area.value(),
                       .mouths = piece.mouths.size(),
                       .islands = 0,
                       .lining = piece.lining};
    std::ranges::sort(pocket.lining);
    const auto twice = std::ranges::unique(pocket.lining);
    pocket.lining.erase(twice.begin(), twice.end());
    return pocket;
  }

  // The only pocket that is large enough to hold an island, in box and volume; the number of
  // pockets if there are several, or none, or if the island has no atom to be placed by. Where a
  // pocket reaches farthest, it is an atom's sphere or the concave patch of a small probe, which
  // touches atoms. So the pocket lies in the box of its atoms, made larger by that probe.
  std::size_t pocket_around(const ClosedPiece& island,
                            const std::vector<const ClosedPiece*>& outer) const {
    if (island.lining.empty() && outer.size() > 1) return outer.size();
    std::size_t found = outer.size();
    const double reach = std::ldexp(faces_[0].surface.probe_radius, kept_[0]->grown->exponent);
    for (std::size_t i = 0; i < outer.size(); ++i) {
      const ClosedPiece& pocket = *outer[i];
      if (pocket.volume.value() + island.volume.value() < 0) continue;
      bool holds = true;
      for (int axis = 0; axis < 3; ++axis) {
        holds = holds && pocket.box.lower[axis] - reach <= island.box.lower[axis] &&
                pocket.box.upper[axis] + reach >= island.box.upper[axis];
      }
      if (!holds) continue;
      if (found != outer.size()) return outer.size();
      found = i;
    }
    return found;
  }

  const SphereSet& atoms_;
  const std::array<const KeptSurface*, 2> kept_;  // of the small and of the large probe
  const ContactWalls walls_;
  std::array<SurfaceFaces, 2> faces_;
  std::vector<WallPart> parts_;
  Buffer<std::uint32_t> piece_of_, mouth_of_;  // by number of a face
  std::vector<ClosedPiece> pieces_;
};

}  // namespace

TwoProbeShell two_probe_shell(const SphereSet& atoms, double small_probe, double large_probe,
                              Monitor* monitor) {
  if (!(large_probe > small_probe)) {
    throw InvalidInput(
        fmt::format("the large probe has {} Å and the small one {} Å", large_probe, small_probe));
  }
  std::array<KeptSurface, 2> kept;
  const auto measures = [&](double probe, KeptSurface& surface) {
    return measure_and_keep(
        atoms, {.probe = probe, .shells = false, .exterior = true, .monitor = monitor}, surface);
  };
  TwoProbeShell shell{.small = measures(small_probe, kept[0]),
                      .large = measures(large_probe, kept[1]),
                      .pockets = {},
                      .doubt = {}};
  for (const ExcludedMeasures* m : {&shell.small, &shell.large}) {
    const std::uint64_t patches = m->exterior->checks.uncertified_patches;
    if (patches == 0) continue;
    shell.doubt =
        fmt::format("{} concave patches of the probe of {} Å are not certified", patches, m->probe);
    return shell;
  }
  ShellDivider(atoms, kept[0], kept[1]).run(shell);
  return shell;
}

}  // namespace vdwmesh
