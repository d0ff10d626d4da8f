// NearSurface: spheres are chosen by z, as the shares of a surface are. A projection tries points
// that are no farther from its start than its reach. At a point it asks for balls that are no
// farther than the reach, or for atoms whose field reaches the point. So the spheres whose interval
// of z comes within twice the reach of a start are enough. Their cell list has the frame of the
// list of all spheres, so it visits them in the same order, and they keep their canonical order. So
// sums and ties have the same outcome.
#include "distributed/shares/near_surface.hpp"

#include "extract/blended/field_formulas.hpp"
#include "refine/crossings/preparation.hpp"
#include "spheres/list_ids.hpp"

namespace vdwmesh {
namespace {

constexpr double kBoxSlack = 1e-6;  // Å: more than kProjectionTolerance and rounding

}  // namespace

NearSurface::NearSurface(const SphereSet& spheres, const RefineOptions& options)
    : spheres_(spheres), options_(options), model_(projection_model(options)) {}

// Later levels move vertices by less, so the spheres chosen before are mostly enough.
void NearSurface::cover(double lower, double upper, double reach) {
  lower -= 2 * reach + kBoxSlack;
  upper += 2 * reach + kBoxSlack;
  if (surface_ && lower >= lower_ && upper <= upper_) return;
  choose_spheres(lower, upper);
}

void NearSurface::choose_spheres(double lower, double upper) {
  lower_ = lower;
  upper_ = upper;
  near_ = choose(spheres_, [&](SphereId, const Sphere& s) {
    const double reach = field_reach(model_, s.radius);
    return s.center.z + reach >= lower && s.center.z - reach <= upper;
  });
  if (near_.spheres.empty()) near_ = {{spheres_[0]}, {0}};
  near_set_ = SphereSet::view(near_.spheres);
  SurfaceView view{options_.projection,
                   projection_list(near_set_, options_, TriangleLabels::none, workspace_), model_,
                   spheres_.spheres().data()};
  use_ids(near_.ids, view.list, ids_);
  surface_.emplace(view);
}

}  // namespace vdwmesh
