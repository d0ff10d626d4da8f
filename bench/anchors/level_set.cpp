#include <openvdb/openvdb.h>
#include <openvdb/tools/ParticlesToLevelSet.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>

#include "anchors/anchors.hpp"

namespace vdwmesh::anchors {
namespace {

// What ParticlesToLevelSet asks of its particles.
class Particles {
 public:
  using PosType = openvdb::Vec3R;
  explicit Particles(const std::vector<Sphere>& spheres) : spheres_(spheres) {}
  std::size_t size() const { return spheres_.size(); }
  void getPos(std::size_t i, openvdb::Vec3R& position) const {
    const Vec3d& c = spheres_[i].center;
    position = {c.x, c.y, c.z};
  }
  void getPosRad(std::size_t i, openvdb::Vec3R& position, openvdb::Real& radius) const {
    getPos(i, position);
    radius = spheres_[i].radius;
  }

 private:
  const std::vector<Sphere>& spheres_;
};

}  // namespace

std::uint64_t level_set(const std::vector<Sphere>& spheres, double spacing) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  openvdb::initialize();
  const auto grid = openvdb::createLevelSet<openvdb::FloatGrid>(static_cast<float>(spacing));
  openvdb::tools::ParticlesToLevelSet<openvdb::FloatGrid> raster(*grid);
  raster.setRmin(0);
  raster.rasterizeSpheres(Particles(spheres));
  raster.finalize();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, quads);
  return 2 * quads.size();
}

}  // namespace vdwmesh::anchors
