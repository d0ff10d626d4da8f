// Which program this is. BuildId.cmake writes the definitions.
#pragma once

namespace vdwmesh::apps {

extern const char* const kVersion;  // "0.2.0"
extern const char* const
    kRevision;                    // of the sources, by git or by their hash; differs where they do
extern const char* const kBuild;  // compiler, configuration and CUDA

}  // namespace vdwmesh::apps
