// The FieldMesher on CUDA.
#include "cuda/cuda_backend.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/memory/device_structures.cuh"
#include "cuda/memory/download.cuh"
#include "extract/blended/field_sample.hpp"
#include "extract/limits.hpp"

namespace vdwmesh {
namespace {

class CudaFieldMesher final : public FieldMesher {
 public:
  SampledField sample(const SphereSet& spheres, const ExtractOptions& options) const override {
    SampledField field;
    field.grid = make_grid(spheres, options.grid);
    const FieldModel model = make_field_model(options.field, field.grid);
    check_sampling(model, options.memory_limit);
    field.isovalue = static_cast<float>(model.isovalue);
    const std::uint64_t nodes = field.grid.node_count();
    const DeviceScope scope;
    require_device_memory(nodes * sizeof(float), "the field", options.device_memory);
    const CellList list = make_field_list(spheres, model);
    const Stream stream;
    const DeviceCellList device_list(list.view(), stream.get());
    const DeviceArray<float> values(nodes, stream.get());
    sample_field_on_device(device_list.view(), model, values.data(), stream);
    field.values.resize(nodes);
    download_parts({{field.values.data(), values.data(), values.bytes()}}, stream);
    return field;
  }

  ExtractResult mesh(const SampledField& field, const ExtractOptions& options) const override {
    check_sampled(field);
    const DeviceScope scope;
    require_device_memory(field.values.size() * sizeof(float), "the field", options.device_memory);
    const Stream stream;
    const DeviceArray<float> values =
        upload(field.values.data(), field.values.size(), stream.get());
    ExtractOptions beside_field = options;
    beside_field.device_memory -= values.bytes();
    const DeviceExtraction extraction =
        mesh_field_on_device({field.grid, values.data(), field.isovalue}, beside_field, stream);
    const DeviceMeshView mesh = extraction.mesh.view();
    if (options.on_size) options.on_size({mesh.vertices, mesh.triangles});
    return {download(mesh, options.connectivity, stream), field.grid, extraction.stats};
  }
};

}  // namespace

std::unique_ptr<FieldMesher> make_cuda_field_mesher() {
  return std::make_unique<CudaFieldMesher>();
}

}  // namespace vdwmesh
