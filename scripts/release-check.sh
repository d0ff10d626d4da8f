#!/usr/bin/env bash
# Whether this tree can be released: a table with a line for each item of the checklist, what became of it and
# how long it took, and exit code 1 if one fails.
#   scripts/release-check.sh            all of it; needs root for the trials of packages and container
#   scripts/release-check.sh --quick    what needs no building
#   scripts/release-check.sh --no-container    all but the container, in which everything is compiled once more
# The version stands in CMakeLists.txt. To release: set the date in CHANGELOG.md, let this script and .ci/run
# pass, and tag the commit with the version.
set -uo pipefail
cd "$(dirname "$0")/.."

version=$(sed -nE 's/^project\(vdwmesh VERSION ([0-9.]+) .*/\1/p' CMakeLists.txt)
log=$(mktemp)
trap 'rm -f "$log"' EXIT
failed=0

case ${1:-} in
  "" | --quick | --no-container) ;;
  *) echo "release-check: no option $1; there are --quick and --no-container" >&2; exit 1 ;;
esac

row() { printf '%-7s %8s  %s\n' "$1" "$2" "$3"; }
item() {
  local what=$1 begin=$SECONDS result=ok
  shift
  "$@" > "$log" 2>&1 || result=FAILED
  row "$result" "$((SECONDS - begin)) s" "$what"
  [ "$result" = ok ] && return
  tail -15 "$log" | sed 's/^/                  /'
  failed=1
}

tree_is_clean() { git status --porcelain | tee /dev/stderr | wc -l | grep -qx 0; }
tag_is_free() {
  local tag
  tag=$(git tag --list "v$version" "$version")
  [ -z "$tag" ] || [ "$(git rev-parse "$tag^{commit}")" = "$(git rev-parse HEAD)" ]
}
packages_build() { scripts/build-packages.sh; }
lintian_is_silent() {
  lintian --allow-root --fail-on error,warning --tag-display-limit 0 build/package/packages/*.changes
}
programs_say_the_version() {
  build/package/vdwmesh/build/debian/apps/vdwmesh --version | tee /dev/stderr | grep -q "^vdwmesh $version (" &&
    PYTHONPATH=build/package/vdwmesh/build/debian/python /usr/bin/python3 -c "import vdwmesh; assert vdwmesh.__version__ == '$version'"
}
wheel_builds() {
  local folder
  folder=$(mktemp -d)
  /usr/bin/python3 -m pip wheel --no-index --no-deps --wheel-dir "$folder" . && ls "$folder"/vdwmesh-"$version"-*.whl
  local status=$?
  rm -rf "$folder"
  return $status
}
container_works() { scripts/install-deps.sh container && scripts/try-container.sh; }

echo "release-check: version $version, $(git describe --always --dirty)"
row result time step
item "versions agree, and the changelog has a date" python3 -B tests/sources/check_versions.py . --release
item "links between documents" python3 -B tests/sources/check_links.py .
item "sources keep the rules" python3 -B tests/sources/check_sources.py .
item "formatted" env VDWMESH_REQUIRE_PACKAGES=1 scripts/check-format.sh
item "tree is clean" tree_is_clean
item "no other commit has the version's tag" tag_is_free
if [ "${1:-}" != --quick ]; then
  item "packages build" packages_build
  item "programs and Python module say the version" programs_say_the_version
  item "lintian finds nothing" lintian_is_silent
  item "packages work in a bare Debian" scripts/try-packages.sh
  item "wheel builds" wheel_builds
  if [ "${1:-}" = --no-container ]; then
    row "not run" "" "container builds, and works"
  else
    item "container builds, and works" container_works
  fi
fi
row "$([ $failed = 0 ] && echo ok || echo FAILED)" "$SECONDS s" "together"
exit $failed
