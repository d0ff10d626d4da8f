// Times exact areas and volumes on a CUDA device, and compares them with the CPU ball by ball.
//
//   measurer_bench SPHERES.xyzr [COPIES]
//   measurer_bench --frames SPHERES.xyzr    frames of a trajectory, float32, as Python's `frames`
//   does
//
// The spheres stand COPIES times (6) side by side. Rows: spheres and measures in device memory;
// both in host memory; 10,000 sets of 500 consecutive spheres. The first two also with derivatives,
// in turns with the measures alone. Least of ten runs after two to warm up.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "cuda/backend.hpp"
#include "cuda/measure/device_measures.cuh"
#include "cuda/memory/device.cuh"
#include "measures/frame_measures.hpp"
#include "read_xyzr.hpp"

namespace vdwmesh {
namespace {

std::vector<Sphere> side_by_side(const std::vector<Sphere>& base, std::size_t copies) {
  const Box box = bounding_box(SphereSet(base));
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < copies; ++i) {
    for (Sphere s : base) {
      s.center.x += static_cast<double>(i) * (box.upper.x - box.lower.x);
      spheres.push_back(s);
    }
  }
  return spheres;
}

// Seconds of the fastest run.
template <class Work>
double least_seconds(const Work& work, int warm_up = 2, int runs = 10) {
  double least = 1e300;
  for (int i = 0; i < warm_up + runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    if (i >= warm_up) least = std::min(least, seconds.count());
  }
  return least;
}

void report_on_device(const std::vector<Sphere>& spheres, double probe) {
  const Stream stream;
  const DeviceArray<Sphere> uploaded = upload(spheres.data(), spheres.size(), stream.get());
  const auto size = static_cast<std::uint32_t>(spheres.size());
  const std::uint32_t ends[2] = {0, size};
  const DeviceArray<std::uint32_t> offsets = upload(ends, 2, stream.get());
  const measure::DeviceBatch batch{uploaded.data(), size, offsets.data(), 1};
  measure::MeasureCounts counts{};
  const double cells = least_seconds([&] {
    const measure::BatchCells list(batch, stream);
    stream.wait();
  });
  const double seconds = least_seconds([&] {
    const measure::DeviceMeasures measured = measure_on_device(batch, stream);
    stream.wait();
    check_cuda(cudaMemcpy(&counts, measured.counts.data(), sizeof(counts), cudaMemcpyDefault), "");
  });
  std::printf(
      "probe %.1f  %8zu spheres, device to device  %8.3f ms (cells %.3f)  %6.1f M balls/s; left to "
      "the host %u, large %u\n",
      probe, spheres.size(), 1e3 * seconds, 1e3 * cells, 1e-6 * static_cast<double>(size) / seconds,
      counts.doubtful, counts.large);
}

void report_on_host(const char* name, const SphereBatch& batch, double probe) {
  const auto measurer = make_union_measurer(Backend::cuda);
  BatchMeasures result;
  const double seconds = least_seconds([&] { measurer->measure_into(result, batch); });
  const double fresh = least_seconds([&] { measurer->measure(batch); }, 1, 3);
  std::printf(
      "probe %.1f  %8zu spheres, %s  %8.3f ms (into new memory %.3f)  %6.1f M balls/s; by the "
      "host %llu\n",
      probe, batch.size, name, 1e3 * seconds, 1e3 * fresh,
      1e-6 * static_cast<double>(batch.size) / seconds,
      static_cast<unsigned long long>(result.fallback_spheres));
}

// Seconds of each work's fastest run, in turns.
template <class First, class Second>
std::pair<double, double> least_in_turns(const First& first, const Second& second) {
  double least[2] = {1e300, 1e300};
  for (int i = 0; i < 12; ++i) {
    const int warm_up = i < 2 ? 1 : 0;
    const double seconds[2] = {least_seconds(first, 0, 1), least_seconds(second, 0, 1)};
    for (int k = 0; k < 2 && warm_up == 0; ++k) least[k] = std::min(least[k], seconds[k]);
  }
  return {least[0], least[1]};
}

void print_gradients(const char* name, std::size_t size, double probe,
                     const std::pair<double, double>& seconds) {
  std::printf(
      "probe %.1f  %8zu spheres, %s, measures %8.3f ms, with gradients %8.3f ms (%.3f times)  "
      "%6.1f M balls/s with gradients\n",
      probe, size, name, 1e3 * seconds.first, 1e3 * seconds.second, seconds.second / seconds.first,
      1e-6 * static_cast<double>(size) / seconds.second);
}

// Weights of areas and volumes that differ from ball to ball.
void report_gradients(const std::vector<Sphere>& spheres, double probe) {
  std::vector<double> w;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    w.push_back(0.25 + static_cast<double>(i % 7) / 7);
  }
  const Stream stream;
  const DeviceArray<Sphere> uploaded = upload(spheres.data(), spheres.size(), stream.get());
  const DeviceArray<double> weights = upload(w.data(), w.size(), stream.get());
  const auto size = static_cast<std::uint32_t>(spheres.size());
  const std::uint32_t ends[2] = {0, size};
  const DeviceArray<std::uint32_t> offsets = upload(ends, 2, stream.get());
  const measure::DeviceBatch there{uploaded.data(), size, offsets.data(), 1};
  const BatchWeights both{weights.data(), weights.data()};
  const auto on_device = [&](const BatchWeights* wanted) {
    measure_on_device(there, stream, wanted);
    stream.wait();
  };
  print_gradients("device to device", size, probe,
                  least_in_turns([&] { on_device(nullptr); }, [&] { on_device(&both); }));
  const SphereBatch batch{.spheres = spheres.data(), .size = spheres.size()};
  const auto cuda = make_union_measurer(Backend::cuda), cpu = make_union_measurer(Backend::cpu);
  BatchMeasures measures;
  BatchGradients gradients, expected;
  print_gradients("host to host", size, probe,
                  least_in_turns([&] { cuda->measure_into(measures, batch); },
                                 [&] {
                                   cuda->gradients_into(gradients, batch, {w.data(), w.data()});
                                 }));
  cpu->gradients_into(expected, batch, {w.data(), w.data()});
  double most = 0;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const auto* a = &gradients.per_sphere[i].area_center.x;
    const auto* b = &expected.per_sphere[i].area_center.x;
    for (int k = 0; k < 8; ++k) {
      const double d = std::abs(a[k] - b[k]) / (1 + std::abs(b[k]));
      most = d <= most ? most : d;
    }
  }
  std::printf(
      "probe %.1f  %8u spheres, gradients: largest difference %.1e (1 + size); kinks %llu\n", probe,
      size, most, static_cast<unsigned long long>(gradients.kink_spheres.at(0)));
}

// The largest differences between both backends, as shares of the whole ball.
void report_difference(const SphereBatch& batch, double probe) {
  BatchMeasures cpu, cuda;
  const auto cpu_measurer = make_union_measurer(Backend::cpu);
  const double seconds = least_seconds([&] { cpu_measurer->measure_into(cpu, batch); }, 0, 1);
  make_union_measurer(Backend::cuda)->measure_into(cuda, batch);
  double area = 0, volume = 0;
  std::size_t differ = 0;
  for (std::size_t i = 0; i < batch.size; ++i) {
    const double r = batch.spheres[i].radius, pi = std::numbers::pi;
    const double a = std::abs(cpu.per_sphere[i].area - cuda.per_sphere[i].area) / (4 * pi * r * r);
    const double v =
        std::abs(cpu.per_sphere[i].volume - cuda.per_sphere[i].volume) / (4 * pi / 3 * r * r * r);
    differ += !(a <= 1e-12 && v <= 1e-12);
    area = std::isnan(a) ? a : std::max(area, a);
    volume = std::isnan(v) ? v : std::max(volume, v);
  }
  std::printf(
      "probe %.1f  %8zu spheres, CPU %.1f ms, by its fallback %llu; largest difference %.1e "
      "(area), %.1e (volume), %zu above 1e-12; totals %.16g %.16g\n",
      probe, batch.size, 1e3 * seconds, static_cast<unsigned long long>(cpu.fallback_spheres), area,
      volume, differ, cpu.totals[0].area, cuda.totals[0].area);
}

// Coordinates of frames in which the balls moved by about 0.3 Å.
std::vector<float> jittered(const std::vector<Sphere>& spheres, std::size_t frames) {
  std::mt19937_64 random(1);
  std::normal_distribution<float> move(0, 0.3f);
  std::vector<float> numbers;
  for (std::size_t t = 0; t < frames; ++t) {
    for (const Sphere& s : spheres) {
      for (int axis = 0; axis < 3; ++axis) {
        numbers.push_back(static_cast<float>(s.center[axis]) + move(random));
      }
    }
  }
  return numbers;
}

// Frames per second, `chunk` of them at once.
void report_frames(const std::string& path, double probe) {
  const std::vector<Sphere> spheres = read_xyzr(path.c_str(), probe);
  constexpr std::size_t kFrames = 1024;
  const std::vector<float> numbers = jittered(spheres, kFrames);
  std::vector<double> radii, areas[2];
  for (const Sphere& s : spheres) radii.push_back(s.radius);
  const auto cuda = make_union_measurer(Backend::cuda);
  const auto measure = [&](const UnionMeasurer* measurer, std::size_t chunk, std::size_t frames,
                           std::vector<double>& found) {
    found.clear();
    std::vector<ExactUnion> results;
    for (std::size_t t = 0; t < frames; t += chunk) {
      const std::size_t row = 3 * spheres.size() * sizeof(float);
      FrameOptions options;
      options.measurer = measurer;
      measure_frames(results, radii,
                     {.first = reinterpret_cast<const std::byte*>(numbers.data()) + t * row,
                      .type = CoordinateType::float32,
                      .frames = std::min(chunk, frames - t),
                      .atoms = spheres.size(),
                      .frame_stride = static_cast<std::ptrdiff_t>(row),
                      .atom_stride = 3 * sizeof(float),
                      .axis_stride = sizeof(float)},
                     options);
      for (const ExactUnion& result : results) found.push_back(result.area);
    }
  };
  for (const std::size_t chunk : {16u, 64u, 256u, 1024u}) {
    const double seconds =
        least_seconds([&] { measure(cuda.get(), chunk, kFrames, areas[1]); }, 1, 3);
    std::printf("probe %.1f  frames of %zu, %4zu at once: %9.0f frames/s  %6.1f M balls/s\n", probe,
                spheres.size(), chunk, kFrames / seconds,
                1e-6 * static_cast<double>(kFrames * spheres.size()) / seconds);
  }
  constexpr std::size_t kOnCpu = 256;
  const double seconds = least_seconds([&] { measure(nullptr, 64, kOnCpu, areas[0]); }, 0, 2);
  double difference = 0;
  for (std::size_t t = 0; t < kOnCpu; ++t) {
    difference = std::max(difference, std::abs(areas[1][t] / areas[0][t] - 1));
  }
  std::printf(
      "probe %.1f  frames of %zu, CPU: %9.0f frames/s; largest difference %.1e of the area\n",
      probe, spheres.size(), kOnCpu / seconds, difference);
}

int run(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: measurer_bench SPHERES.xyzr [COPIES] | --frames SPHERES.xyzr\n");
    return 1;
  }
  const DeviceScope device;
  if (std::string(argv[1]) == "--frames" && argc == 3) {
    for (const double probe : {0.0, 1.4}) report_frames(argv[2], probe);
    return 0;
  }
  for (const double probe : {0.0, 1.4}) {
    const std::vector<Sphere> spheres =
        side_by_side(read_xyzr(argv[1], probe), argc > 2 ? std::stoul(argv[2]) : 6);
    const SphereBatch batch{.spheres = spheres.data(), .size = spheres.size()};
    report_difference(batch, probe);
    report_on_device(spheres, probe);
    report_gradients(spheres, probe);
    report_on_host("host to host", batch, probe);
    constexpr std::size_t kSets = 10'000, kSetSize = 500;
    std::vector<Sphere> many;
    std::vector<std::size_t> offsets{0};
    for (std::size_t set = 0; set < kSets; ++set) {
      for (std::size_t i = 0; i < kSetSize; ++i) {
        many.push_back(spheres[(set * kSetSize + i) % spheres.size()]);
      }
      offsets.push_back(many.size());
    }
    report_on_host("10,000 sets, host to host",
                   {.spheres = many.data(), .size = many.size(), .offsets = offsets}, probe);
  }
  return 0;
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  try {
    return vdwmesh::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "measurer_bench: %s\n", error.what());
    return 1;
  }
}
