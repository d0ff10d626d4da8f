#!/usr/bin/env bash
# From a fresh clone to a report: installs what is missing, builds, and runs the first example.
# Further arguments go to `vdwmesh report`.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/build.sh release vdwmesh
echo
if [ "$#" -eq 0 ]; then set -- --sample ubiquitin; fi
echo "$ vdwmesh report $*"
exec build/release/apps/vdwmesh report "$@"
