// What --help prints, made from the lists of verbs and options.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "command_line/option_list.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {

// "mpirun -n P vdwmesh-mpi mesh [OPTION...] INPUT": how a verb is called.
std::string synopsis(const Program& program, const Verb& verb,
                     const std::vector<OptionGroup>& groups);
// What an option is for, which names its value may have, and in brackets what holds without it.
std::string meaning(const Option& option);

// The verbs of the program.
std::string verbs_help(const Program& program);

// The options of a verb by group: names, what stands for the value, meaning, what holds without.
// Where `all` has more of them, the last line says how to see these.
std::string verb_help(const Program& program, const Verb& verb,
                      const std::vector<OptionGroup>& groups, const std::vector<OptionGroup>& all);

}  // namespace vdwmesh::apps
