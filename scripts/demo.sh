#!/usr/bin/env bash
# From a fresh clone to a report: installs what is missing, builds the program alone, and runs the first
# example. Further arguments go to `vdwmesh report`.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/build.sh demo vdwmesh
echo
if [ "$#" -eq 0 ]; then set -- --sample ubiquitin; fi
echo "$ vdwmesh report $*"
exec build/demo/apps/vdwmesh report "$@"
