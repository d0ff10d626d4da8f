#!/usr/bin/env bash
# Clones this checkout into a bare Debian, and runs the two commands of README.md there as a new user would.
#   scripts/try-clone.sh [12|13]     the version of Debian, 12 unless named
# Needs root, git and debootstrap (scripts/install-deps.sh packages). Only what is committed is cloned. The root
# is a temporary folder. Debian is fetched from VDWMESH_DEBIAN_MIRROR, or from where apt of this machine fetches
# it, through the proxy of that apt.
set -euo pipefail
cd "$(dirname "$0")/.."

version=${1:-12}
case $version in
  12) suite=bookworm ;;
  13) suite=trixie ;;
  *) echo "try-clone: no Debian $version; there are 12 and 13" >&2; exit 1 ;;
esac
[ "$(id -u)" -eq 0 ] || { echo "try-clone: needs root, for chroot" >&2; exit 1; }
command -v debootstrap > /dev/null || {
  echo "try-clone: debootstrap is not installed; see scripts/install-deps.sh packages" >&2
  exit 1
}

work=$(mktemp -d)
root=$work/root
# shellcheck disable=SC2317  # the trap calls it
clean_up() {
  if mountpoint -q "$root/proc"; then umount -l "$root/proc"; fi
  rm -rf --one-file-system "$work"
}
trap clean_up EXIT
trap 'exit 130' INT TERM

proxy=$(apt-config dump --format '%v%n' Acquire::http::Proxy)
# shellcheck disable=SC2016  # apt-get fills in the names
mirror=${VDWMESH_DEBIAN_MIRROR:-$(apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(REPO_URI)' \
  'Created-By: Packages' | awk '$1 ~ /^(bookworm|trixie)$/ && $2 == "main" {print $3; exit}')}
http_proxy=$proxy debootstrap --variant=minbase "$suite" "$root" ${mirror:+"$mirror"} > "$work/debootstrap.log" 2>&1 || {
  tail -20 "$work/debootstrap.log" >&2
  exit 1
}
if [ -n "$proxy" ]; then echo "Acquire::http::Proxy \"$proxy\";" > "$root/etc/apt/apt.conf.d/proxy"; fi
# Where the kernel lets this container mount nothing, the programs have to do without.
mount -t proc proc "$root/proc" 2> /dev/null || echo "try-clone: no /proc in the root"
git clone -q --no-hardlinks . "$root/vdwmesh"

# Runs a command in the clone, with an environment of its own, and tells how it ended.
status=0
try() {
  local begin=$SECONDS ended=0
  echo "\$ $*"
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
    sh -c 'cd /vdwmesh && exec "$@"' sh "$@" > "$work/output.txt" 2>&1 || ended=$?
  tail -40 "$work/output.txt"
  echo "try-clone: Debian $version: $1 ended with $ended after $((SECONDS - begin)) s"
  [ "$ended" = 0 ] || status=1
}
try scripts/demo.sh
try scripts/test.sh
exit $status
