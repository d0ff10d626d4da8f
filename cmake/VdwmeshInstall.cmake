# Headers, libraries and the package that find_package(vdwmesh) finds. Only the headers listed here
# are for users; they include none of the others, which the consumer test would notice.
set(core_headers buffer errors host_device monitor sum vec3)
set(structure_headers molecule radii reader)
set(extract_headers extractor field grid indexed_mesh sampled_field sphere_set vertex_labels)
set(refine_headers refiner)
set(arrangement_headers exact_union)
set(mesh_headers element_color mesh_io surface_mesh)
set(analysis_headers comparison convergence distances mesh_measures quality_histograms study)
set(render_headers camera color_map color_scale crease_split picture renderer surface_source
    surface_vertex)
foreach(room core structure extract refine arrangement mesh analysis render)
  list(TRANSFORM ${room}_headers REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/src/${room}/\\1.hpp"
       OUTPUT_VARIABLE headers)
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vdwmesh/${room})
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
