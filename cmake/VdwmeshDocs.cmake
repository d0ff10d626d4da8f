# The target docs_api writes docs/api/index.html into the build tree, where Doxygen is found: the
# reference of the public headers, under the names by which users include them.
find_program(VDWMESH_DOXYGEN doxygen)
if(PROJECT_IS_TOP_LEVEL AND VDWMESH_DOXYGEN)
  set(api_headers "${PROJECT_BINARY_DIR}/docs/headers")
  file(REMOVE_RECURSE "${api_headers}")
  foreach(header ${public_headers})
    string(REGEX REPLACE ".*/([^/]+/[^/]+)$" "${api_headers}/vdwmesh/\\1" link "${header}")
    cmake_path(GET link PARENT_PATH folder)
    file(MAKE_DIRECTORY "${folder}")
    file(CREATE_LINK "${header}" "${link}" SYMBOLIC)
  endforeach()
  set(api_pages architecture batch certificates excluded_surface glossary exact_mesh refinement distances python robustness
      scale thesis)
  list(TRANSFORM api_pages REPLACE "(.+)" "\"${PROJECT_SOURCE_DIR}/docs/\\1.md\"")
  list(JOIN api_pages " " api_pages)
  configure_file("${PROJECT_SOURCE_DIR}/docs/api/Doxyfile.in" "${PROJECT_BINARY_DIR}/docs/Doxyfile" @ONLY)
  add_custom_target(docs_api
    COMMAND "${CMAKE_COMMAND}" -E rm -rf "${PROJECT_BINARY_DIR}/docs/api"
    COMMAND "${VDWMESH_DOXYGEN}" "${PROJECT_BINARY_DIR}/docs/Doxyfile"
    COMMENT "Reference of the public headers: ${PROJECT_BINARY_DIR}/docs/api/index.html"
    VERBATIM)
endif()
