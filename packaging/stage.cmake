# Run by CPack once the components are installed into their folders and before they become packages: adds
# to each what Debian wants in every package. These are copyright, changelogs, man pages compressed
# without a time, and the overrides of lintian.
file(STRINGS "${CPACK_VDWMESH_SOURCE_DIR}/CHANGELOG.md" heading REGEX "^## [0-9]" LIMIT_COUNT 1)
if(heading MATCHES "\\(([0-9-]+)\\)")
  set(date "${CMAKE_MATCH_1}")
else()
  set(date now)  # a trial of a version that is not released yet
endif()
execute_process(COMMAND date -u -R -d "${date}" OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE
                COMMAND_ERROR_IS_FATAL ANY)

function(compress file)
  execute_process(COMMAND gzip -9nf "${file}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER "${component}" key)
  set(package "${CPACK_DEBIAN_${key}_PACKAGE_NAME}")
  set(root "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/${component}/usr")
  set(doc "${root}/share/doc/${package}")
  file(MAKE_DIRECTORY "${doc}")
  configure_file("${CPACK_VDWMESH_SOURCE_DIR}/packaging/copyright" "${doc}/copyright" COPYONLY)
  configure_file("${CPACK_VDWMESH_SOURCE_DIR}/CHANGELOG.md" "${doc}/changelog" COPYONLY)
  configure_file("${CPACK_VDWMESH_SOURCE_DIR}/CITATION.cff" "${doc}/CITATION.cff" COPYONLY)
  file(WRITE "${doc}/changelog.Debian"
"vdwmesh (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) bookworm; urgency=medium

  * Version ${CPACK_PACKAGE_VERSION}; the file changelog says what is new.

 -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${date}
")
  file(GLOB pages "${root}/share/man/man1/*.1")
  foreach(file "${doc}/changelog" "${doc}/changelog.Debian" ${pages})
    compress("${file}")
  endforeach()
  configure_file("${CPACK_VDWMESH_SOURCE_DIR}/packaging/lintian-overrides.in"
                 "${root}/share/lintian/overrides/${package}" @ONLY)
endforeach()
