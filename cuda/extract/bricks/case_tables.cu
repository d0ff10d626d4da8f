// Puts the tables of marching cubes into the memory of a device, once for each device: the case
// table, and the codes of its half-edges, which are made here from the case table.
#include <algorithm>
#include <map>
#include <mutex>

#include "cuda/extract/bricks/extract_stages.cuh"
#include "cuda/extract/bricks/triangle_codes.cuh"

namespace vdwmesh {
namespace {

struct Tables {
  CaseTable cases;
  TriangleCodes triangles;
};

HalfEdgeCode code_of(std::uint8_t edge, std::uint8_t across) {
  const CellEdge start = cell_edge(edge);
  const auto row = static_cast<std::uint32_t>(start.y + kBrickReach * start.z);
  const auto column = static_cast<std::uint32_t>(4 * start.x + start.axis);
  int step = 0;
  std::uint32_t opposite = across;
  if (across >= kFirstFaceCode) {
    const int face = (across - kFirstFaceCode) / 4, slot = (across - kFirstFaceCode) % 4;
    step = face % 2 == 0 ? -shell_step(face / 2) : shell_step(face / 2);
    // The cell across the face numbers it from its other side: lower and upper are exchanged.
    opposite = static_cast<std::uint32_t>(kFirstFaceCode + 4 * (face ^ 1) + slot);
  }
  return half_edge_code(row, column, opposite, step);
}

const Tables* tables_on_device() {
  // The map and the tables are never given back: at the end of the process the driver may be gone
  // already.
  static std::mutex* const mutex = new std::mutex;
  static auto* const all = new std::map<int, const Tables*>;
  int device = 0;
  check_cuda(cudaGetDevice(&device), "device");
  const std::lock_guard lock(*mutex);
  const Tables*& tables = (*all)[device];
  if (tables == nullptr) {
    const Tables host{case_table(), make_triangle_codes(case_table())};
    void* memory = nullptr;
    check_cuda(cudaMalloc(&memory, sizeof(Tables)), "case table");
    const cudaError_t status = cudaMemcpy(memory, &host, sizeof(Tables), cudaMemcpyHostToDevice);
    if (status != cudaSuccess) cudaFree(memory);
    check_cuda(status, "case table");
    tables = static_cast<const Tables*>(memory);
  }
  return tables;
}

}  // namespace

TriangleCodes make_triangle_codes(const CaseTable& table) {
  TriangleCodes codes{};
  for (int inside = 0; inside < 256; ++inside) {
    for (int h = 0; h < 3 * table.triangle_count[inside]; ++h) {
      codes.triangle[inside][h / 3].bits |=
          std::uint64_t{code_of(table.edges[inside][h], table.across[inside][h]).bits}
          << kHalfEdgeBits * (h % 3);
    }
    codes.count[inside] = table.triangle_count[inside];
    std::ranges::copy(table.face_half_edge[inside], codes.face_half_edge[inside]);
  }
  for (int x = 0; x < kBrickReach; ++x) {
    for (int axis = 0; axis < 4; ++axis) {
      codes.before[4 * x + axis] = axis < 3 ? crossings_before(x % kBrickSide, axis) : 0;
    }
  }
  return codes;
}

// Only addresses in device memory are computed here.
const CaseTable* case_table_on_device() { return &tables_on_device()->cases; }
const TriangleCodes* triangle_codes_on_device() { return &tables_on_device()->triangles; }

}  // namespace vdwmesh
