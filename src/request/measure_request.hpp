// What is asked of the exact measures, and the checked options that follow from it.
#pragma once

#include <optional>
#include <string>

#include "cuda/backend_choice.hpp"
#include "measures/exact_union.hpp"
#include "request/refuse.hpp"

namespace vdwmesh {

// The surface as it is asked for: the boundary of the balls, the accessible surface (that of the
// balls that have grown by a probe of water), or the solvent-excluded surface.
enum class SurfaceChoice { vdw, sas, ses };

// Which surface is measured or meshed: the boundary of the union of the balls, which a probe makes
// the accessible surface; or the solvent-excluded surface.
enum class ExactSurface { vdw, excluded };

constexpr ExactSurface surface_of(SurfaceChoice choice) {
  return choice == SurfaceChoice::ses ? ExactSurface::excluded : ExactSurface::vdw;
}

// The probe's radius, Å: `given`, or else 0 for the balls themselves and that of water for the
// other surfaces. Throws InvalidInput if the surface needs another one.
double probe_of(SurfaceChoice choice, std::optional<double> given, Door door);

// What to say of a radius that no solvent has, with what to give instead; empty for others. Å.
std::string remark_on_probe(double probe, Door door);

// What was not said is empty.
struct MeasureRequest {
  Door door = Door::program;
  SurfaceChoice surface = SurfaceChoice::vdw;
  std::optional<double> probe;  // Å
  std::optional<UnionMethod> method;
  std::optional<TopologyRequest> topology;
  TopologyRequest usual_topology = TopologyRequest::full;  // where none is asked for
  bool certify = false;
  Backend backend = Backend::automatic;
};

struct ExactOptions {
  ExactSurface surface = ExactSurface::vdw;
  double probe = 0;  // Å
  UnionMethod method = UnionMethod::cgal;
  TopologyRequest topology = TopologyRequest::full;
  bool certify = false;
};

// Throws InvalidInput where what is asked for does not go together.
ExactOptions settle(const MeasureRequest& request);

// Samples of distances per Å², `given` as text. Throws InvalidInput unless there are more than 0
// and at most 1e6: more take hours even on a single atom.
double checked_samples(double per_area, std::string_view given, Door door);

}  // namespace vdwmesh
