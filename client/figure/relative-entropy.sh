# Relative entropies of first hits fall to their noise floor with delta (the paper's figure)
#
# Run by `ballpiston figure relative-entropy --out DIR`, whose flags replace these values, or by
# hand: sh relative-entropy.sh. It takes some three minutes of one core.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.0125:0.325:14:log}"
: "${epsilon:=0.03125,0.125,0.25,0.375,0.46875}"  # energies of the piston
: "${samples:=200000}"         # first hits of each point; the noise floor falls as 1/samples
: "${seed:=0}"

into relative-entropy.csv ballpiston run first-hit --rho "$rho" --delta "$delta" \
  --epsilon "$epsilon" --exponent 0,1,5,10 --samples "$samples" --seed "$seed" --resume --format csv

draw relative-entropy
