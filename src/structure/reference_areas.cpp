// The reference areas of each radius set, and the search for one. Decimals are those of the source,
// in which the parts of a pair may differ from the total by 0.01 Å².
#include "structure/reference_areas.hpp"

#include <array>
#include <span>
#include <string>
#include <utility>

#include "structure/molecule/standard_names.hpp"

namespace vdwmesh {
namespace {

using ListedAreas = std::pair<std::string_view, ResidueAreas>;

constexpr std::array kProtOr{
    ListedAreas{"ALA", {108.76, 43.96, 64.80, 37.75, 71.01}},
    ListedAreas{"ARG", {238.17, 42.00, 196.17, 165.00, 73.17}},
    ListedAreas{"ASN", {145.01, 41.53, 103.48, 103.46, 41.55}},
    ListedAreas{"ASP", {142.76, 42.29, 100.47, 100.27, 42.49}},
    ListedAreas{"CYS", {132.20, 42.55, 89.66, 92.74, 39.47}},
    ListedAreas{"GLN", {178.83, 42.00, 136.83, 131.85, 46.98}},
    ListedAreas{"GLU", {174.18, 42.00, 132.18, 122.48, 51.70}},
    ListedAreas{"GLY", {81.09, 81.09, 0.00, 44.65, 36.44}},
    ListedAreas{"HIS", {182.97, 39.09, 143.87, 85.94, 97.03}},
    ListedAreas{"ILE", {175.73, 41.49, 134.23, 36.85, 138.87}},
    ListedAreas{"LEU", {179.56, 39.78, 139.78, 37.16, 142.39}},
    ListedAreas{"LYS", {204.98, 42.00, 162.98, 93.88, 111.10}},
    ListedAreas{"MET", {193.10, 42.00, 151.10, 75.48, 117.62}},
    ListedAreas{"PHE", {199.88, 38.43, 161.45, 34.94, 164.94}},
    ListedAreas{"PRO", {137.21, 27.51, 109.70, 16.09, 121.12}},
    ListedAreas{"SER", {118.34, 43.41, 74.93, 71.38, 46.96}},
    ListedAreas{"THR", {140.60, 41.96, 98.64, 66.15, 74.45}},
    ListedAreas{"TRP", {249.19, 42.59, 206.60, 61.64, 187.55}},
    ListedAreas{"TYR", {214.19, 38.43, 175.76, 81.12, 133.07}},
    ListedAreas{"VAL", {151.97, 41.50, 110.46, 36.87, 115.09}},
};

constexpr std::array kNaccess{
    ListedAreas{"ALA", {107.89, 43.94, 63.94, 36.71, 71.17}},
    ListedAreas{"ARG", {238.33, 41.72, 196.61, 161.10, 77.23}},
    ListedAreas{"ASN", {143.97, 41.03, 102.94, 97.83, 46.14}},
    ListedAreas{"ASP", {140.48, 41.76, 98.72, 91.19, 49.29}},
    ListedAreas{"CYS", {134.24, 41.92, 92.33, 36.49, 97.75}},
    ListedAreas{"GLN", {178.24, 41.72, 136.52, 126.35, 51.89}},
    ListedAreas{"GLU", {172.09, 41.72, 130.37, 112.13, 59.96}},
    ListedAreas{"GLY", {80.30, 80.30, 0.00, 42.62, 37.69}},
    ListedAreas{"HIS", {182.75, 38.76, 143.99, 85.61, 97.14}},
    ListedAreas{"ILE", {175.10, 41.16, 133.94, 36.10, 139.00}},
    ListedAreas{"LEU", {178.40, 39.50, 138.90, 36.45, 141.95}},
    ListedAreas{"LYS", {200.21, 41.72, 158.49, 84.31, 115.90}},
    ListedAreas{"MET", {193.72, 41.72, 152.00, 36.45, 157.27}},
    ListedAreas{"PHE", {199.40, 38.12, 161.27, 34.25, 165.14}},
    ListedAreas{"PRO", {135.84, 27.09, 108.76, 15.17, 120.67}},
    ListedAreas{"SER", {116.56, 43.38, 73.18, 68.03, 48.53}},
    ListedAreas{"THR", {139.25, 41.70, 97.55, 63.50, 75.75}},
    ListedAreas{"TRP", {248.97, 42.38, 206.59, 59.83, 189.14}},
    ListedAreas{"TYR", {212.23, 38.13, 174.10, 76.34, 135.89}},
    ListedAreas{"VAL", {151.40, 41.17, 110.23, 36.12, 115.28}},
};

constexpr std::array kOons{
    ListedAreas{"ARG", {235.30, 38.31, 196.99, 125.27, 110.03}},
    ListedAreas{"ASN", {143.47, 38.26, 105.21, 97.51, 45.97}},
    ListedAreas{"ASP", {141.20, 38.87, 102.33, 95.17, 46.03}},
    ListedAreas{"CYS", {140.29, 38.44, 101.85, 98.30, 41.99}},
    ListedAreas{"GLN", {176.23, 38.31, 137.92, 122.17, 54.06}},
    ListedAreas{"GLU", {172.43, 38.31, 134.11, 115.92, 56.51}},
    ListedAreas{"HIS", {180.78, 36.04, 144.74, 73.26, 107.52}},
    ListedAreas{"ILE", {182.12, 37.96, 144.16, 31.67, 150.45}},
    ListedAreas{"LEU", {185.43, 35.34, 150.08, 31.73, 153.69}},
    ListedAreas{"LYS", {205.80, 38.31, 167.49, 78.02, 127.78}},
    ListedAreas{"MET", {201.66, 38.31, 163.35, 78.68, 122.98}},
    ListedAreas{"PHE", {199.28, 35.20, 164.08, 30.08, 169.20}},
    ListedAreas{"PRO", {128.18, 31.08, 97.10, 13.95, 114.23}},
    ListedAreas{"SER", {118.43, 40.20, 78.23, 60.41, 58.02}},
    ListedAreas{"THR", {142.41, 38.32, 104.08, 56.42, 85.99}},
    ListedAreas{"TRP", {247.08, 39.43, 207.65, 52.90, 194.18}},
    ListedAreas{"TYR", {212.31, 35.20, 177.11, 72.41, 139.90}},
    ListedAreas{"VAL", {157.64, 37.96, 119.68, 31.70, 125.94}},
};

std::span<const ListedAreas> references_of(std::string_view radius_set) {
  if (radius_set == "protor") return kProtOr;
  if (radius_set == "naccess") return kNaccess;
  if (radius_set == "oons") return kOons;
  return {};
}

}  // namespace

std::optional<ResidueAreas> reference_areas(std::string_view radius_set, std::string_view residue) {
  const std::string name = standard_residue_name(residue);
  for (const auto& [listed, areas] : references_of(radius_set))
    if (listed == name) return areas;
  return std::nullopt;
}

}  // namespace vdwmesh
