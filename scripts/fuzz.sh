#!/usr/bin/env bash
# Fuzzes the targets of a built fuzz preset and keeps the account of it.
#   scripts/fuzz.sh SECONDS [TARGET...]     each target for so long; all of them unless named
#   scripts/fuzz.sh account                 what was done so far, summed over the runs
# Working corpora, found inputs and the account lie in build/fuzz/fuzzing; FUZZ_BUILD and FUZZ_JOBS
# name another build tree and the number of processes at a time (1), FUZZ_TIMEOUT the seconds that one
# input may take (60; by the clock, so more where the cores are busy).
set -euo pipefail
cd "$(dirname "$0")/.."

build=${FUZZ_BUILD:-build/fuzz}
work=$build/fuzzing
account=$work/account.csv
usage='usage: scripts/fuzz.sh SECONDS [TARGET...] | account'
mkdir -p "$work"
[ -f "$account" ] || echo 'target,cpu_seconds,executions,edges,findings' > "$account"

if [ "${1:?$usage}" = account ]; then
  awk -F, 'NR > 1 {cpu[$1] += $2; runs[$1] += $3; if ($4 > edges[$1]) edges[$1] = $4; found[$1] += $5}
    END {for (t in cpu) printf "%-10s %7.1f CPU min %12d executions %6d edges %3d findings\n",
      t, cpu[t] / 60, runs[t], edges[t], found[t]}' "$account" | sort
  exit 0
fi

# One target; a line of the account.
fuzz_one() {
  local target=$1 seconds=$2 log="$work/$1.log" before after TIMEFORMAT='%U %S'
  mkdir -p "$work/corpus/$target" "$work/found/$target"
  before=$(find "$work/found/$target" -type f | wc -l)
  { time "$build/tests/fuzz/fuzz_$target" -max_total_time="$seconds" \
      "-timeout=${FUZZ_TIMEOUT:-60}" "-report_slow_units=${FUZZ_TIMEOUT:-10}" \
      -rss_limit_mb=2048 -print_final_stats=1 "-artifact_prefix=$work/found/$target/" \
      "$work/corpus/$target" "tests/fuzz/corpus/$target" > "$log" 2>&1 || true; } 2> "$log.time"
  after=$(find "$work/found/$target" -type f | wc -l)
  awk -v target="$target" -v found=$((after - before)) -v time="$(tail -1 "$log.time")" '
    / cov: / {for (i = 1; i < NF; ++i) if ($i == "cov:") edges = $(i + 1); run = substr($1, 2) + 0}
    /stat::number_of_executed_units/ {run = $2}
    END {split(time, cpu, " "); printf "%s,%.1f,%d,%d,%d\n", target, cpu[1] + cpu[2], run, edges, found}
  ' "$log" | tee -a "$account"
}
export -f fuzz_one
export build work account

seconds=$1
shift
if [ "$#" -eq 0 ]; then set -- $(ls tests/fuzz/corpus); fi
printf '%s\n' "$@" | xargs -P "${FUZZ_JOBS:-1}" -I{} bash -c 'fuzz_one "$1" "$2"' _ {} "$seconds"
[ -z "$(find "$work/found" -type f)" ] || { echo "fuzz: found inputs in $work/found"; exit 1; }
