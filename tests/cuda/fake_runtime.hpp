// A CUDA runtime of make-believe. fake_runtime.cpp defines the runtime's functions that deal with
// devices, memory and events; a test program that links it calls these in place of the real ones,
// so that devices of any kind and failures of any call can be had, with or without a GPU.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace vdwmesh::testing {

struct FakeDevice {
  std::string name;
  int capability = 90;  // 10 x major + minor
  bool has_pools = true;
  bool runs_ptx = true;     // the build has code that the driver can compile for it
  std::uint64_t keeps = 0;  // release threshold of its pool, bytes
  int thresholds_set = 0, trims = 0;
  cudaComputeMode mode = cudaComputeModeDefault;
  cudaError_t opens = cudaSuccess;  // what cudaSetDevice() answers
  bool reads_pageable_memory = false;
};

struct FakeRuntime {
  int driver = 13000;  // 0: there is no driver
  std::vector<FakeDevice> devices;
  int current = 0;
  cudaError_t last_error = cudaSuccess;
  // Functions that fail: how many calls still succeed, and with what the later ones fail.
  struct Failure {
    int after = 0;
    int times = 1000;
    cudaError_t error = cudaErrorInvalidValue;
  };
  std::map<std::string, Failure> failures;
  int events = 0, locked = 0, allocated = 0;  // created and not yet destroyed
  int stream_waits = 0;                       // calls of cudaStreamSynchronize()
};

// The runtime of this process; assign {} to begin anew.
FakeRuntime& fake_runtime();

}  // namespace vdwmesh::testing
