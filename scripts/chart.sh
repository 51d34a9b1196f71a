#!/bin/bash
# Charts speed against accuracy: every method of computing the pair, from a naive one with fixed
# time steps to the closed form and the limit of rare collisions, and of a small gas. Takes about
# two minutes.
#
#   scripts/chart.sh FOLDER_OF_PROGRAMS
#
# The times are measured on this machine: no other program should be busy.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly RESULTS=chart
export BALLPISTON_PYTHON=${BALLPISTON_PYTHON:-/usr/bin/python3}  # setup.sh installs its libraries
readonly PARAMETERS=(--rho 0.529561127988977 --delta 0.1 --epsilon 0.125 --seconds 1 --seed 0)

printf '\n== ballpiston figure speed-accuracy %s\n' "${PARAMETERS[*]}"
"$1/ballpiston" figure speed-accuracy "${PARAMETERS[@]}" --out "$RESULTS" --progress bar

printf '\n== Done in %d s\n' "$SECONDS"
echo "The picture:  $RESULTS/speed-accuracy.svg"
echo "The numbers:  $RESULTS/speed-accuracy.csv"
