# Writes OUTPUT, the source file that says which sources the program is built from. Run at every build;
# the file is touched only where what it says has changed, so nothing else is compiled anew.
#
# What it says is `git describe` of a clone without changes. With changes, or without git, a hash of the
# sources goes with it, so that two different programs never go by the same name.
function(hash_sources result)
  file(GLOB_RECURSE files RELATIVE "${SOURCE_DIR}" "${SOURCE_DIR}/CMakeLists.txt"
       "${SOURCE_DIR}/apps/*" "${SOURCE_DIR}/cmake/*" "${SOURCE_DIR}/cuda/*" "${SOURCE_DIR}/data/*"
       "${SOURCE_DIR}/src/*")
  list(SORT files)
  set(hashes "")
  foreach(file IN LISTS files)
    file(SHA256 "${SOURCE_DIR}/${file}" hash)
    string(APPEND hashes "${file} ${hash}\n")
  endforeach()
  string(SHA256 hash "${hashes}")
  string(SUBSTRING "${hash}" 0 12 hash)
  set(${result} "${hash}" PARENT_SCOPE)
endfunction()

# Empty where SOURCE_DIR is not the top of a clone: an archive may lie inside another project's.
function(describe_clone result)
  set(${result} "" PARENT_SCOPE)
  find_program(git git)
  if(NOT git)
    return()
  endif()
  execute_process(COMMAND "${git}" -C "${SOURCE_DIR}" rev-parse --show-prefix
                  OUTPUT_VARIABLE prefix RESULT_VARIABLE failed ERROR_QUIET
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(failed OR prefix)
    return()
  endif()
  execute_process(COMMAND "${git}" -C "${SOURCE_DIR}" describe --always --abbrev=12 --dirty
                  OUTPUT_VARIABLE description RESULT_VARIABLE failed ERROR_QUIET
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT failed)
    set(${result} "${description}" PARENT_SCOPE)
  endif()
endfunction()

describe_clone(revision)
if(revision STREQUAL "")
  hash_sources(hash)
  set(revision "sources-${hash}")
elseif(revision MATCHES "-dirty$")
  hash_sources(hash)
  string(APPEND revision "-${hash}")
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT [[
#include "build_id.hpp"

namespace vdwmesh::apps {
const char* const kVersion = "@VERSION@";
const char* const kRevision = "@revision@";
const char* const kBuild = "@BUILD@";
}  // namespace vdwmesh::apps
]] @ONLY)
