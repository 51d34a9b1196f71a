#!/bin/bash
# Runs the benchmarks one after the other, pinned to the first core that this process may use. Then
# runs engine_benchmark on two cores, if there are two.
#
#   scripts/bench.sh FOLDER_OF_PROGRAMS
set -euo pipefail
folder=$1

shopt -s nullglob
benchmarks=("$folder"/*_benchmark)
if ((${#benchmarks[@]} == 0)); then
  echo "bench: no benchmark was built in $folder" >&2
  exit 1
fi
core=$(taskset -pc $$ | sed 's/.*: //; s/[,-].*//')
for benchmark in "${benchmarks[@]}"; do
  echo "== $(basename "$benchmark") on core $core"
  taskset -c "$core" "$benchmark"
done
if (($(nproc) > 1)); then
  echo "== engine_benchmark on two cores"
  "$folder/engine_benchmark" --threads 2
fi
