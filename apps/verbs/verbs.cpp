// The table of the verbs of vdwmesh. It stands apart from the verbs themselves, so that the list of
// options can name them without knowing what they do. A verb is a function of the checked options;
// it throws where it fails, and main() knows what that means.
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {
namespace {

const Verb kVerbs[] = {
    {kMesh, "mesh", "a mesh of a structure's surface, as a file", run_mesh},
    {kReport, "report", "a mesh, the exact area, volume and topology, and how far apart they are",
     run_report},
    {kExact, "exact", "exact area, volume and topology, no mesh", run_exact},
    {kInterface, "interface", "what chains or other groups of atoms bury of each other's surface",
     run_interface},
    {kCompare, "compare", "a triangle mesh, from any program, against the exact surface",
     run_compare},
    {kRender, "render", "a picture of a structure's surface, or of a mesh file", run_render},
    {kStudy, "study",
     "meshes over spacings, subdivisions, fields and meshers: CSV, JSON and a page with plots",
     run_study},
    {kBatch, "batch",
     "figures of many structures, exact or of meshes too, a row of JSON or CSV for each",
     run_batch_verb},
    {kPockets, "pockets", "pockets, channels and voids with their mouths, exactly", run_pockets},
    {kView, "view", "a page that shows a structure: surface, pockets, interfaces, exact figures",
     run_view},
    {kInfo, "info", "version, build, backends, devices", run_info}};

}  // namespace

const Program& plain_program() {
  static const Program program{
      "vdwmesh", "vdwmesh",
      "Van der Waals surface meshes of molecules, and proof of how good they are", kVerbs};
  return program;
}

}  // namespace vdwmesh::apps
