# One target per room: vdwmesh_<room>, known outside as vdwmesh::<room>. A static library, or with
# BUILD_SHARED_LIBS a shared one; the objects are the same.
#
#   vdwmesh_add_room(<room> SOURCES <files> [PUBLIC <targets>] [PRIVATE <targets>] [APART <files>]
#                    [OF_PROGRAM])
#
# A room OF_PROGRAM is not for users of the library: find_package(vdwmesh) does not know it.
# APART names the files that vdwmesh_join_sources() cannot join with the others.
function(vdwmesh_add_room room)
  cmake_parse_arguments(ARG "OF_PROGRAM" "" "SOURCES;PUBLIC;PRIVATE;APART" ${ARGN})
  set(target vdwmesh_${room})
  add_library(${target} ${ARG_SOURCES})
  add_library(vdwmesh::${room} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${room} POSITION_INDEPENDENT_CODE ON
    DEFINE_SYMBOL "")
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  vdwmesh_target_warnings(${target})
  if(VDWMESH_JOIN_ROOMS)
    vdwmesh_join_sources(${target} ${ARG_APART})
  endif()
  if(ARG_OF_PROGRAM)
    install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libraries
            ARCHIVE EXCLUDE_FROM_ALL DESTINATION ${CMAKE_INSTALL_LIBDIR})
    return()
  endif()
  install(TARGETS ${target} EXPORT vdwmeshTargets
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libraries)
endfunction()

# Clang's -Wconversion asks for signs too, which GCC's does not, and Clang warns of what std::stable_sort of
# libstdc++ calls inside.
function(vdwmesh_target_warnings target)
  target_compile_options(${target} PRIVATE
    $<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wpedantic;-Wconversion>
    $<$<COMPILE_LANG_AND_ID:CXX,Clang>:-Wno-sign-conversion;-Wno-deprecated-declarations>)
  if(VDWMESH_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Werror>)
  endif()
endfunction()

# For what is compiled to be run once: VDWMESH_QUICK_BUILD in place of the build type's optimisation, and
# sources joined. Not for fuzzers and the rooms they link: with VDWMESH_FUZZ, what guides them is left out, a call at every comparison.
#
#   vdwmesh_build_quickly(<target> [<sources apart>])
function(vdwmesh_build_quickly target)
  if(VDWMESH_QUICK_BUILD)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:${VDWMESH_QUICK_BUILD}>)
    vdwmesh_join_sources(${target} ${ARGN})
  endif()
  if(VDWMESH_FUZZ)
    target_compile_options(${target} PRIVATE -fno-sanitize=fuzzer-no-link)
  endif()
endfunction()

# Compiles the target's sources together, because their headers take longer than they do. Those with a
# name that another has in its anonymous namespace too are compiled apart. Joined sources are named by
# their whole path, which is cut so that objects are the same in every clone. Device code, which newer
# versions of CMake would join as well, is compiled apart.
function(vdwmesh_join_sources target)
  get_target_property(apart ${target} SOURCES)
  list(FILTER apart INCLUDE REGEX "\\.cu$")
  target_compile_options(${target} PRIVATE
    $<$<COMPILE_LANGUAGE:CXX>:-fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=>)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 16)
  set_source_files_properties(${apart} ${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# Sets VDWMESH_WITH_CUDA: whether the CUDA room is built, or the stub in its place.
macro(vdwmesh_detect_cuda)
  set(VDWMESH_WITH_CUDA OFF)
  if(NOT VDWMESH_CUDA STREQUAL "OFF")
    include(CheckLanguage)
    # A compiler that was not there when the tree was first configured may be there now.
    if(NOT CMAKE_CUDA_COMPILER)
      unset(CMAKE_CUDA_COMPILER CACHE)
    endif()
    check_language(CUDA)
    if(CMAKE_CUDA_COMPILER)
      if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
        set(CMAKE_CUDA_ARCHITECTURES "80-real;90-real;90-virtual" CACHE STRING "CUDA architectures")
      endif()
      set(CMAKE_CUDA_RUNTIME_LIBRARY Shared)  # one runtime in a program, whatever its libraries are
      enable_language(CUDA)
      find_package(CUDAToolkit REQUIRED)
      set(VDWMESH_WITH_CUDA ON)
    elseif(VDWMESH_CUDA STREQUAL "ON")
      message(FATAL_ERROR "VDWMESH_CUDA=ON, but no CUDA compiler (nvcc) was found")
    endif()
  endif()
  if(VDWMESH_WITH_CUDA)
    message(STATUS "CUDA backend: built with ${CMAKE_CUDA_COMPILER} for ${CMAKE_CUDA_ARCHITECTURES}")
  else()
    message(STATUS "CUDA backend: stub (no CUDA compiler, or VDWMESH_CUDA=OFF)")
  endif()
endmacro()
