// VDWMESH_MULTIVERSION: compiles a function for two processor generations (GCC on x86-64).
//
// The "default" version runs on every x86-64 processor; in it std::fma is a library call. The
// x86-64-v3 version (AVX2 and FMA) computes std::fma in one instruction. When the program starts,
// the loader chooses the version for the processor (target_clones). Both versions give the same
// bits, because every fma in the sources is written out and the compiler may not form others.
//
// The attribute `flatten` inlines everything that the function calls. Each version thus contains
// its whole loop, and no code for the newer processor is emitted as a function that others share.
// With VDWMESH_PLAIN_LOOPS there is only the default version; a test compares results with it.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(VDWMESH_PLAIN_LOOPS)
#define VDWMESH_TWO_VERSIONS
#define VDWMESH_MULTIVERSION __attribute__((flatten, target_clones("default", "arch=x86-64-v3")))
#else
#define VDWMESH_MULTIVERSION
#endif
