# Relative entropies of first hits fall to their noise floor with delta (the paper's figure)
#
# Run by `ballpiston figure relative-entropy --out DIR`, whose flags replace these values, or by
# hand: sh relative-entropy.sh. Time on two cores: quick 3 s, default 1 min, full 10 min.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=$(by_effort 0.1:0.325:5:log 0.0125:0.325:14:log 0.0125:0.325:14:log)}"
: "${epsilon:=0.03125,0.125,0.25,0.375,0.46875}"  # energies of the piston
# First hits of each point; --full has the paper's number. The noise floor falls as 1/samples.
: "${samples:=$(by_effort 30000 100000 1000000)}"
: "${seed:=0}"

ask relative-entropy.csv first-hit --rho "$rho" --delta "$delta" \
  --epsilon "$epsilon" --exponent 0,1,5,10 --samples "$samples" --seed "$seed" --format csv

draw relative-entropy
