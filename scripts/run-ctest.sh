#!/usr/bin/env bash
# Runs tests of a built tree, with VDWMESH_CHECK_SKIPS=1 also the check that no test vanished.
#   scripts/run-ctest.sh BUILD [CTEST OPTION...]
set -euo pipefail
cd "$(dirname "$0")/.."

build=$1
shift
results="$(cd "$build" && pwd)/tests.xml"
whole=1000000000  # bytes of output: the check reads what each program says of its skips
status=0
ctest --test-dir "$build" --no-tests=error --output-on-failure --parallel "$(nproc)" --output-junit "$results" \
  --test-output-size-passed $whole --test-output-size-failed $whole "$@" || status=$?
if [ "${VDWMESH_CHECK_SKIPS:-0}" = 1 ]; then tests/check_skips.py "$results" || status=1; fi
exit $status
