#!/bin/bash
# The paper's sweep with a real server and client, checked against the closed forms.
#
#   scripts/demo.sh FOLDER_OF_PROGRAMS
#
# Computes the three mean free times in equilibrium, and the conditional mean free time at the
# paper's 59 energies, at its rho and three values of delta, with 10^4 first returns each. Prints
# every number with its exact value and z-score, and draws the paper's figure. Fails if the largest
# |z| is too large for the number of z-scores. The numbers depend only on the seed: the demo always
# gives the same result. The model billiard is given, because by default the service would answer
# with the closed forms.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly RESULTS=demo
PATH=$1:$PATH
export BALLPISTON_PYTHON=${BALLPISTON_PYTHON:-/usr/bin/python3}  # for the figure; setup.sh installs its libraries

readonly RHO=0.529561127988977 DELTAS=0.2,0.1,0.05 SEED=1
# n/100, and halvings of 1/100 towards both ends of (0, 1/2).
readonly ENERGIES=0.0003125,0.000625,0.00125,0.0025,0.005,0.01:0.49:49,0.495,0.4975,0.49875,0.499375,0.4996875
readonly COUNT=$((3 * 3 + 3 * 59))  # z-scores in all

headline() { printf '\n== %s\n' "$*"; }

start_server() {
  rm -rf "$RESULTS"
  mkdir -p "$RESULTS"
  data=$(mktemp -d)
  trap stop_server EXIT
  BALLPISTON_SERVER=$(ballpiston server start --data-dir "$data")
  export BALLPISTON_SERVER
}

stop_server() {
  trap - EXIT
  ballpiston server stop --data-dir "$data" || true
  rm -rf "$data"
}

# ask NAME EXPERIMENT FLAG...: submits, watches, prints the table, and keeps the numbers in
# NAME.csv.
ask() {
  local name=$1 job
  shift
  headline "ballpiston submit $*"
  job=$(ballpiston submit "$@")
  ballpiston watch "$job" --progress bar
  ballpiston result "$job" --format table
  ballpiston result "$job" --format csv >"$RESULTS/$name.csv"
}

# The largest of m |z| exceeds the threshold once in a thousand such demos (Bonferroni, two-sided):
# each single |z| exceeds it with probability 1e-3/m.
check_z_scores() {
  awk -F, -v expected="$COUNT" '
    function tail(z,   i, c) {  # P(Z > z), Laplace'"'"'s continued fraction
      c = z
      for (i = 200; i >= 1; --i) c = z + i / c
      return exp(-z * z / 2) / sqrt(8 * atan2(1, 1)) / c
    }
    function threshold(m,   low, high, i) {
      low = 1; high = 20
      for (i = 0; i < 60; ++i) {
        if (2 * m * tail((low + high) / 2) > 1e-3) low = (low + high) / 2; else high = (low + high) / 2
      }
      return high
    }
    FNR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    $column["z_score"] != "" {
      z = $column["z_score"] + 0
      ++m
      sum += z * z
      if (z < 0) z = -z
      if (z > largest) {
        largest = z
        where = $column["name"] " at delta " $column["delta"]
        if ($column["epsilon"] != "") where = where ", epsilon " $column["epsilon"]
      }
    }
    END {
      if (m != expected) {
        printf "demo: %d z-scores, %d expected\n", m, expected
        exit 1
      }
      limit = threshold(m)
      printf "%d z-scores, mean square %.2f; largest |z| = %.2f (%s)\n", m, sum / m, largest, where
      printf "threshold %.2f: exceeded by chance in 1 of 1000 such demos (Bonferroni, two-sided)\n", limit
      if (largest > limit) {
        print "demo: the largest |z| is not credible"
        exit 1
      }
    }' "$RESULTS"/equilibrium.csv "$RESULTS"/conditional-mean-free-time.csv
}

start_server
ask equilibrium equilibrium \
  --rho $RHO --delta $DELTAS --collisions 100000 --seed $SEED --model billiard
ask conditional-mean-free-time conditional-mean-free-time \
  --rho $RHO --delta $DELTAS --epsilon "$ENERGIES" --samples 10000 --seed $SEED \
  --model billiard
headline "ballpiston figure mean-free-time"
ballpiston figure mean-free-time --rho $RHO --delta $DELTAS --samples 10000 --seed $SEED --out "$RESULTS" --progress bar
headline "Are the deviations from the closed forms credible?"
check_z_scores
stop_server

headline "Done in $SECONDS s"
echo "The picture:  $RESULTS/mean-free-time.svg"
echo "The numbers:  $RESULTS/*.csv"
