# Speed against accuracy of every method, measured on this machine
#
# Run by `ballpiston figure speed-accuracy --out DIR`, whose flags replace these values, or by hand:
# sh speed-accuracy.sh. It needs no server. No other program should be busy on the machine.
# Time on one core: quick 3 s, default 1 min, full 20 min.
set -eu
. ./figure.sh
# Panel f has a separate delta: 0.2, or the gas's bound if that is smaller.
: "${rho:=0.529561127988977}"  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.1}"              # of panels a to d
: "${epsilon:=0.125}"          # the piston's energy in panels a to c
# Panel e chooses among these deltas, at most 8. If the list is empty, panel e chooses among
# 0.2,0.1,0.05,0.025, as far as rho permits them.
: "${relaxation_delta:=}"
# Seconds of each method's largest run, 0.01 to 60.
: "${seconds:=$(by_effort 0.03 0.5 10)}"
: "${seed:=0}"

case ${BALLPISTON_PROGRESS:-auto} in
  none | json) progress=--progress=none ;;
  bar) progress=--progress=bar ;;
  *) progress= ;;  # a bar on a terminal
esac

into speed-accuracy.csv method_comparison --rho "$rho" --delta "$delta" --epsilon "$epsilon" \
  --relaxation-delta="$relaxation_delta" --seconds "$seconds" --seed "$seed" $progress

draw speed-accuracy
