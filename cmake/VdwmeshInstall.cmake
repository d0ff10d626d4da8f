# Headers, libraries and the package that find_package(vdwmesh) finds. Only the headers listed here
# are for users. They include none of the others: tests/sources checks that, and tests/consumer
# compiles every one of them alone from an installed copy.
set(vdwmesh_rooms core spheres surface structure extract refine complex measures pockets creases excluded remesh interface batch mesh analysis render cuda)
set(core_headers buffer curves_too_close errors host_device monitor sum vec3 workspace)
set(structure_headers molecule polarity radii reader reference_areas residue_classes short_text)
set(spheres_headers cell_list_frame sphere_batch sphere_set)
set(surface_headers indexed_mesh surface_patch vertex_labels)
set(extract_headers batch_extractor extractor field grid sampled_field)
set(refine_headers patch_refiner refiner)
set(measures_headers exact_union frame_measures union_gradients union_measurer)
set(pockets_headers pocket_meshes pocket_tracks pockets probe_scan)
set(creases_headers exact_mesher)
set(excluded_headers excluded_bounds excluded_comparison excluded_distances excluded_gradients excluded_measurer excluded_measures excluded_mesher two_probe_shell)
set(interface_headers complementarity excluded_burial interfaces)
set(remesh_headers surface_remesher)
set(batch_headers batch molecule_spheres structure_source)
set(mesh_headers element_color mesh_io surface_mesh)
set(analysis_headers comparison convergence distance_measurer distances exposure mesh_measures quality_histograms
    signed_distance study)
set(render_headers camera color_map color_scale crease_split picture renderer surface_source
    surface_vertex)
set(cuda_headers backend backend_choice on_device)
foreach(room core spheres surface structure extract refine measures pockets creases excluded remesh interface batch mesh analysis render cuda)
  set(folder "${PROJECT_SOURCE_DIR}/src/${room}")
  if(room STREQUAL "cuda")
    set(folder "${PROJECT_SOURCE_DIR}/cuda")
  endif()
  list(TRANSFORM ${room}_headers REPLACE "(.+)" "${folder}/\\1.hpp" OUTPUT_VARIABLE headers)
  list(APPEND public_headers ${headers})
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vdwmesh/${room} COMPONENT development)
endforeach()
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/vdwmesh")
install(EXPORT vdwmeshTargets NAMESPACE vdwmesh:: DESTINATION "${package_dir}" COMPONENT development)
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/vdwmeshConfig.cmake.in"
                              "${PROJECT_BINARY_DIR}/vdwmeshConfig.cmake"
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/vdwmeshConfigVersion.cmake"
                                 COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/vdwmeshConfig.cmake"
              "${PROJECT_BINARY_DIR}/vdwmeshConfigVersion.cmake"
        DESTINATION "${package_dir}" COMPONENT development)
