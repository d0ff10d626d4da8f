// The tables of the thesis as printed, and which files stand for their entries.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vdwmesh::apps {

// One cell of a table: a function (4.1 - 4.3) or a number of subdivisions (4.4, 4.5).
struct ThesisFigure {
  std::uint64_t triangles;
  double seconds;
};

struct ThesisEntry {
  std::string id;
  std::uint64_t atoms, voxels;
  std::vector<ThesisFigure> figures;
};

struct ThesisTable {
  std::string name;  // "4.1"
  std::vector<ThesisEntry> entries;
};

inline constexpr std::array<std::string_view, 5> kThesisTables = {"4.1", "4.2", "4.3", "4.4",
                                                                  "4.5"};

// Whether the columns of a table are subdivisions of the van der Waals surface; else functions.
bool is_vdw_table(std::string_view table);
// Whether a table was made on a GPU.
bool is_gpu_table(std::string_view table);

// Precondition: a name of kThesisTables.
ThesisTable thesis_table(std::string_view name);

// The structure that is taken for an entry: the entry itself, or another one that stands in for it.
struct ThesisStructure {
  enum class Kind { original, stand_in };
  std::string id;
  Kind kind;
  std::filesystem::path path;
};
// Nothing where the folder has neither. Throws InvalidInput where there is no such folder.
std::optional<ThesisStructure> find_structure(const std::filesystem::path& folder,
                                              const std::string& entry);

}  // namespace vdwmesh::apps
