#!/usr/bin/env bash
# clang-tidy by .clang-tidy, over the sources of a configured build; any finding fails.
#   scripts/check-tidy.sh [BUILD [FILE...]]     build/release and every source of ours unless named
# Without clang-tidy 19 it says so and passes.
set -euo pipefail
cd "$(dirname "$0")/.."

build=${1:-build/release}
[ "$#" -eq 0 ] || shift
tool=$(command -v clang-tidy-19 || true)
[ -n "$tool" ] || { echo "check-tidy: clang-tidy 19 is not on this machine; not checked"; exit 0; }
[ -f "$build/build.ninja" ] || { echo "check-tidy: $build is not configured" >&2; exit 1; }
# Without the compiler cache in front, which clang-tidy would take for the compiler.
ninja -C "$build" -t compdb | sed -E 's#("command": ")[^"]*/ccache #\1#' > "$build/compile_commands.json"
if [ "$#" -eq 0 ]; then mapfile -t files < <(git ls-files -- 'src/*.cpp' 'apps/*.cpp'); else files=("$@"); fi

# With what CMake gives Clang for single files, which a build by another compiler does not say.
check() {
  local extra=()
  case $1 in
    src/structure/cif/mmcif*.cpp) extra=(--extra-arg=-std=c++17) ;;
    src/analysis/survey/cgal_measures.cpp) extra=(--extra-arg=-fdelayed-template-parsing
      --extra-arg=-Wno-delayed-template-parsing-in-cxx20) ;;
  esac
  "$tool" -p "$build" --quiet --warnings-as-errors='*' --extra-arg=-Wno-unknown-warning-option \
    --extra-arg=-fconstexpr-steps=100000000 "${extra[@]}" "$1"
}
export -f check
export tool build
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -I{} bash -c 'check "$1"' _ {}
echo "check-tidy: done, ${#files[@]} files"
