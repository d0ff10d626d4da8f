#!/usr/bin/env bash
# Names the sources that clang-format 14 would change, and fails if there are any. Without that
# version of clang-format it says so and passes; with VDWMESH_REQUIRE_PACKAGES=1 it fails.
set -euo pipefail
cd "$(dirname "$0")/.."

tool=$(command -v clang-format-14 || command -v clang-format || true)
if [ -z "$tool" ] || ! "$tool" --version | grep -q 'version 14\.'; then
  echo "check-format: clang-format 14 is not on this machine; not checked"
  [ "${VDWMESH_REQUIRE_PACKAGES:-0}" = 0 ] || exit 1
  exit 0
fi
git ls-files -z -- '*.cpp' '*.hpp' '*.cu' '*.cuh' | xargs -0 -r "$tool" --dry-run --Werror
echo "check-format: done"
