// The rate that floors are reckoned with.
#pragma once

namespace vdwmesh::apps {

// Bytes per second of one core, read and written both counted.
struct CopyRate {
  double warm = 0;   // into memory that has been touched before
  double fresh = 0;  // into pages that the kernel hands out while they are written
};

// Copies 256 MB between blocks far larger than the caches; the best of several runs.
CopyRate measure_copy_rate();

}  // namespace vdwmesh::apps
