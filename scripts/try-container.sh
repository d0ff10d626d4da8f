#!/usr/bin/env bash
# Builds the container of the Containerfile, and uses it as its users would.
#   scripts/try-container.sh [OPTION...]     options for buildah bud, such as --no-cache
# Needs root and buildah (scripts/install-deps.sh container). Base images that are not there are made by
# debootstrap from the source of bookworm that apt of this machine has, so that no registry is asked; layers
# of an earlier call are used again. The image is called localhost/vdwmesh.
set -euo pipefail
cd "$(dirname "$0")/.."

[ "$(id -u)" -eq 0 ] || { echo "try-container: needs root, for chroot" >&2; exit 1; }
command -v buildah > /dev/null || {
  echo "try-container: buildah is not installed; see scripts/install-deps.sh container" >&2
  exit 1
}
export BUILDAH_ISOLATION=chroot  # needs neither namespaces nor cgroups, which this machine may not give
image=localhost/vdwmesh
base=docker.io/library/debian:12
work=$(mktemp -d)
used=()  # containers that buildah made for this script
clean_up() {
  for container in "${used[@]}"; do buildah rm "$container" > /dev/null; done
  rm -rf --one-file-system "$work"
}
trap clean_up EXIT
trap 'exit 130' INT TERM

seconds() { date +%s.%N; }
told() { awk -v from="$1" -v to="$(seconds)" -v what="$2" 'BEGIN {printf "%-52s %6.1f s\n", what, to - from}'; }
container() { buildah from --pull-never "$1"; }  # prints its name

make_base() {
  local mirror made
  mirror=$(apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(REPO_URI)' 'Created-By: Packages' |
           awk '$1 == "bookworm" && $2 == "main" {print $3; exit}')
  [ -n "$mirror" ] || { echo "try-container: apt of this machine has no source of bookworm main" >&2; exit 1; }
  http_proxy=$(apt-config dump --format '%v%n' Acquire::http::Proxy) \
    debootstrap --variant=minbase bookworm "$work/root" "$mirror" > "$work/debootstrap.log" 2>&1 || {
    tail -20 "$work/debootstrap.log" >&2
    exit 1
  }
  tar -C "$work/root" -cf "$work/root.tar" .
  made=$(container scratch)
  used+=("$made")
  buildah add -q "$made" "$work/root.tar" / > /dev/null
  buildah commit -q "$made" "$base" > /dev/null
}

begin=$(seconds)
buildah inspect --type image "$base" > /dev/null 2>&1 || make_base
buildah inspect --type image "$base-slim" > /dev/null 2>&1 || buildah tag "$base" "$base-slim"
told "$begin" "base images"

begin=$(seconds)
buildah bud --pull-never --layers -t "$image" "$@" . > "$work/build.log" 2>&1 || {
  tail -40 "$work/build.log" >&2
  exit 1
}
told "$begin" "image built"

begin=$(seconds)
built=$(container "$image")
used+=("$built")
inside() { buildah run "$built" -- "$@"; }
inside vdwmesh --version
inside vdwmesh report --sample ubiquitin > "$work/report.txt"
grep -E '^(Area|Volume|Topology)' "$work/report.txt"
inside vdwmesh render --sample bpti --edge-length 1 -o /tmp/bpti.png --quiet
inside python3 -c 'import vdwmesh; print("Python:", round(vdwmesh.exact(vdwmesh.sample("ubiquitin")).area, 3), "Å²")'
for compiler in cc gcc g++ cmake; do
  if inside sh -c "command -v $compiler" > /dev/null; then
    echo "try-container: the image has $compiler, which only building needs" >&2
    exit 1
  fi
done
entry=$(buildah inspect --type image --format '{{.OCIv1.Config.Entrypoint}} {{.OCIv1.Config.Cmd}}' "$image")
[ "$entry" = "[vdwmesh] [--help]" ] || { echo "try-container: the image starts $entry" >&2; exit 1; }
told "$begin" "report, picture and Python in it"
echo "try-container: done"
