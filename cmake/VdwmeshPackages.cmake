# Debian packages by CPack, one of each component: `cmake --preset package`, `cmake --build --preset
# package`, `cpack --preset package`. Libraries are static in them, because the project promises no binary
# interface from version to version; their dependencies come from dpkg-shlibdeps, those of who compiles
# against the library stand here. packaging/stage.cmake adds what Debian wants in every package.
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program development)
if(VDWMESH_WITH_MPI)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
endif()
if(VDWMESH_WITH_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ
    GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PRE_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/packaging/stage.cmake")

set(VDWMESH_PACKAGE_MAINTAINER "The vdwmesh authors <authors@vdwmesh.invalid>" CACHE STRING
    "Who answers for the packages; the project has no mail address of its own")
set(CPACK_PACKAGE_VENDOR "vdwmesh")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${VDWMESH_PACKAGE_MAINTAINER}")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_VDWMESH_SOURCE_DIR "${PROJECT_SOURCE_DIR}")  # for stage.cmake

set(about "vdwmesh makes triangle meshes of the surfaces of molecules and compares
them with the exact area, volume and topology of the union of the atoms'
spheres, which it computes without a mesh.")

# vdwmesh_package(<component> NAME <package> SECTION <section> SUMMARY <line> TEXT <lines>
#                 [DEPENDS <packages>] [RECOMMENDS <packages>] [SUGGESTS <packages>])
macro(vdwmesh_package component)
  cmake_parse_arguments(ARG "" "NAME;SECTION;SUMMARY;TEXT;DEPENDS;RECOMMENDS;SUGGESTS" "" ${ARGN})
  string(TOUPPER "${component}" key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME "${ARG_NAME}")
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION "${ARG_SECTION}")
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${ARG_SUMMARY}\n${about}\n.\n${ARG_TEXT}")
  set(CPACK_DEBIAN_${key}_PACKAGE_DEPENDS "${ARG_DEPENDS}")
  set(CPACK_DEBIAN_${key}_PACKAGE_RECOMMENDS "${ARG_RECOMMENDS}")
  set(CPACK_DEBIAN_${key}_PACKAGE_SUGGESTS "${ARG_SUGGESTS}")
  set(CPACK_DEBIAN_${key}_PACKAGE_SHLIBDEPS ON)
endmacro()

vdwmesh_package(program NAME vdwmesh SECTION science
  SUMMARY "surfaces of molecules as meshes, with proof of how good they are"
  TEXT "This package has the program. Pictures are drawn by OpenGL through EGL,
with Mesa in software where there is no GPU."
  RECOMMENDS "libegl1, libopengl0, libgl1-mesa-dri")
vdwmesh_package(mpi NAME vdwmesh-mpi SECTION science
  SUMMARY "surfaces of very large molecules by many processes (MPI)"
  TEXT "This package has the program vdwmesh-mpi, whose processes make one mesh file
together and measure one molecule together."
  DEPENDS "openmpi-bin" SUGGESTS "vdwmesh")
# The extension is for one version of Python, as Debian has one.
if(VDWMESH_WITH_PYTHON)
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(python_versions "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), \
python3 (<< ${Python_VERSION_MAJOR}.${next_minor})")
endif()
vdwmesh_package(python NAME python3-vdwmesh SECTION python
  SUMMARY "surfaces of molecules from Python: exact measures and meshes"
  TEXT "This package has the module for Python, which works on arrays of NumPy and on
the molecules of MDAnalysis, mdtraj, biotite and gemmi."
  DEPENDS "${python_versions}, python3-numpy"
  SUGGESTS "python3-mdanalysis, python3-mdtraj, vdwmesh")
vdwmesh_package(development NAME libvdwmesh-dev SECTION libdevel
  SUMMARY "surfaces of molecules as meshes: library for C++"
  TEXT "This package has the headers, the static libraries and the package file by
which CMake finds them."
  DEPENDS "libstdc++-12-dev, libcgal-dev, libeigen3-dev, libopenmesh-dev, libtinygltf-dev, libtbb-dev, libfmt-dev, zlib1g-dev, \
libdeflate-dev, libarchive-dev, libpng-dev, libfreetype-dev, libepoxy-dev, libegl-dev, pkg-config"
  SUGGESTS "cmake")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/packaging/postinst"
    "${PROJECT_SOURCE_DIR}/packaging/prerm")
include(CPack)
