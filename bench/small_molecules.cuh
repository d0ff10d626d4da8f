// A small molecule a thousand times: one after another, and in one batch.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <vector>

#include "cuda/backend.hpp"
#include "cuda/extract/batch_on_device.cuh"
#include "extract/field_list.hpp"

namespace vdwmesh {

inline constexpr int kRepeats = 9;

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

inline double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// A molecule many times, one after another: from a list on the device, and with the list made on
// the host and uploaded each time. ms each, of the wall.
inline void report_small(const char* name, const SphereSet& spheres) {
  constexpr int times = 1000;
  const Stream stream;
  for (const FieldKind kind : {FieldKind::vdw, FieldKind::blinn}) {
    ExtractOptions options;
    options.field.kind = kind;
    const GridSpec grid = make_grid(spheres, options.grid);
    const FieldModel model = make_field_model(options.field, grid);
    const CellList list = make_field_list(spheres, model);
    const DeviceCellList device_list(list.view(), stream.get());
    const auto extract = [&](const CellListView& view) {
      return extract_on_device(view, model, options, stream).mesh.triangle_count();
    };
    std::uint64_t triangles = extract(device_list.view());
    const double alone = seconds_of([&] {
      for (int i = 0; i < times; ++i) triangles = extract(device_list.view());
    });
    const double with_list = seconds_of([&] {
      for (int i = 0; i < times; ++i) {
        const CellList own = make_field_list(spheres, model);
        extract(DeviceCellList(own.view(), stream.get()).view());
      }
    });
    std::printf("%-12s %s, T %llu, %d one after another: %.3f ms each, %.3f with their lists\n",
                name, kind == FieldKind::vdw ? "vdw" : "blinn",
                static_cast<unsigned long long>(triangles), times, alone / times * 1e3,
                with_list / times * 1e3);
  }
}

// The same molecule in one batch: from a stack on the device, with the cell lists made on the host
// and uploaded each time, and into host memory. ms each, of the wall.
inline void report_batch(const char* name, const SphereSet& spheres) {
  constexpr std::size_t times = 1000;
  std::vector<Sphere> all;
  std::vector<std::size_t> offsets(1, 0);
  for (std::size_t i = 0; i < times; ++i) {
    all.insert(all.end(), spheres.spheres().begin(), spheres.spheres().end());
    offsets.push_back(all.size());
  }
  const Stream stream;
  for (const FieldKind kind : {FieldKind::vdw, FieldKind::blinn}) {
    ExtractOptions options;
    options.field.kind = kind;
    const FieldModel model = make_field_model(options.field, make_grid(spheres, options.grid));
    const CellList list = make_field_list(spheres, model);
    const std::vector<HostField> fields(times, {model, list.view()});
    const DeviceFieldStack stack(fields, stream);
    std::vector<double> alone, upload, whole;
    ExtractTimings timings;
    std::uint64_t triangles = 0;
    BatchExtraction result;
    const auto extractor = make_batch_extractor(Backend::cuda);
    for (int i = 0; i <= kRepeats; ++i) {
      const double extracting = seconds_of([&] {
        const StackExtraction e = extract_stack_on_device(stack, options, stream);
        triangles = e.meshes.triangle_count();
        timings = e.timings;
      });
      const double uploading = seconds_of([&] { const DeviceFieldStack again(fields, stream); });
      const double to_host = seconds_of([&] {
        extractor->extract_into(result, {{all.data(), all.size(), offsets}}, options);
      });
      if (i == 0) continue;
      alone.push_back(extracting);
      upload.push_back(uploading);
      whole.push_back(to_host);
    }
    const auto each = [](const std::vector<double>& seconds) {
      return median(seconds) / static_cast<double>(times) * 1e3;
    };
    std::printf(
        "%-12s %s, T %llu, a batch of %zu: %.4f ms each on the device, uploaded in %.4f; atoms to "
        "meshes in host memory %.4f (download %.4f)\n"
        "    of all: search %.3f  count %.3f  scan %.3f  vertices %.3f  triangles %.3f ms\n",
        name, kind == FieldKind::vdw ? "vdw" : "blinn", static_cast<unsigned long long>(triangles),
        times, each(alone), each(upload), each(whole),
        result.stats.download_seconds / static_cast<double>(times) * 1e3,
        static_cast<double>(timings.search), static_cast<double>(timings.count),
        static_cast<double>(timings.scan), static_cast<double>(timings.vertices),
        static_cast<double>(timings.triangles));
  }
}

}  // namespace vdwmesh
