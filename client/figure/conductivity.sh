# Conductivities of gases over the static one: against delta, and of rare exchanges against 1/N
#
# Run by `ballpiston figure conductivity --out DIR`, whose flags replace these values, or by hand:
# sh conductivity.sh. Time on two cores: quick 3 s, default 50 s, full 5 min.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"        # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.05,0.1,0.15,0.2}"      # of the billiard
: "${billiard_cells:=4}"             # in a ring, of the billiard
: "${cells:=2,3,4,6,8,16,32}"        # in a ring, of the jump process, the limit delta -> 0
: "${billiard_samples:=$(by_effort 3000 50000 300000)}"  # replicas at each delta
: "${samples:=$(by_effort 500 5000 5000)}"               # replicas of each ring
: "${seed:=0}"

measure() {
  ask "conductivity-$1.csv" gas-equilibrium --rho "$rho" --delta "$3" --cells "$4" --temperature 1 \
    --model "$2" --samples "$5" --seed "$seed" --estimate conductivity
}
measure billiard billiard "$delta" "$billiard_cells" "$billiard_samples"
# The correction of the limit depends neither on rho nor on delta.
measure rings markov "${delta%%[,:]*}" "$cells" "$samples"

draw conductivity
