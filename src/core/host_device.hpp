// The one place where the code asks whether it is compiled for CUDA: formulas of a few lines are
// written once, marked VDWMESH_HD, and run on host and device alike.
#pragma once

#ifdef __CUDACC__
#define VDWMESH_HD __host__ __device__
#else
#define VDWMESH_HD
#endif
