#!/usr/bin/env bash
# Installs what is missing, builds everything and runs the tests.
#   scripts/test.sh [PRESET] [CTEST OPTION...]     the preset is `release` unless named
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-release}
[ "$#" -eq 0 ] || shift
if [ "$preset" = ci ]; then scripts/check-format.sh; fi
scripts/build.sh "$preset"
exec scripts/run-ctest.sh "build/$preset" "$@"
