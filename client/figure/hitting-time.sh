# Times to the first ball-piston collision, in equilibrium at one energy, beside the exponential law
#
# Run by `ballpiston figure hitting-time --out DIR`, whose flags replace these values, or by hand:
# sh hitting-time.sh. Time on two cores: quick 1 s, default 25 s, full 8 min.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=$(by_effort 0.325,0.2,0.1,0.05 0.325,0.2,0.1,0.05,0.0125 0.325,0.2,0.1,0.05,0.0125)}"
: "${epsilon:=0.03125,0.25,0.46875}"  # energies of the piston, a column of panels for each
: "${exponent:=1}"                    # n of the outgoing law h^(n); 1 is equilibrium
: "${samples:=$(by_effort 30000 1000000 20000000)}"  # first hits of each line
: "${seed:=0}"

# The curve `survival` is the probability that ball and piston have not collided up to a time. Its
# limit is the exponential law with the same mean free time.
ask hitting-time.csv first-hit --rho "$rho" --delta "$delta" --epsilon "$epsilon" \
  --exponent "$exponent" --samples "$samples" --seed "$seed" --format csv-curves

draw hitting-time
