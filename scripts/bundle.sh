#!/usr/bin/env bash
# Collects tests, benchmarks and the CLI of a CUDA build, with the shared libraries they need, into
# one folder that runs on a GPU host without the dependencies (x86-64, glibc >= 2.36, NVIDIA driver
# for CUDA 13). For test hosts, not for distribution.
#
#   scripts/bundle.sh DIR [BUILD]     BUILD: a built tree, default build/cuda, whose programs share
#                                     their libraries; a tree without that makes a larger bundle
set -euo pipefail
source_dir=$(cd "$(dirname "$0")/.." && pwd)
target=${1:?usage: scripts/bundle.sh DIR [BUILD]}
build=${2:-$source_dir/build/cuda}
shared=${VDWMESH_SHARED:-$source_dir/../shared}

# The tests that compare backends or try CUDA; other tests need no GPU.
programs=() missing=()
for name in apps/vdwmesh tests/cuda/cuda_{parity,device_test} \
            tests/contract/{exact_mesher_contract,extractor_contract,refiner_contract,properties,union_measurer_contract,excluded_measurer_contract,distance_measurer_contract}_test \
            bench/cuda_bench bench/measurer_bench bench/patches_bench bench/exact_mesh_bench bench/distances_bench \
            bench/excluded_bench bench/extract_survey bench/vdwmesh-bench; do
  if [ -x "$build/$name" ]; then
    programs+=("$build/$name")
  else
    missing+=("$(basename "$name")")
  fi
done
[ "${#missing[@]}" -eq 0 ] || { echo "bundle: not built in $build: ${missing[*]}" >&2; exit 1; }
mkdir -p "$target/bin" "$target/lib" "$target/data"
for program in "${programs[@]}"; do
  install "$program" "$target/bin/"
  strip "$target/bin/$(basename "$program")"
  # Everything but the C library and the driver.
  ldd "$program" | sed -n 's#.* => \(/.*\) (0x[0-9a-f]*)$#\1#p' |
    grep -vE '/(libc|libm|libdl|libpthread|librt|ld-linux-x86-64|libcuda)\.so' |
    while read -r library; do install -m 644 "$library" "$target/lib/"; done
done
strip --strip-unneeded "$target"/lib/*
# The vendor-neutral dispatch of OpenGL and EGL (libglvnd), which is opened by name; an NVIDIA driver
# brings its own half.
if [ -f "$target/lib/libepoxy.so.0" ]; then
  for name in libEGL.so.1 libOpenGL.so.0 libGL.so.1; do
    library=$(/sbin/ldconfig -p | awk -v name="$name" '$1 == name && /x86-64/ && !n++ {print $NF}')
    [ -n "$library" ] || { echo "bundle: no $name; nothing is drawn on that host" >&2; continue; }
    for needed in "$library" $(ldd "$library" | awk '$3 ~ /^\// {print $3}' |
                               grep -vE '/(libc|libm|libdl|libpthread|librt)\.so'); do
      install -m 644 "$needed" "$target/lib/"
    done
  done
fi
if [ -d "$shared/reference" ]; then
  mkdir -p "$target/data/reference"
  cp "$shared"/reference/*.xyzr "$shared"/reference/*.xyzr.gz "$shared"/reference/*.csv \
     "$target/data/reference/"
fi
# The structures of the thesis's tables, which tests read too, and
# `bin/vdwmesh-bench thesis --structures data/molecules/thesis`.
if [ -d "$shared/molecules/thesis" ]; then
  mkdir -p "$target/data/molecules/thesis"
  cp "$shared"/molecules/thesis/*.pdb "$shared"/molecules/thesis/*.cif "$target/data/molecules/thesis/"
fi

cat > "$target/run-tests.sh" <<'RUN'
#!/usr/bin/env bash
# Every test over both backends; a missing device is a failure. Arguments go to every test program.
set -u
here=$(cd "$(dirname "$0")" && pwd)
export LD_LIBRARY_PATH="$here/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
export VDWMESH_REQUIRE_CUDA=1 VDWMESH_SHARED="$here/data"
status=0
for test in "$here"/bin/*_test "$here"/bin/cuda_parity; do
  [ -x "$test" ] || { echo "run-tests: $test is not there" >&2; status=1; continue; }
  echo "== $(basename "$test")"
  "$test" "$@" || status=1
done
exit $status
RUN
cat > "$target/run-bench.sh" <<'RUN'
#!/usr/bin/env bash
# The benchmark of the kernels. Arguments: an option of cuda_bench, files as bare names of
# data/reference/NAME.xyzr or of NAME.xyzr.gz, which is unpacked.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
export LD_LIBRARY_PATH="$here/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
export VDWMESH_SHARED="$here/data"
arguments=()
for argument in "$@"; do
  file=$here/data/reference/$argument.xyzr
  if [ -f "$file.gz" ] && [ ! -f "$file" ]; then gzip -dc "$file.gz" > "$file"; fi
  if [ -f "$file" ]; then arguments+=("$file"); else arguments+=("$argument"); fi
done
exec "$here/bin/cuda_bench" "${arguments[@]}"
RUN
chmod +x "$target"/run-*.sh
size=$(du -sm "$target" | cut -f1)
echo "bundle: $target, $size MB"
[ "$size" -le 60 ] || {
  echo "bundle: larger than 60 MB; the programs of the preset cuda share their libraries" >&2
  exit 1
}
