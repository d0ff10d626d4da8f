# The target docs_site writes docs/site/index.html into the build tree: all pages of the documentation as HTML that
# opens from files, with the reference by Doxygen, where that is found. The pages are made by python3-markdown, of
# Debian's python3.
#
# The target docs_api writes docs/api/index.html into the build tree, where Doxygen and Debian's python3 are
# found: the reference of the public headers, under the names by which users include them.
find_program(VDWMESH_DOXYGEN doxygen)
find_program(VDWMESH_DOCS_PYTHON NAMES python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(PROJECT_IS_TOP_LEVEL AND VDWMESH_DOXYGEN AND VDWMESH_DOCS_PYTHON)
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

if(PROJECT_IS_TOP_LEVEL AND VDWMESH_DOCS_PYTHON)
  set(site_api)
  if(TARGET docs_api)
    set(site_api --api "${PROJECT_BINARY_DIR}/docs/api")
  endif()
  add_custom_target(docs_site
    COMMAND "${VDWMESH_DOCS_PYTHON}" -B "${PROJECT_SOURCE_DIR}/docs/site/build_site.py"
            "${PROJECT_BINARY_DIR}/docs/site" --version "${PROJECT_VERSION}" ${site_api}
    COMMAND "${VDWMESH_DOCS_PYTHON}" -B "${PROJECT_SOURCE_DIR}/docs/site/check_site.py"
            "${PROJECT_BINARY_DIR}/docs/site"
    COMMENT "Documentation: ${PROJECT_BINARY_DIR}/docs/site/index.html"
    VERBATIM)
  if(TARGET docs_api)
    add_dependencies(docs_site docs_api)
  endif()
endif()
