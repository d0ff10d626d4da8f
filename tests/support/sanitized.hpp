// Whether a sanitizer watches, and how many sets a test then looks at.
#pragma once

namespace vdwmesh::testing {

#ifdef VDWMESH_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

// Under a sanitizer `fewer`: they take ten times as long, and do to memory what the others do.
constexpr int sets(int all, int fewer) { return kSanitized ? fewer : all; }

}  // namespace vdwmesh::testing
