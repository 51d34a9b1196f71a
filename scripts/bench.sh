#!/bin/bash
# Runs the benchmarks one after the other, pinned to the first core that this process may use. Then
# runs engine_benchmark's rows of several threads, if there are several cores.
#
#   scripts/bench.sh FOLDER_OF_PROGRAMS
#
# Each row of engine_benchmark runs nine times. The repetitions of all rows are in random order, so
# other work on the machine disturbs all rows alike. The coefficient of variation (cv) shows it.
set -euo pipefail
folder=$1

core=$(taskset -pc $$ | sed 's/.*: //; s/[,-].*//')
repeated=(--benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
  --benchmark_min_time=0.05 --benchmark_report_aggregates_only=true)
echo "== engine_benchmark on core $core"
taskset -c "$core" "$folder/engine_benchmark" "${repeated[@]}" --benchmark_filter=-threads:
echo "== scheduler_benchmark on core $core"
taskset -c "$core" "$folder/scheduler_benchmark"
if (($(nproc) > 1)); then
  echo "== engine_benchmark on all cores"
  "$folder/engine_benchmark" "${repeated[@]}" --benchmark_filter=threads:
fi
