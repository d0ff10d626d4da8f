#!/usr/bin/env bash
# Installs the built packages in a bare Debian, uses them there as their users would, and runs the tests of
# debian/tests, each with the packages that debian/tests/control names.
#   scripts/try-packages.sh [12|13] [FOLDER]    the version of Debian for which they were built, 12 unless
#                                               named; the packages, default build/package/packages
# Needs root and debootstrap (scripts/install-deps.sh packages); neither network namespaces nor systemd. The
# bare root is a temporary folder. Where Debian is fetched from, and through which proxy, is what apt of this
# machine says; VDWMESH_TRY_ROOT=FOLDER keeps a bare root between calls, and saves fetching it.
set -euo pipefail
cd "$(dirname "$0")/.."

version=${1:-12}
case $version in
  12) suite=bookworm ;;
  13) suite=trixie ;;
  *) echo "try-packages: no Debian $version; there are 12 and 13" >&2; exit 1 ;;
esac
packages=$(realpath "${2:-build/package/packages}")
[ "$(id -u)" -eq 0 ] || { echo "try-packages: needs root, for chroot" >&2; exit 1; }
command -v debootstrap > /dev/null || {
  echo "try-packages: debootstrap is not installed; see scripts/install-deps.sh packages" >&2
  exit 1
}
for name in vdwmesh vdwmesh-mpi python3-vdwmesh libvdwmesh-dev; do
  [ -n "$(find "$packages" -name "${name}_*.deb")" ] || {
    echo "try-packages: no $name in $packages; build it by scripts/build-packages.sh" >&2
    exit 1
  }
done

work=$(mktemp -d)
root=$work/root
clean_up() {
  for folder in proc sys; do
    if mountpoint -q "$root/$folder"; then umount "$root/$folder"; fi
  done
  rm -rf --one-file-system "$work"
}
trap clean_up EXIT
trap 'exit 130' INT TERM

# Runs a command in the root, with an environment of its own.
inside() {
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
    DEBIAN_FRONTEND=noninteractive "$@"
}
install_packages() {
  inside apt-get -q -y "${apt_options[@]}" --no-install-recommends install "$@" > "$work/apt.log" 2>&1 || {
    tail -30 "$work/apt.log" >&2
    exit 1
  }
}
deb() { (cd "$root" && echo ./packages/"$1"_*.deb); }  # as apt inside finds it from /
seconds() { date +%s.%N; }
told() { awk -v from="$1" -v to="$(seconds)" -v what="$2" 'BEGIN {printf "%-52s %6.1f s\n", what, to - from}'; }

# shellcheck disable=SC2016  # apt-get fills in the names
mirror=${VDWMESH_DEBIAN_MIRROR:-$(apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(REPO_URI)' \
  'Created-By: Packages' | awk '$1 ~ /^(bookworm|trixie)$/ && $2 == "main" {print $3; exit}')}
proxy=$(apt-config dump --format '%v%n' Acquire::http::Proxy)
apt_options=(-o Acquire::http::Proxy="$proxy")

begin=$(seconds)
bare=${VDWMESH_TRY_ROOT:-$work/bare}
if [ ! -f "$bare/etc/debian_version" ]; then
  mkdir -p "$bare"
  http_proxy=$proxy debootstrap --variant=minbase "$suite" "$bare" ${mirror:+"$mirror"} > "$work/debootstrap.log" 2>&1 || {
    tail -20 "$work/debootstrap.log" >&2
    exit 1
  }
fi
if [ "$bare" = "$work/bare" ]; then mv "$bare" "$root"; else cp -a "$bare" "$root"; fi
# Where the kernel lets this container mount nothing, the programs have to do without.
mount -t proc proc "$root/proc" 2> /dev/null || echo "try-packages: no /proc in the root"
mount -t sysfs -o ro sysfs "$root/sys" 2> /dev/null || echo "try-packages: no /sys in the root"
mkdir "$root/packages"
cp "$packages"/*.deb "$root/packages"
inside apt-get -q -q "${apt_options[@]}" update
told "$begin" "a bare Debian $version"
git ls-files -z debian/tests tests/consumer | xargs -0 cp --parents -t "$root/packages"
# Runs one of debian/tests in a folder of its own, as autopkgtest does.
try() {
  inside sh -c 'export AUTOPKGTEST_TMP=$(mktemp -d -p /packages) && cd /packages && exec "debian/tests/$1"' sh "$1" \
    > "$work/output.txt" 2>&1 || {
    tail -30 "$work/output.txt" >&2
    exit 1
  }
  grep -vE '^(--|\[)' "$work/output.txt" | tail -4
}

begin=$(seconds)
start=$begin
install_packages "$(deb vdwmesh)" "$(deb python3-vdwmesh)"
told "$begin" "program and Python package installed"
for compiler in cc gcc g++ c++ clang nvcc; do
  if inside sh -c "command -v $compiler" > /dev/null; then
    echo "try-packages: the packages bring $compiler with them" >&2
    exit 1
  fi
done
begin=$(seconds)
try report
told "$begin" "vdwmesh report --sample ubiquitin"
# Without what draws, which is recommended only, a picture is refused in a line; with it there is one.
refused=0
inside vdwmesh render --sample bpti --edge-length 1 -o /bpti.png 2> "$work/refused.txt" || refused=$?
[ "$refused" = 2 ] && grep -q '^vdwmesh: no pictures: .*libopengl0' "$work/refused.txt" || {
  echo "try-packages: without libEGL render ended with $refused: $(cat "$work/refused.txt")" >&2
  exit 1
}
begin=$(seconds)
install_packages $(dpkg-deb -f "$packages"/vdwmesh_*.deb Recommends | tr -d ,) file
try picture
told "$begin" "what draws installed, and a picture drawn"
begin=$(seconds)
try python
told "$begin" "the beginning of the Python tour"
told "$start" "together, with pictures, without a compiler (wanted: 120 s)"

begin=$(seconds)
install_packages "$(deb vdwmesh-mpi)"
try ranks
told "$begin" "vdwmesh-mpi installed, and two processes of it run"

begin=$(seconds)
install_packages "$(deb libvdwmesh-dev)" g++ cmake ninja-build
told "$begin" "library and compiler installed"
begin=$(seconds)
try library
told "$begin" "tests/consumer built against it and run"

begin=$(seconds)
inside apt-get -q -q -y purge vdwmesh vdwmesh-mpi python3-vdwmesh libvdwmesh-dev > "$work/apt.log" 2>&1
left=$(inside find / -xdev -path /packages -prune -o -name '*vdwmesh*' -print)
[ -z "$left" ] || { printf 'try-packages: left behind:\n%s\n' "$left" >&2; exit 1; }
told "$begin" "removed without a trace"
echo "try-packages: done"
