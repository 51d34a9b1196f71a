#!/bin/bash
# Runs about a dozen specifications on the ladder of models, and compares the plan with the run.
#
#   scripts/ladder.sh FOLDER_OF_PROGRAMS
#
# Prints a table in Markdown: the chosen model, the predicted and measured processor time, and the
# predicted and measured relative error of the first estimate. Starts a separate private server, in
# a folder that is deleted at the end. The times are measured on this machine: no other program
# should be busy.
set -euo pipefail
PATH=$(cd "$1" && pwd):$PATH
readonly RHO=0.529561127988977

data=$(mktemp -d)
stop_server() {
  ballpiston server stop --data-dir "$data" || true
  rm -rf "$data"
}
trap stop_server EXIT
BALLPISTON_SERVER=$(ballpiston server start --data-dir "$data")
export BALLPISTON_SERVER

# Of a plan: its whole work, and the first point's chosen model, statistical error and model error.
planned() {
  ballpiston plan "$@" --format json | number work | tail -n 1
  ballpiston plan "$@" --format csv |
    awk -F, 'NR > 1 && $6 == "true" && !seen++ {
      print $5, ($10 == "" ? "-" : $10), ($11 == "" ? "-" : $11)
    }'
}

# The values of a JSON field, one per line.
number() { tr ',' '\n' | sed -n 's/.*"'"$1"'": *\([-+0-9.e]*\).*/\1/p'; }

# The relative standard error of the first estimate, or - if there is none.
measured_error() {
  awk -F, 'NR == 2 { if ($9 == "") print "-"; else { e = $9 / $8; print (e < 0 ? -e : e) } }'
}

ask() {
  local question=$1 plan job work error
  shift
  plan=$(planned "$@" --rho "$RHO" | tr '\n' ' ')
  job=$(ballpiston submit "$@" --rho "$RHO" --fresh)
  ballpiston watch "$job" --progress none
  error=$(ballpiston result "$job" --format csv | measured_error)
  work=$(ballpiston result "$job" --format json | number work | sed -n 1p)
  printf '%s|%s|%s|%s\n' "$question" "$plan" "$work" "$error" |
    awk -F'|' '{
      split($2, p, " ")
      errors = p[3] > 0 && $4 != "-" ? sprintf("%.2f", $4 / p[3]) : "-"
      printf "| %s | %s | %.2g s | %.2g s | %.2f | %s | %.2g | %s | %s |\n", $1, p[2], p[1], $3,
        $3 / p[1], (p[3] == "-" ? "-" : sprintf("%.2g", p[3])), $4, errors,
        (p[4] == "-" ? "-" : sprintf("%.2g", p[4]))
    }'
}

cat <<'EOF'
| question | model | predicted work | measured | ratio | predicted error | measured | ratio | model error |
|:--|:--|--:|--:|--:|--:|--:|--:|--:|
EOF
ask 'mean free time at delta = 0.1 to 1e-6' equilibrium --delta 0.1 --tolerance 1e-6
ask 'the same by simulation, to 1e-3' equilibrium --delta 0.1 --tolerance 1e-3 --verify
ask 'mean free time at 30 energies' conditional-mean-free-time --delta 0.1 --epsilon 0.01:0.49:30
ask 'one of them verified, delta = 0.0125, 2e4 samples' \
  conditional-mean-free-time --delta 0.0125 --epsilon 0.125 --samples 20000 --verify
ask 'ingoing law at delta = 0.3, 1e6 hits' \
  first-hit --delta 0.3 --epsilon 0.125 --exponent 0 --samples 1000000
ask 'mean hit time at delta = 0.05 to 0.3 %' \
  first-hit --delta 0.05 --epsilon 0.25 --exponent 5 --tolerance 0.003
ask 'relaxation time at delta = 0.2 to 0.5 %' energy-relaxation --delta 0.2 --tolerance 0.005
ask 'relaxation time at delta = 0.0125 to 1 %' energy-relaxation --delta 0.0125 --tolerance 0.01
ask 'relaxation time at delta = 0.05 in 3 s' energy-relaxation --delta 0.05 --budget 3
ask 'decay from epsilon = 0.4 at delta = 0.1 to 1 %' \
  energy-relaxation --delta 0.1 --epsilon 0.4 --tolerance 0.01
ask 'the jump process itself, 1e6 orbits' \
  energy-relaxation --delta 0.1 --model markov --samples 1000000
ask 'memory of the exchange before last, delta = 0.1' \
  markov-property --delta 0.1 --collisions 2000000
