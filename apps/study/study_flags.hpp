// The options of `vdwmesh study`.
#pragma once

#include "options.hpp"
#include "study/study.hpp"

namespace vdwmesh::apps {

class StudyFlags {
 public:
  void add_to(CLI::App& verb);
  // Checks everything but the folder, which make_study() makes.
  StudyOptions resolve() const;

 private:
  StudyAxes resolve_axes() const;
  std::string folder_, page_triangles_ = "1000000", resume_ = "on", self_intersections_ = "auto";
  std::string meshers_ = "marching-cubes", spacings_ = "1,0.5,0.25", edge_lengths_ = "0.7,0.35";
  std::string subdivisions_ = "0,1", fields_ = "vdw,blinn,soft,inverse-squared";
  std::string projections_ = "own,vdw", backends_ = "auto";
  std::optional<std::string> time_limit_;
  DistanceFlags distances_;
  MachineFlags machine_;
};

}  // namespace vdwmesh::apps
