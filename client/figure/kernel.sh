# The jump kernel W, exact and from the billiard's orbits: the piston's energy after a collision
#
# Run by `ballpiston figure kernel --out DIR`, whose flags replace these values, or by hand:
# sh kernel.sh. By default it takes half a minute of one core.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"        # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.3}"                    # of the billiard; W depends neither on rho nor on delta
: "${epsilon:=0.05,0.125,0.25,0.4}"  # the piston's energy before the collision, one panel each
: "${seed:=0}"                       # of the first orbit; the next orbits have the next seeds
orbits=$(by_effort 3 50 1000)
events=20000                         # of each orbit
window=0.0125                        # half width of the interval of energies around each epsilon
bins=$(by_effort 8 20 40)

into kernel.jsonl ballpiston analytic --rho "$rho" --delta "$delta" --epsilon "$epsilon" \
  --outgoing-epsilon 0.001:0.499:499 --format jsonl
# One line for each energy: the energy, its total rate f, and its kernel.
kernels() {
  sed 's/.*"energies":\[//; s/{"epsilon"/\n&/g' kernel.jsonl |
    sed -n 's/^{"epsilon":\([^,]*\),.*"f":\([^,]*\),.*"kernel":\[\([^]]*\)\].*/\1,\2,\3/p'
}
into .kernels.$$ kernels
# W is a density of rates; W/f is the density of the energy after a collision.
exact() {
  echo "epsilon,outgoing,density"
  awk -F, '{for (i = 3; i <= NF; ++i) printf "%s,%.3f,%.9g\n", $1, (i - 2)/1000, $i/$2}' \
    .kernels.$$
}
into kernel-exact.csv exact

# The piston's energies before and after each collision with the ball.
collisions() {
  i=0
  while [ "$i" -lt "$orbits" ]; do
    ballpiston trace --rho "$rho" --delta "$delta" --events "$events" --seed "$((seed + i))" \
      >".kernel-orbit.$$"
    sed -n '/"event":"ball_piston"/{
      s/.*"piston_energy_before":\([^,]*\),"piston_energy":\([^,}]*\).*/\1,\2/p
    }' ".kernel-orbit.$$"
    i=$((i + 1))
  done
}
into kernel-collisions.csv collisions

# Histograms with bins of equal width in u = sqrt(2 epsilon) after the collision, because the
# density of u is finite at 0. The bins end one window below the largest outgoing energy, 1/2 -
# epsilon, where W diverges.
histograms() {
  echo "epsilon,outgoing,density,standard_error,count,samples"
  awk -F, -v window="$window" -v bins="$bins" '
    FNR == NR { epsilon[++n] = $1; end[n] = 1 - 2*($1 + window); next }
    {
      for (i = 1; i <= n; ++i) {
        if ($1 - epsilon[i] < window && epsilon[i] - $1 < window) {
          ++samples[i]
          if (2*$2 < end[i]) ++count[i, int(bins*sqrt(2*$2/end[i]))]
        }
      }
    }
    END {
      for (i = 1; i <= n; ++i) {
        for (k = 0; k < bins && samples[i] > 0 && end[i] > 0; ++k) {
          u = (k + 0.5)/bins*sqrt(end[i])
          scale = samples[i]*u*sqrt(end[i])/bins
          m = count[i, k] + 0
          print epsilon[i] "," u*u/2 "," m/scale "," sqrt(m)/scale "," m "," samples[i]
        }
      }
    }' .kernels.$$ kernel-collisions.csv
}
into kernel-measured.csv histograms

draw kernel
