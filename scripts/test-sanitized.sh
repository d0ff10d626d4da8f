#!/usr/bin/env bash
# Tests under the sanitizers.
#   scripts/test-sanitized.sh fuzz     every fuzz target for some seconds, where Clang 19 is or can be
#                                      installed
#   scripts/test-sanitized.sh asan     the tests with the label `quick`
#   scripts/test-sanitized.sh program  the tests that drive the program, and those of drawing
# CI runs the first two.
set -euo pipefail
cd "$(dirname "$0")/.."

case ${1:-} in
  fuzz)
    if ! scripts/install-deps.sh fuzz; then
      echo "test-sanitized: no Clang 19 on this machine; not fuzzed"
      exit 0
    fi
    scripts/build.sh fuzz fuzzers ;;
  asan) scripts/build.sh asan quick_tests ;;
  program) scripts/build.sh asan vdwmesh render_test picture_test ;;
  *) echo "usage: scripts/test-sanitized.sh fuzz | asan | program" >&2; exit 1 ;;
esac
case $1 in
  fuzz) build=fuzz tests=(-L '^fuzz$') ;;
  asan) build=asan tests=(-L '^quick$') ;;
  program) build=asan tests=(-L '^(program|drawing)$') ;;
esac
exec scripts/run-ctest.sh "build/$build" "${tests[@]}"
