#!/usr/bin/env bash
# Runs the commands of the task pages, those that take minutes among them, and compares what they print.
#   scripts/run-documents.sh [BUILD]     the build tree is build/release unless named; ../shared has the files
set -euo pipefail
cd "$(dirname "$0")/.."

export VDWMESH_LONG_DOCUMENTS=1 VDWMESH_REQUIRE_SHARED=1 VDWMESH_REQUIRE_PACKAGES=1
exec ctest --test-dir "${1:-build/release}" -R '^cli\.documents$' --timeout 3600 --output-on-failure
