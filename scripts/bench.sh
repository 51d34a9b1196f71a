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

# engine_rows FILTER COMMAND...: the medians and the scatter of the rows, sorted by name.
engine_rows() {
  "${@:2}" "$folder/engine_benchmark" --benchmark_filter="$1" --benchmark_repetitions=9 \
    --benchmark_enable_random_interleaving=true --benchmark_min_time=0.05 \
    --benchmark_report_aggregates_only=true | grep -E '^Benchmark|_median|_cv' | LC_ALL=C sort
}

core=$(taskset -pc $$ | sed 's/.*: //; s/[,-].*//')
echo "== engine_benchmark on core $core"
engine_rows -threads: taskset -c "$core"
echo "== scheduler_benchmark on core $core"
taskset -c "$core" "$folder/scheduler_benchmark"
if (($(nproc) > 1)); then
  echo "== engine_benchmark on all cores"
  engine_rows threads:
fi
