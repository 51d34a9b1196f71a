# Relaxation of the piston's energy: from given energies, and in equilibrium, beside the limit
#
# Run by `ballpiston figure relaxation --out DIR`, whose flags replace these values, or by hand:
# sh relaxation.sh. Time on two cores: quick 2 s, default 25 s, full 4 min.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"         # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.2,0.1,0.05}"            # of the billiard; the lines are the limit delta -> 0
: "${epsilon:=0.01,0.125,0.375,0.49}" # energies of the piston at the start
: "${samples:=$(by_effort 20000 200000 2000000)}"  # orbits from each start, and in equilibrium
: "${seed:=0}"

# With --epsilon the result is the mean energy, without --epsilon the autocorrelation of the energy.
relax() {
  file=relaxation-$1.csv
  shift
  ask "$file" energy-relaxation --rho "$rho" --delta "$delta" --model billiard \
    --samples "$samples" --seed "$seed" --format csv-curves "$@"
}
relax energy --epsilon "$epsilon"
relax autocorrelation
# The mean free times, which are the units of time.
into relaxation-times.csv ballpiston analytic --rho "$rho" --delta "$delta" --format csv

draw relaxation
