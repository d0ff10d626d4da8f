# A tree that was configured without a CUDA compiler finds one that is installed later:
# vdwmesh_detect_cuda() is called again and again with the same cache.
cmake_minimum_required(VERSION 3.25)
set(CMAKE_MODULE_PATH "${CMAKE_CURRENT_LIST_DIR}/modules" "${CMAKE_CURRENT_LIST_DIR}/../../cmake")
include(VdwmeshRooms)

# What only a project can do.
function(enable_language)
endfunction()
function(find_package)
endfunction()

set(VDWMESH_CUDA AUTO)
foreach(compiler_is_there OFF OFF ON ON)
  vdwmesh_detect_cuda()
  if(NOT VDWMESH_WITH_CUDA STREQUAL compiler_is_there)
    message(FATAL_ERROR "a compiler is there: ${compiler_is_there}; found: ${VDWMESH_WITH_CUDA}")
  endif()
endforeach()
