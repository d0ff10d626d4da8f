// What to type in place of an option or a verb that is unknown here, because other programs have
// it. Two tables translate: their words are collected from the manuals of FreeSASA, MSMS,
// NanoShaper, PyMOL, MDAnalysis, GROMACS and fpocket and from what their users ask. An advice is
// the whole command, so that it can be copied.
#include "command_line/other_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <sstream>

#include "core/letters.hpp"
#include "mesh/mesh_io.hpp"
#include "structure/reader.hpp"

namespace vdwmesh::apps {
namespace {

// What is typed elsewhere (`there`), as bare() spells it, and what is typed here.
//
// Of an option, {} in `here` takes the option's value away from behind it: between quotes the value
// is put in its place, elsewhere it is dropped; {1-} is what it leaves of 1. Without {} the value
// stays behind the option. So "" leaves the option out and "{}" the option with its value; `why`
// then says that nothing is lost. Of a verb, {} stands for the words behind it.
struct OtherWord {
  std::string_view there, here, why = {};
};

constexpr std::string_view kNoPoints = "the measures are exact, without points or slices to choose",
                           kKept = "hydrogens are kept unless --no-hydrogens is given",
                           kDropped = "waters are left out unless --waters is given",
                           kAssumed = "radii of unknown atoms are told from elements, and counted",
                           kBinary = "PLY and STL are binary files unless --ascii is given",
                           kLengths = "files are in Å; --scale 0.1 writes nm, --scale 1e-7 mm",
                           kAlone = "a structure stands alone, without an option";

constexpr OtherWord kOptions[] = {
    {"probe-radius", "--probe"},
    {"solvent-radius", "--probe"},
    {"probe-size", "--probe"},
    {"probe-rad", "--probe"},
    {"rprobe", "--probe"},
    {"p", "--probe"},
    {"chain", "--select 'chain {}'"},
    {"chains", "--select 'chain {}'"},
    {"auth-chain", "--select 'chain {}'"},
    {"c", "--select 'chain {}'"},
    {"drop-chain", "--select 'not chain {}'"},
    {"dropchain", "--select 'not chain {}'"},
    {"resi", "--select 'resi {}'"},
    {"resid", "--select 'resi {}'"},
    {"residue", "--select 'resi {}'"},
    {"residues", "--select 'resi {}'"},
    {"resn", "--select 'resn {}'"},
    {"resname", "--select 'resn {}'"},
    {"ligand", "--select 'resn {}'"},
    {"selection", "--select"},
    {"sel", "--select"},
    {"atoms", "--select"},
    {"per-residue", "--per-atom - --group residue"},
    {"by-residue", "--per-atom - --group residue"},
    {"residue-areas", "--per-atom - --group residue"},
    {"rsa", "--per-atom - --group residue --radii protor --probe 1.4"},
    {"separate-chains", "--per-atom - --group chain"},
    {"chain-groups", "--per-atom - --group chain{}"},
    {"per-chain", "--per-atom - --group chain"},
    {"csv", "--per-atom"},
    {"o.csv", "--per-atom"},
    {"o.json", "--json"},
    {"sasa", "--surface sas"},
    {"sas", "--surface sas"},
    {"ses", "--surface ses"},
    {"sesa", "--surface ses"},
    {"vdw", "--surface vdw"},
    {"radius-set", "--radii"},
    {"radius", "--radii"},
    {"radii-file", "--radii"},
    {"classifier", "--radii"},
    {"config-file", "--radii"},
    {"keep-water", "--waters"},
    {"keep-waters", "--waters"},
    {"water", "--waters"},
    {"no-water", "", kDropped},
    {"no-waters", "", kDropped},
    {"remove-waters", "", kDropped},
    {"hydrogen", "", kKept},
    {"hydrogens", "", kKept},
    {"no-ligands", "--no-hetatm"},
    {"no-het", "--no-hetatm"},
    {"join-models", "--model all"},
    {"biounit", "--assembly"},
    {"bioassembly", "--assembly"},
    {"biological-assembly", "--assembly"},
    {"grid-spacing", "--spacing"},
    {"grid", "--spacing"},
    {"edge", "--edge-length"},
    {"resolution", "--edge-length"},
    {"n-points", "{}", kNoPoints},
    {"n-slices", "{}", kNoPoints},
    {"n-sphere-points", "{}", kNoPoints},
    {"ndots", "{}", kNoPoints},
    {"shrake-rupley", "", kNoPoints},
    {"lee-richards", "", kNoPoints},
    {"n-threads", "--threads"},
    {"nthreads", "--threads"},
    {"cpus", "--threads"},
    {"jobs", "--threads"},
    {"t", "--threads"},
    {"out", "-o"},
    {"outfile", "-o"},
    {"output-file", "-o"},
    {"of", "-o"},
    {"f", "", kAlone},
    {"if", "", kAlone},
    {"s", "", kAlone},
    {"pdb", "", kAlone},
    {"cif", "", kAlone},
    {"input", "", kAlone},
    {"gpu", "--backend cuda"},
    {"cuda", "--backend cuda"},
    {"cpu", "--backend cpu"},
    {"nm", "--units nm"},
    {"unit", "--units"},
    {"scale-factor", "--scale"},
    {"output-scale", "--scale"},
    {"output-units", "{}", kLengths},
    {"output-unit", "{}", kLengths},
    {"color-by", "--color"},
    {"colour", "--color"},
    {"bfactor", "--b-factor"},
    {"n", "{}", kNoPoints},
    {"transparent", "--transparency"},
    {"opacity", "--transparency '{1-}'"},
    {"alpha", "--transparency '{1-}'"},
    {"outlines", "--outline"},
    {"silhouettes", "--outline"},
    {"silhouette", "--outline"},
    {"ambient", "--ambient-occlusion"},
    {"ao", "--ambient-occlusion"},
    {"shadows", "--ambient-occlusion"},
    {"soft", "--ambient-occlusion"},
    {"binary", "", kBinary},
    {"unknown", "{}", kAssumed},
    {"cavities", "--voids -"}};

constexpr OtherWord kVerbs[] = {{"sasa", "exact {} --surface sas"},
                                {"sas", "exact {} --surface sas"},
                                {"ses", "exact {} --surface ses"},
                                {"sesa", "exact {} --surface ses"},
                                {"vdw", "exact {}"},
                                {"area", "exact {}"},
                                {"get-area", "exact {}"},
                                {"volume", "exact {}"},
                                {"get-volume", "exact {}"},
                                {"rsa", "exact {} --rsa - --radii protor --surface sas"},
                                {"depth", "exact {} --depth - --surface sas"},
                                {"measure", "exact {}"},
                                {"calc", "exact {}"},
                                {"analyze", "report {}"},
                                {"analyse", "report {}"},
                                {"check", "report {}"},
                                {"surface", "mesh {} -o mesh.ply"},
                                {"convert", "mesh {} -o mesh.ply"},
                                {"triangulate", "mesh {}"},
                                {"draw", "render {} -o picture.png"},
                                {"show", "view {} -o page.html"},
                                {"picture", "render {} -o picture.png"},
                                {"voids", "exact {} --voids -"},
                                {"cavities", "exact {} --voids -"},
                                {"pocket", "pockets {}"},
                                {"contacts", "interface {}"},
                                {"bsa", "interface {}"},
                                {"buriedarea", "interface {}"},
                                {"interfaces", "interface {}"},
                                {"fpocket", "pockets {}"},
                                {"residues", "exact {} --per-atom - --group residue"}};

// The spelling by which options are looked up: "--Probe_Radius" and "probeRadius" are
// "probe-radius".
std::string bare(std::string_view option) {
  std::string name;
  for (const char c : option.substr(std::min(option.find_first_not_of('-'), option.size()))) {
    if (is_capital(c) && !name.empty() && is_small_letter(name.back())) name += '-';
    name += c == '_' ? '-' : c;
  }
  return lower_case(name);
}

// What a number leaves of 1, as a transparency is what an opacity leaves; other text stays.
std::string rest_of_one(const std::string& value) {
  double number = 0;
  const char* end = value.data() + value.size();
  if (std::from_chars(value.data(), end, number).ptr != end) return value;
  return fmt::format("{:.6g}", 1 - number);
}

// The text with the value in place of {}, or what it leaves of 1 in place of {1-}, if that stands
// between quotes; else {} alone is removed.
std::string filled(std::string_view text, const std::string& value) {
  const std::size_t place = text.find('{'), end = text.find('}');
  if (place == text.npos) return std::string(text);
  const bool is_shown = text.find('\'')<place, is_rest = end> place + 1;
  return fmt::format("{}{}{}", text.substr(0, place),
                     is_rest    ? rest_of_one(value)
                     : is_shown ? value
                                : "",
                     text.substr(end + 1));
}

std::string_view first_word(std::string_view text) { return text.substr(0, text.find(' ')); }

// "-o" is known where "--output" is.
bool is_among(std::span<const std::string_view> known, std::string_view option) {
  return std::ranges::find(known, option == "-o" ? "--output" : option) != known.end();
}

// What to type in place of the option, if the verb knows it. The option of an output file is looked
// up with the extension of that file, as "o.csv". A known option behind one dash gets two.
std::optional<OtherWord> said_here(std::string_view option, std::string_view value,
                                   std::span<const std::string_view> known) {
  const std::string name = bare(option);
  const bool is_output = name == "o" || name == "output";
  const std::string there =
      is_output ? fmt::format("o{}", value.substr(std::min(value.rfind('.'), value.size()))) : name;
  const auto entry = std::ranges::find(kOptions, there, &OtherWord::there);
  if (entry != std::end(kOptions)) {
    const std::string_view here = first_word(entry->here);
    if (!here.starts_with('-') || is_among(known, here)) return *entry;
  }
  const auto same = std::ranges::find(known, fmt::format("--{}", name));
  return same == known.end() ? std::nullopt : std::optional(OtherWord{"", *same});
}

}  // namespace

std::string in_shell(const std::string& word) {
  constexpr std::string_view kPlain = "-_./,:=+@%";
  const auto is_plain = [kPlain](char c) {
    return is_letter(c) || is_digit(c) || kPlain.find(c) != kPlain.npos;
  };
  if (std::ranges::all_of(word, is_plain) && !word.empty()) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string advice_on_option(std::string_view command, const std::vector<std::string>& words,
                             std::string_view unknown, std::span<const std::string_view> known) {
  std::string reasons;
  std::vector<std::string> typed;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    const bool has_value = equals != word.npos;
    const std::string next = i + 1 < words.size() ? words[i + 1] : "",
                      value = has_value ? word.substr(equals + 1) : next;
    const auto here = name.starts_with('-') && !is_among(known, name)
                          ? said_here(name, value, known)
                          : std::nullopt;
    if (!here) {
      if (name == unknown) return "";
      typed.push_back(in_shell(word));
      continue;
    }
    const bool takes_value = here->here.find('{') != here->here.npos;
    if (takes_value && value.empty()) return fmt::format("; it is {}", first_word(here->here));
    if (!here->why.empty()) reasons += fmt::format("; {}", here->why);
    typed.push_back(filled(here->here, value));
    if (takes_value && !has_value) ++i;
    if (!takes_value && has_value) typed.push_back(in_shell(value));
  }
  std::erase(typed, "");
  return fmt::format("{}; type: {} {}", reasons, command, fmt::join(typed, " "));
}

std::string advice_on_format(std::string_view command, std::vector<std::string> words,
                             const std::string& format, std::span<const std::string_view> known) {
  if (find_mesh_format("mesh." + format))
    return "; the extension of -o FILE chooses that of a mesh";
  constexpr std::string_view kJson[] = {"--json"}, kCsv[] = {"--csv", "--per-atom"};
  const std::span<const std::string_view> options =
      format == "json" ? std::span(kJson) : std::span(kCsv).first(format == "csv" ? 2 : 0);
  const auto here = std::ranges::find_if(
      options, [known](std::string_view option) { return is_among(known, option); });
  const auto there = std::ranges::find_if(
      words, [](const std::string& word) { return word.starts_with("--format"); });
  if (here == options.end() || there == words.end()) return "";
  if (*there == "--format") words.erase(there + 1);
  there->assign(1, '-');
  words.emplace(there, *here);
  for (std::string& word : words) word = in_shell(word);
  return fmt::format("; type: {} {}", command, fmt::join(words, " "));
}

std::string advice_on_trajectory(const std::vector<std::string>& words) {
  constexpr std::string_view kFrames[] = {".xtc", ".trr", ".dcd", ".nc"},
                             kTopologies[] = {".tpr", ".psf", ".prmtop", ".parm7"};
  // MDAnalysis chooses its reader by these endings, which it takes in any case.
  const auto has = [](std::span<const std::string_view> endings) {
    return [endings](const std::string& word) {
      const std::string small = lower_case(word);
      return std::ranges::any_of(endings,
                                 [&](std::string_view end) { return small.ends_with(end); });
    };
  };
  const auto frames = std::ranges::find_if(words, has(kFrames));
  if (frames == words.end()) return "";
  const auto structure = std::ranges::find_if(words, [&](const std::string& word) {
    return has_structure_extension(word) || has(kTopologies)(word);
  });
  if (structure == words.end())
    return fmt::format("{}: is a trajectory; name its structure as well", *frames);
  return fmt::format(
      "{}: is a trajectory, and Python measures the frames; type: python3 -c 'import sys, "
      "MDAnalysis, vdwmesh; u = MDAnalysis.Universe(*sys.argv[1:]); vdwmesh.trajectory(u, "
      "probe=1.4).save(\"areas.csv\"); vdwmesh.residue_table(u, \"residues.csv\")' {} {}",
      *frames, in_shell(*structure), in_shell(*frames));
}

std::string advice_on_verb(std::string_view program, const std::vector<std::string>& words,
                           std::string_view unknown, const OptionsOfVerb& known_of) {
  const auto entry = std::ranges::find(kVerbs, bare(unknown), &OtherWord::there);
  if (entry == std::end(kVerbs)) return "";
  std::istringstream parts{std::string(entry->here)};
  std::string verb;
  parts >> verb;
  std::vector<std::string> typed;
  for (std::string part; parts >> part;) {
    if (part != "{}")
      typed.push_back(part);
    else if (words.empty())  // a sample makes the advice a command that runs
      typed.insert(typed.end(), {"--sample", "ubiquitin"});
    else
      typed.insert(typed.end(), words.begin(), words.end());
  }
  return advice_on_option(fmt::format("{} {}", program, verb), typed, "", known_of(verb));
}

}  // namespace vdwmesh::apps
