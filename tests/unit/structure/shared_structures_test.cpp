// Every structure beside the project: against its README's counts, against the reference spheres,
// and, for alternate locations, against a plain reading of the columns.
#include <gmock/gmock.h>

#include <charconv>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "structure/reference_spheres.hpp"
#include "structure/temp_file.hpp"
#include "support/sanitized.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::HasSubstr;

std::string molecule_path(const std::string& name) {
  for (const char* folder : {"thesis/", "special/", "large/"})
    for (const char* extension : {".pdb", ".cif", ".cif.gz"}) {
      const std::string path = std::string("molecules/") + folder + name + extension;
      if (std::filesystem::exists(shared_path(path))) return path;
    }
  return "molecules/" + name;
}

// The references are made with the first alternate location of each atom; these have none, or have
// the same atoms either way.
class ReferenceSpheres : public ::testing::TestWithParam<std::string> {};

TEST_P(ReferenceSpheres, AreReadFromTheStructure) {
  std::string reference = "reference/" + GetParam() + ".xyzr";
  if (!std::filesystem::exists(shared_path(reference))) reference += ".gz";
  VDWMESH_NEEDS_SHARED(reference);
  const std::string path = molecule_path(GetParam());
  VDWMESH_NEEDS_SHARED(path);
  const Molecule molecule = read_structure(shared_path(path));
  expect_account_adds_up(molecule);
  EXPECT_TRUE(spheres(molecule) == spheres(read_structure(shared_path(reference))));
}

INSTANTIATE_TEST_SUITE_P(All, ReferenceSpheres,
                         ::testing::Values("110D", "133D", "1BK2", "1CKB", "1CRN", "1F2N", "1F4K",
                                           "1HH0", "1L2Y", "1QL2", "1QL2_chainA", "1UBQ", "4HHB",
                                           "4INS", "4PTI", "6ZU5", "2spheres", "3spheres",
                                           "benzene", "cube"),
                         [](const auto& info) { return "of_" + info.param; });

// A row of the table in molecules/README.md.
struct Counted {
  std::string path;
  std::uint64_t atom, hetatm, water, hydrogen;
};

std::vector<Counted> counted_files() {
  std::ifstream readme(shared_path("molecules/README.md"));
  std::vector<Counted> rows;
  for (std::string line; std::getline(readme, line);) {
    Counted row{};
    char path[256], bar;
    if (std::sscanf(line.c_str(), "| %255s | %lu | %lu (%lu) | %lu %c", path, &row.atom,
                    &row.hetatm, &row.water, &row.hydrogen, &bar) != 6)
      continue;
    row.path = path;
    rows.push_back(row);
  }
  return rows;
}

// Files whose elements cannot be told (element columns "A", "XXX"), and a tar archive.
const std::set<std::string> kRefused{"odd/chemfiles_end-endmdl.pdb",
                                     "odd/chemfiles_insertion-code.pdb",
                                     "odd/mda_cryst_then_model.pdb"};

// Two models of which only the second is marked; the table takes them for one.
constexpr const char* kUnmarkedModel = "odd/pdbtools_ensemble_error_2.pdb";

std::uint64_t count_of(const Molecule& molecule, const std::string& reason) {
  const auto found = molecule.skipped.find(reason);
  return found == molecule.skipped.end() ? 0 : found->second;
}

std::uint64_t first_model(const Molecule& molecule) {
  return molecule.atoms_read - count_of(molecule, "other_models");
}

std::uint64_t dropped(const std::filesystem::path& path, const char* reason,
                      Inclusion ReadOptions::*kind) {
  ReadOptions options;
  options.waters = Inclusion::keep;
  options.*kind = Inclusion::drop;
  try {
    const Molecule molecule = read_structure(path, options);
    expect_account_adds_up(molecule);
    return count_of(molecule, reason);
  } catch (
      const InvalidInput& error) {  // all of them: "none of its 2 atoms is left (dropped: 2 ..."
    EXPECT_THAT(error.what(), HasSubstr("is left"));
    const std::string text = error.what();
    const std::size_t end = text.find(std::string(" ") + reason);
    const std::size_t begin = end == std::string::npos ? end : text.rfind(' ', end - 1);
    return begin == std::string::npos ? 0 : std::stoull(text.substr(begin + 1));
  }
}

TEST(SharedStructures, HoldWhatTheirTableCounts) {
  VDWMESH_NEEDS_SHARED("molecules/README.md");
  const std::vector<Counted> files = counted_files();
  EXPECT_GE(files.size(), 60U);
  for (const Counted& file : files) {
    SCOPED_TRACE(file.path);
    if (kRefused.count(file.path) != 0 || file.path == kUnmarkedModel) continue;
    // Large, and read by other tests here.
    if (kSanitized && file.path.ends_with(".cif.gz")) continue;
    const auto path = shared_path("molecules/" + file.path);
    const Molecule molecule = read_structure(path);
    expect_account_adds_up(molecule);
    EXPECT_EQ(first_model(molecule), file.atom + file.hetatm);
    EXPECT_EQ(dropped(path, "hetatm", &ReadOptions::hetero_atoms), file.hetatm);
    const bool counts_hydrogens = molecule.format != "pqr";
    if (counts_hydrogens) {
      EXPECT_EQ(dropped(path, "hydrogens", &ReadOptions::hydrogens), file.hydrogen);
    }
    EXPECT_GE(count_of(molecule, "waters"), file.water);  // counted there among HETATM only
    if (file.water != 0) {
      EXPECT_EQ(count_of(molecule, "waters"), file.water);
    }
  }
}

TEST(SharedStructures, OddFilesReadOrAreRefusedWithOneLine) {
  VDWMESH_NEEDS_SHARED("molecules/odd");
  std::set<std::string> refused;
  for (const auto& entry : std::filesystem::directory_iterator(shared_path("molecules/odd"))) {
    SCOPED_TRACE(entry.path().string());
    try {
      const Molecule molecule = read_structure(entry.path());
      expect_account_adds_up(molecule);
      EXPECT_GT(molecule.atoms.size(), 0U);
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(entry.path().filename().string()));
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      refused.insert("odd/" + entry.path().filename().string());
    }
  }
  std::set<std::string> expected = kRefused;
  expected.insert("odd/biopython_1MOM_min.cif");  // no coordinates in it
  EXPECT_EQ(refused, expected);
}

TEST(SharedStructures, TrajectoryIsRefused) {
  VDWMESH_NEEDS_SHARED("molecules/special/1L2Y.xtc");
  EXPECT_THAT(refusal_of<FileFormatError>(shared_path("molecules/special/1L2Y.xtc")),
              HasSubstr("trajectory"));
  ReadOptions options;
  options.format = StructureFormat::pdb;
  EXPECT_THAT(refusal_of<FileFormatError>(shared_path("molecules/special/1L2Y.xtc"), options),
              HasSubstr("XTC"));
}

// Cut anywhere, a file still reads or is refused; it never crashes.
TEST(SharedStructures, CutFilesReadOrAreRefused) {
  VDWMESH_NEEDS_SHARED("molecules/special/1EJG.cif");
  VDWMESH_NEEDS_SHARED("molecules/thesis/4PTI.pdb");
  const TemporaryDirectory dir;
  for (const char* name : {"special/1EJG.cif", "thesis/4PTI.pdb", "special/1A63.pqr"}) {
    std::ifstream file(shared_path(std::string("molecules/") + name));
    std::stringstream whole;
    whole << file.rdbuf();
    const std::string extension = std::filesystem::path(name).extension().string();
    for (std::size_t size = 0; size < whole.str().size(); size += 4999) {
      try {
        read_structure(dir.write("cut" + extension, whole.str().substr(0, size)));
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
    }
  }
}

// A record of a PDB file, by its columns.
struct Record {
  std::string residue, residue_name, name;
  char label;
  double occupancy;
  std::array<double, 4> sphere;
};

std::vector<Record> records_by_columns(const std::filesystem::path& path) {
  std::vector<Record> records;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.substr(0, 4) != "ATOM" && line.substr(0, 6) != "HETATM") continue;
    if (line.substr(17, 3) == "HOH" || line.substr(17, 3) == "DOD") continue;
    records.push_back({line.substr(21, 6),
                       line.substr(17, 3),
                       line.substr(12, 4),
                       line[16],
                       std::stod(line.substr(54, 6)),
                       {std::stod(line.substr(30, 8)), std::stod(line.substr(38, 8)),
                        std::stod(line.substr(46, 8)), 0}});
  }
  return records;
}

// Per residue, the labels by falling mean occupancy, the first in the file on ties.
std::map<std::string, std::string> ranked_labels(const std::vector<Record>& records) {
  std::map<std::string, std::map<char, std::vector<double>>> occupancies;
  std::map<std::string, std::string> labels;
  for (const Record& record : records) {
    if (record.label == ' ') continue;
    occupancies[record.residue][record.label].push_back(record.occupancy);
    std::string& seen = labels[record.residue];
    if (seen.find(record.label) == std::string::npos) seen += record.label;
  }
  for (auto& [residue, seen] : labels) {
    const auto mean = [&of = occupancies[residue]](char label) {
      const std::vector<double>& values = of[label];
      const double sum = std::accumulate(values.begin(), values.end(), 0.0);
      return std::llround(1e5 * sum / static_cast<double>(values.size()));  // two decimals given
    };
    std::stable_sort(seen.begin(), seen.end(), [&](char a, char b) { return mean(a) > mean(b); });
  }
  return labels;
}

// Atoms without a label, and of each name those of the first label that has it; where residues of
// several names share a number, of the residue of the first label alone.
Spheres positions_by_columns(const std::filesystem::path& path) {
  const std::vector<Record> records = records_by_columns(path);
  const std::map<std::string, std::string> labels = ranked_labels(records);
  const auto rank = [&](const Record& record) {
    return record.label == ' ' ? std::size_t{0} : 1 + labels.at(record.residue).find(record.label);
  };
  std::map<std::string, std::string> name_of;  // of the residue of the first label
  for (const Record& record : records)
    if (rank(record) == 1) name_of[record.residue] = record.residue_name;
  std::map<std::pair<std::string, std::string>, std::size_t> best;
  for (const Record& record : records) {
    if (rank(record) != 0 && record.residue_name != name_of.at(record.residue)) continue;
    const auto [entry, first] = best.try_emplace({record.residue, record.name}, rank(record));
    if (!first) entry->second = std::min(entry->second, rank(record));
  }
  Spheres kept;
  for (const Record& record : records) {
    const auto found = best.find({record.residue, record.name});
    const bool other = rank(record) != 0 && record.residue_name != name_of.at(record.residue);
    if (!other && rank(record) == found->second) kept.push_back(record.sphere);
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

class AlternateLocationsOf : public ::testing::TestWithParam<std::string> {};

TEST_P(AlternateLocationsOf, AgreeWithTheColumns) {
  VDWMESH_NEEDS_SHARED("molecules/" + GetParam());
  const auto path = shared_path("molecules/" + GetParam());
  const Molecule molecule = read_structure(path);
  EXPECT_GT(count_of(molecule, "alternate_locations"), 0U);
  Spheres read = spheres(molecule);
  for (auto& sphere : read) sphere[3] = 0;
  std::sort(read.begin(), read.end());
  EXPECT_TRUE(read == positions_by_columns(path));
}

INSTANTIATE_TEST_SUITE_P(Files, AlternateLocationsOf,
                         ::testing::Values("special/1EJG.pdb", "special/19HC.pdb",
                                           "thesis/4INS.pdb", "thesis/1GZI.pdb", "thesis/1IZH.pdb",
                                           "thesis/1ORC.pdb", "odd/biojava_5pti_old.pdb",
                                           "odd/openmm_altlocs2.pdb"),
                         [](const auto& info) {
                           std::string name;
                           for (const char c : info.param) name += std::isalnum(c) ? c : '_';
                           return name;
                         });

// The capsid file holds the 60 copies of the asymmetric unit.
TEST(SharedStructures, AssemblyOfTheCapsid) {
  VDWMESH_NEEDS_SHARED("molecules/large/1F2N_capsid.cif.gz");
  ReadOptions options;
  options.assembly = "1";
  const Molecule made = read_structure(shared_path("molecules/special/1F2N.pdb"), options);
  const Molecule whole = read_structure(shared_path("molecules/large/1F2N_capsid.cif.gz"));
  EXPECT_EQ(made.atoms.size(), whole.atoms.size());
  EXPECT_EQ(made.atoms_used * 60, made.atoms.size());
  expect_account_adds_up(made);
}

TEST(SharedStructures, AllModelsTogether) {
  VDWMESH_NEEDS_SHARED("molecules/special/1D3Z.pdb");
  ReadOptions options;
  options.model = "all";
  EXPECT_EQ(read_structure(shared_path("molecules/special/1D3Z.pdb"), options).atoms.size(),
            12310U);
  options.model = "10";
  EXPECT_EQ(read_structure(shared_path("molecules/special/1D3Z.pdb"), options).atoms.at(0).model,
            10);
}

}  // namespace
}  // namespace vdwmesh::testing
