# Headers, libraries and the package that find_package(vdwmesh) finds.
foreach(room core structure extract refine arrangement mesh analysis)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/src/${room}"
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vdwmesh
          FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(FILES "${PROJECT_SOURCE_DIR}/cuda/backend.hpp"
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vdwmesh/cuda)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/vdwmesh")
install(EXPORT vdwmeshTargets NAMESPACE vdwmesh:: DESTINATION "${package_dir}")
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/vdwmeshConfig.cmake.in"
                              "${PROJECT_BINARY_DIR}/vdwmeshConfig.cmake"
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/vdwmeshConfigVersion.cmake"
                                 COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/vdwmeshConfig.cmake"
              "${PROJECT_BINARY_DIR}/vdwmeshConfigVersion.cmake"
        DESTINATION "${package_dir}")
