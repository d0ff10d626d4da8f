# Man pages and completions of the programs, written at build time from the lists of their verbs and
# options into `manual_dir`, and installed where man, bash and zsh look.
add_executable(vdwmesh_manual manual/manual.cpp)
target_link_libraries(vdwmesh_manual PRIVATE vdwmesh_apps)
vdwmesh_target_warnings(vdwmesh_manual)

set(manual_dir "${CMAKE_CURRENT_BINARY_DIR}/manual")
set(manual_stamp "${CMAKE_CURRENT_BINARY_DIR}/manual.stamp")
set(with_ranks "")
if(VDWMESH_WITH_MPI)
  set(with_ranks --ranks)
endif()
add_custom_command(OUTPUT "${manual_stamp}"
  COMMAND vdwmesh_manual "${manual_dir}" ${with_ranks}
  COMMAND "${CMAKE_COMMAND}" -E touch "${manual_stamp}"
  DEPENDS vdwmesh_manual
  COMMENT "Man pages and completions: ${manual_dir}"
  VERBATIM)
add_custom_target(manual ALL DEPENDS "${manual_stamp}")

set(VDWMESH_BASH_COMPLETION_DIR "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" CACHE STRING
    "Where completions of bash are installed, below the prefix")
set(VDWMESH_ZSH_COMPLETION_DIR "${CMAKE_INSTALL_DATADIR}/zsh/site-functions" CACHE STRING
    "Where completions of zsh are installed, below the prefix")
install(DIRECTORY "${manual_dir}/man1/" DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program
        PATTERN "vdwmesh-mpi*" EXCLUDE)
install(FILES "${manual_dir}/bash/vdwmesh" DESTINATION ${VDWMESH_BASH_COMPLETION_DIR}
        COMPONENT program)
install(FILES "${manual_dir}/zsh/_vdwmesh" DESTINATION ${VDWMESH_ZSH_COMPLETION_DIR}
        COMPONENT program)
if(VDWMESH_WITH_MPI)
  install(DIRECTORY "${manual_dir}/man1/" DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT mpi
          FILES_MATCHING PATTERN "vdwmesh-mpi*")
  install(FILES "${manual_dir}/bash/vdwmesh-mpi" DESTINATION ${VDWMESH_BASH_COMPLETION_DIR}
          COMPONENT mpi)
  install(FILES "${manual_dir}/zsh/_vdwmesh-mpi" DESTINATION ${VDWMESH_ZSH_COMPLETION_DIR}
          COMPONENT mpi)
endif()
