// Hot loops in two versions, chosen by the processor at run time: plain x86-64, where std::fma is a
// library call, and x86-64-v3, where it is one instruction. Both give the same bits, because every
// fma is written out and contraction is off. Everything called inside is inlined, so that both
// versions hold whole loops and no function compiled for the newer processor escapes.
// VDWMESH_PLAIN_LOOPS leaves the plain version alone, which a test compares with.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(VDWMESH_PLAIN_LOOPS)
#define VDWMESH_TWO_VERSIONS
#define VDWMESH_MULTIVERSION __attribute__((flatten, target_clones("default", "arch=x86-64-v3")))
#else
#define VDWMESH_MULTIVERSION
#endif
