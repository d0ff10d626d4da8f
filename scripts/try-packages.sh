#!/usr/bin/env bash
# Installs the built packages in a bare Debian 12 and uses them there as their users would.
#   scripts/try-packages.sh [FOLDER]     packages, default build/package/packages
# Needs root and debootstrap (scripts/install-deps.sh packages); neither network namespaces nor systemd. The
# bare root is a temporary folder. Where Debian is fetched from, and through which proxy, is what apt of this
# machine says; VDWMESH_TRY_ROOT=FOLDER keeps a bare root between calls, and saves fetching it.
set -euo pipefail
cd "$(dirname "$0")/.."

packages=$(realpath "${1:-build/package/packages}")
[ "$(id -u)" -eq 0 ] || { echo "try-packages: needs root, for chroot" >&2; exit 1; }
command -v debootstrap > /dev/null || {
  echo "try-packages: debootstrap is not installed; see scripts/install-deps.sh packages" >&2
  exit 1
}
for name in vdwmesh vdwmesh-mpi python3-vdwmesh libvdwmesh-dev; do
  [ -n "$(find "$packages" -name "${name}_*.deb")" ] || {
    echo "try-packages: no $name in $packages; build it by cpack --preset package" >&2
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

mirror=$(apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(REPO_URI)' 'Created-By: Packages' |
         awk '$1 == "bookworm" && $2 == "main" {print $3; exit}')
[ -n "$mirror" ] || { echo "try-packages: apt of this machine has no source of bookworm main" >&2; exit 1; }
proxy=$(apt-config dump --format '%v%n' Acquire::http::Proxy)
apt_options=(-o Acquire::http::Proxy="$proxy")

begin=$(seconds)
bare=${VDWMESH_TRY_ROOT:-$work/bare}
if [ ! -f "$bare/etc/debian_version" ]; then
  mkdir -p "$bare"
  http_proxy=$proxy debootstrap --variant=minbase bookworm "$bare" "$mirror" > "$work/debootstrap.log" 2>&1 || {
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
told "$begin" "a bare Debian 12"

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
inside vdwmesh --version
inside vdwmesh report --sample ubiquitin > "$work/report.txt"
grep -E '^(Area|Volume|Topology)' "$work/report.txt"
told "$begin" "vdwmesh report --sample ubiquitin"
# Without what draws, which is recommended only, a picture is refused in a line; with it there is one.
refused=0
inside vdwmesh render --sample bpti --edge-length 1 -o /bpti.png 2> "$work/refused.txt" || refused=$?
[ "$refused" = 2 ] && grep -q '^vdwmesh: no pictures: .*libopengl0' "$work/refused.txt" || {
  echo "try-packages: without libEGL render ended with $refused: $(cat "$work/refused.txt")" >&2
  exit 1
}
begin=$(seconds)
install_packages $(dpkg-deb -f "$packages"/vdwmesh_*.deb Recommends | tr -d ,)
inside vdwmesh render --sample bpti --edge-length 1 -o /bpti.png
told "$begin" "what draws installed, and a picture drawn"
begin=$(seconds)
inside python3 - << 'TOUR'
import vdwmesh
molecule = vdwmesh.sample("ubiquitin")
union = vdwmesh.exact(molecule, topology=True)
assert (round(union.area, 3), round(union.volume, 3)) == (7915.582, 6558.607), (union.area, union.volume)
assert (union.topology.tunnels, union.topology.voids) == (54, 0)
mesh = vdwmesh.mesh(molecule)
print(f"Python {vdwmesh.__version__}: {molecule}, {union.area:.3f} Å², {len(mesh.faces)} triangles")
TOUR
told "$begin" "the beginning of the Python tour"
told "$start" "together, with pictures, without a compiler (wanted: 120 s)"

begin=$(seconds)
install_packages "$(deb vdwmesh-mpi)"
inside env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  mpirun -q --oversubscribe -n 2 vdwmesh-mpi exact --sample ubiquitin | grep -E '^Area'
told "$begin" "vdwmesh-mpi installed, and two processes of it run"

begin=$(seconds)
install_packages "$(deb libvdwmesh-dev)" g++ cmake ninja-build
told "$begin" "library and compiler installed"
begin=$(seconds)
cp -r tests/consumer "$root/consumer"
inside sh -c 'cmake -S /consumer -B /consumer/build -G Ninja > /dev/null && cmake --build /consumer/build' \
  > "$work/build.log" 2>&1 || {
  tail -30 "$work/build.log" >&2
  exit 1
}
inside /consumer/build/consumer
told "$begin" "tests/consumer built against it and run"

begin=$(seconds)
inside apt-get -q -q -y purge vdwmesh vdwmesh-mpi python3-vdwmesh libvdwmesh-dev > "$work/apt.log" 2>&1
left=$(inside find / -xdev -path /packages -prune -o -path /consumer -prune -o -name '*vdwmesh*' -print)
[ -z "$left" ] || { printf 'try-packages: left behind:\n%s\n' "$left" >&2; exit 1; }
told "$begin" "removed without a trace"
echo "try-packages: done"
