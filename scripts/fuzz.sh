#!/bin/bash
# Runs fuzz targets one after the other, each with its seeds, and prints a table.
#
#   scripts/fuzz.sh FOLDER_OF_THE_PROGRAM [TARGET...]
#
# FUZZ_RUNS (100000) is the number of executions per target; with FUZZ_SECONDS each target runs for
# that time instead. With the same FUZZ_SEED (1), a number of executions is repeatable. Inputs that
# caused a failure are kept in build/fuzz/found, the other new inputs in build/fuzz/corpus. Exits
# with 1 if any target failed.
set -euo pipefail
program=$1/fuzzer
shift
readonly SEED=${FUZZ_SEED:-1}
limit=(-runs="${FUZZ_RUNS:-100000}")
[[ -z ${FUZZ_SECONDS:-} ]] || limit=(-max_total_time="$FUZZ_SECONDS")
readonly SEEDS=tests/fuzz/seeds CORPUS=build/fuzz/corpus FOUND=build/fuzz/found
# Longer inputs find nothing new.
declare -A max_len=([stored_fold]=3000 [log_line]=64 [access_list]=320 [number_list]=80
                    [server_address]=160)
readonly MAX_LEN=300
# Stacks of allocations, and a long quarantine of freed memory, would take most of the time.
export ASAN_OPTIONS=malloc_context_size=0:quarantine_size_mb=1:thread_local_quarantine_size_kb=64:max_malloc_fill_size=16
export UBSAN_OPTIONS=print_stacktrace=1

targets=("$@")
if ((${#targets[@]} == 0)); then
  list=$("$program" --list)
  mapfile -t targets <<<"$list"
fi
mkdir -p "$FOUND"
failed=0
printf '%-20s %12s %8s %7s %7s  %s\n' target executions exec/s cov inputs result
for target in "${targets[@]}"; do
  export FUZZ_TARGET=$target
  log=$FOUND/$target.log
  mkdir -p "$CORPUS/$target"
  "$program" --write_seeds="$SEEDS" "$CORPUS/$target"
  result=ok
  "$program" "${limit[@]}" -seed="$SEED" -max_len="${max_len[$target]:-$MAX_LEN}" -len_control=0 -entropic=0 -timeout=60 \
    -rss_limit_mb=2048 -reload=0 -print_final_stats=1 -verbosity=1 \
    -artifact_prefix="$FOUND/$target-" "$CORPUS/$target" >"$log" 2>&1 || result=FAILED failed=1
  awk -v target="$target" -v result="$result" '
    /^#[0-9]+/ {for (i = 1; i < NF; i++) {if ($i == "cov:") cov = $(i + 1); if ($i == "corp:") corp = $(i + 1)}}
    /^stat::number_of_executed_units:/ {runs = $2}
    /^stat::average_exec_per_sec:/ {speed = $2}
    END {sub("/.*", "", corp)
         printf "%-20s %12d %8d %7d %7d  %s\n", target, runs, speed, cov, corp, result}' "$log"
  [[ $result == ok ]] || grep -m 3 -E "ERROR|runtime error|what\(\)" "$log" || true
done
exit $failed
