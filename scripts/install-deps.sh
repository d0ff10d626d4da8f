#!/usr/bin/env bash
# Installs the Debian packages that the build and the tests need; a second run installs nothing.
#   scripts/install-deps.sh [GROUP...]
#     program: only what the program itself needs, alone or before other groups
#     browser: Chromium too, which tests the page of a study
#     fuzz: Clang 19 and its runtime too, for the preset fuzz and for clang-tidy
#     witnesses: programs and modules of others too, against which tests check ours
#     viewers: Blender, ParaView and PyMOL too, which tests open files with (1 GB)
#     docs: Doxygen and Python-Markdown too, which the targets docs_api and docs_site need
#     manual: man, groff and zsh too, by which tests read man pages and completions
#     packages: what checks packages for Debian and tries them (scripts/release-check.sh)
#     container: what builds the container where no registry can be reached (scripts/try-container.sh)
#     anchors: VTK and OpenVDB too, which benchmarks compare with (1 GB)
set -euo pipefail

packages=(
  g++ cmake ninja-build ccache pkg-config git ca-certificates
  libopenmesh-dev libcgal-dev libeigen3-dev gemmi-dev tao-pegtl-dev libtbb-dev libtinygltf-dev
  libcli11-dev libfmt-dev nlohmann-json3-dev zlib1g-dev libdeflate-dev libmsgpack-cxx-dev libarchive-dev libjs-vega libjs-three
  libepoxy-dev libegl1 libegl-mesa0 libgl1-mesa-dri libpng-dev libfreetype-dev fonts-dejavu-core
)
# Tests, benchmarks, the program for many processes, the package for Python.
others=(
  libgtest-dev libgmock-dev libbenchmark-dev python3-msgpack python3-jsonschema python3-meshio freesasa valgrind
  libopenmpi-dev openmpi-bin libhdf5-openmpi-dev
  pybind11-dev python3-dev python3-numpy python3-pip python3-venv mypy
)
# Debian 13 has no clang-format 14; scripts/check-format.sh says there that it checks nothing.
if grep -q '^VERSION_ID="12"' /etc/os-release; then others+=(clang-format-14); fi
if [ "${1:-}" = program ]; then shift; else packages+=("${others[@]}"); fi
for group in "$@"; do
  case $group in
    browser) packages+=(chromium chromium-driver python3-selenium python3-pil) ;;
    witnesses)
      packages+=(python3-vtk9 assimp-utils lib3mf1 admesh tetgen gmsh python3-gudhi voronota python3-ase python3-biopython
      python3-mdanalysis python3-mdtraj python3-gemmi python3-freesasa python3-skimage python3-open3d
      parallel snakemake python3-dask python3-mpi4py python3-torch
      libopenmm-dev libopenmm-plugins python3-simtk swig) ;;
    viewers) packages+=(blender paraview pymol) ;;
    docs) packages+=(doxygen python3-markdown) ;;
    manual) packages+=(man-db groff zsh) ;;
    packages) packages+=(dpkg-dev debhelper dh-python file lintian debootstrap) ;;
    container) packages+=(buildah crun debootstrap) ;;
    anchors) packages+=(libvtk9-dev libopenvdb-dev libxml2-dev libjson-c-dev) ;;
    fuzz) packages+=(clang-19 libclang-rt-19-dev clang-tidy-19) ;;
    *) echo "install-deps: no group $group; there are program (first), browser, witnesses, viewers, docs, manual, packages, container, fuzz and anchors" >&2; exit 1 ;;
  esac
done

missing=()
for package in "${packages[@]}"; do
  state=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$state" = installed ] || missing+=("$package")
done
[ "${#missing[@]}" -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || {
    echo "install-deps: missing packages (${missing[*]}), and neither root nor sudo to install them" >&2
    exit 1
  }
  as_root=(sudo)
fi
echo "install-deps: installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
