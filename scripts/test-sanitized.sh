#!/usr/bin/env bash
# Tests under the sanitizers.
#   scripts/test-sanitized.sh fuzz      every fuzz target for some seconds (preset fuzz; Clang 19)
#   scripts/test-sanitized.sh address   address and undefined behaviour: tests of every room, and every
#                                       fuzz target for some seconds (preset fuzz; Clang 19)
#   scripts/test-sanitized.sh thread    data races: tests of the parallel loops (preset tsan)
# Where Clang 19 cannot be installed the first two do nothing; with VDWMESH_REQUIRE_PACKAGES=1 they fail.
set -euo pipefail
cd "$(dirname "$0")/.."

case ${1:-} in
  fuzz | address)
    if ! scripts/install-deps.sh fuzz; then
      echo "test-sanitized: no Clang 19 on this machine; nothing was tested" >&2
      [ "${VDWMESH_REQUIRE_PACKAGES:-0}" = 0 ] || exit 1
      exit 0
    fi
    preset=fuzz
    if [ "$1" = fuzz ]; then
      targets=(fuzzers) tests=(-L '^fuzz$')
    else
      targets=(fuzzers sanitized_tests) tests=(-L '^(fuzz|sanitized)$')
    fi ;;
  thread) preset=tsan targets=(races_test) tests=(-R '^races_test$') ;;
  *) echo "usage: scripts/test-sanitized.sh fuzz | address | thread" >&2; exit 1 ;;
esac
scripts/build.sh "$preset" "${targets[@]}"
exec scripts/run-ctest.sh "build/$preset" "${tests[@]}"
