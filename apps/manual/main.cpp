// Writes the man pages and completions of the programs into a folder, when the project is built:
//   vdwmesh_manual FOLDER [--ranks]
// FOLDER/man1, FOLDER/bash and FOLDER/zsh get the files under the names by which they are
// installed; with --ranks there are those of vdwmesh-mpi too.
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "build_id.hpp"
#include "manual/manual.hpp"
#include "outcome.hpp"
#include "output.hpp"
#include "ranks/rank_program.hpp"
#include "refuse.hpp"

namespace vdwmesh::apps {
namespace {

void write_manual(const Program& program, const std::filesystem::path& folder) {
  Draft draft;
  const ListedProgram listed = list_of(program, draft);
  const std::string name(program.name);
  const auto write_page = [&](const std::string& page, const std::string& text) {
    write_file(folder / "man1" / (page + ".1"), text);
  };
  write_page(name, man_page(listed, kVersion));
  for (const ListedVerb& verb : listed.verbs) {
    write_page(page_name(program, *verb.verb), man_page(listed, verb, kVersion));
  }
  write_file(folder / "bash" / name, bash_completion(listed));
  write_file(folder / "zsh" / ("_" + name), zsh_completion(listed));
}

void write_manuals(int argc, const char* const* argv) {
  refuse_if(argc < 2, "vdwmesh_manual: name the folder that the pages are written to");
  const std::filesystem::path folder = argv[1];
  for (const char* part : {"man1", "bash", "zsh"}) {
    std::filesystem::remove_all(folder / part);
    std::filesystem::create_directories(folder / part);
  }
  write_manual(plain_program(), folder);
  if (argc < 3 || std::string_view(argv[2]) != "--ranks") return;
  const std::vector<Verb> verbs = rank_verbs({}, {});
  write_manual(rank_program(verbs, 1), folder);
}

}  // namespace
}  // namespace vdwmesh::apps

int main(int argc, char** argv) {
  using namespace vdwmesh::apps;
  const Outcome outcome = outcome_of([&] { write_manuals(argc, argv); });
  if (outcome.status != kDone)
    std::fprintf(stderr, "vdwmesh_manual: %s\n", outcome.message.c_str());
  return outcome.status;
}
