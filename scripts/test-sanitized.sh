#!/usr/bin/env bash
# Tests under the sanitizers.
#   scripts/test-sanitized.sh fuzz     every fuzz target for some seconds, where Clang 19 is or can be
#                                      installed
#   scripts/test-sanitized.sh asan     the tests with the label `quick`
# CI runs both.
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
  *) echo "usage: scripts/test-sanitized.sh fuzz | asan" >&2; exit 1 ;;
esac
label=$([ "$1" = fuzz ] && echo fuzz || echo quick)
exec ctest --test-dir "build/$1" --output-on-failure --parallel "$(nproc)" -L "^$label\$"
