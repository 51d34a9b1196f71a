# The generator's spectrum of relaxation rates, and energy autocorrelations of the billiard
#
# Run by `ballpiston figure spectrum --out DIR`, whose flags replace these values, or by hand:
# sh spectrum.sh. By default it takes half a minute of two cores.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"   # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.3,0.2,0.1}"       # of the billiard; the spectrum is that of the limit delta -> 0
: "${samples:=$(by_effort 20000 500000 20000000)}"  # orbits
: "${seed:=0}"

# The total rate f(epsilon), whose values are the continuum.
into spectrum-rate.csv ballpiston analytic --rho "$rho" --delta "$delta" --epsilon 0:0.5:201 \
  --format csv
ask spectrum.csv energy-relaxation --rho "$rho" --delta "${delta%%[,:]*}" \
  --model spectrum --format csv
ask spectrum-billiard.csv energy-relaxation --rho "$rho" --delta "$delta" \
  --samples "$samples" --seed "$seed" --model billiard --format csv-curves

draw spectrum
