// NearSurface: spheres are chosen by z, as shares of a surface are. A projection tries points
// within its reach of the start, and asks there for balls that are no farther than the reach, or
// for atoms whose field reaches the point. So spheres whose interval of z comes within twice the
// reach of a start are enough. The list of these visits them in the order in which a list of all
// spheres does, since it has the same frame, and they keep their canonical order; so sums and ties
// have the same outcome.
#include "distributed/near_surface.hpp"

#include "core/blocks.hpp"
#include "extract/blended/field_formulas.hpp"
#include "refine/preparation.hpp"

namespace vdwmesh {
namespace {

constexpr double kBoxSlack = 1e-6;  // Å: more than kProjectionTolerance and rounding

}  // namespace

NearSurface::NearSurface(const SphereSet& spheres, const RefineOptions& options)
    : spheres_(spheres), options_(options), model_(projection_model(options)) {}

// Levels after the first one move vertices by less, so they mostly find what they need.
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
  ids_.resize(view.list.size);
  for_all(ids_.size(), [&](std::size_t place) { ids_[place] = near_.ids[view.list.id[place]]; });
  view.list.id = ids_.data();
  surface_.emplace(view);
}

}  // namespace vdwmesh
