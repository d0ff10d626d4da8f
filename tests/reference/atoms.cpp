#include "reference/atoms.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace vdwmesh::reference {
namespace {

std::ifstream open(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot open " + path.string());
  return in;
}

std::vector<Point> read_pdb(std::istream& in) {
  std::vector<Point> atoms;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("ENDMDL")) break;
    if (!line.starts_with("ATOM  ")) continue;
    atoms.push_back({std::stod(line.substr(30, 8)), std::stod(line.substr(38, 8)),
                     std::stod(line.substr(46, 8))});
  }
  return atoms;
}

std::size_t column_of(const std::vector<std::string>& names, const std::string& name) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return i;
  }
  throw std::runtime_error("no column " + name);
}

// Good for loops whose rows are one line each and whose values hold no blanks.
std::vector<Point> read_mmcif(std::istream& in) {
  std::vector<Point> atoms;
  std::vector<std::string> names;
  std::string model;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word.starts_with("_atom_site.")) names.push_back(word);
    if (word != "ATOM" || names.empty()) continue;
    std::vector<std::string> row{word};
    while (words >> word) row.push_back(word);
    const std::string& number = row.at(column_of(names, "_atom_site.pdbx_PDB_model_num"));
    if (model.empty()) model = number;
    if (number != model) break;
    atoms.push_back({std::stod(row.at(column_of(names, "_atom_site.Cartn_x"))),
                     std::stod(row.at(column_of(names, "_atom_site.Cartn_y"))),
                     std::stod(row.at(column_of(names, "_atom_site.Cartn_z")))});
  }
  return atoms;
}

}  // namespace

std::vector<Point> read_atom_records(const std::filesystem::path& path) {
  std::ifstream in = open(path);
  return path.extension() == ".cif" ? read_mmcif(in) : read_pdb(in);
}

std::vector<Ball> read_xyzr(const std::filesystem::path& path) {
  std::ifstream in = open(path);
  std::vector<Ball> balls;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    Ball b{};
    if (words >> b.center[0] >> b.center[1] >> b.center[2] >> b.radius) balls.push_back(b);
  }
  return balls;
}

}  // namespace vdwmesh::reference
