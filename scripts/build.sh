#!/usr/bin/env bash
# Installs what is missing, configures a preset of CMakePresets.json and builds it.
#   scripts/build.sh PRESET [TARGET...]
set -euo pipefail
cd "$(dirname "$0")/.."

preset=$1
shift
if [ "$preset" = demo ]; then scripts/install-deps.sh program; else scripts/install-deps.sh; fi

# nvcc counts where CMake finds it: on the path, in $CUDACXX or in the toolkit's usual folder.
for nvcc in "${CUDACXX:-}" "$(command -v nvcc || true)" /usr/local/cuda/bin/nvcc; do
  if [ -n "$nvcc" ] && [ -x "$nvcc" ]; then
    export CUDACXX=$nvcc
    break
  fi
done
# Device code takes longer to compile than all the rest, and the demo has no use for it without a device.
if [ "$preset" = demo ] && [ ! -e /dev/nvidiactl ]; then
  export VDWMESH_DEMO_CUDA=OFF
  echo "build: no CUDA device on this machine; the demo is built without the CUDA room"
elif [ -n "${CUDACXX:-}" ]; then
  echo "build: CUDA room with $CUDACXX"
else
  echo "build: no nvcc on this machine; the CUDA room is the stub and --backend cuda is refused"
fi

# The CGAL sources take up to 2 GB of memory each to compile.
jobs=$(nproc)
fitting=$(awk '/^MemAvailable:/ {print int($2 / 2000000)}' /proc/meminfo)
[ "$fitting" -ge 1 ] || fitting=1
[ "$jobs" -le "$fitting" ] || jobs=$fitting

# Always configured anew: what was missing at first (nvcc, MPI, libraries for pictures) may be there now.
cmake --preset "$preset"
cmake --build "build/$preset" --parallel "$jobs" ${1:+--target "$@"}
