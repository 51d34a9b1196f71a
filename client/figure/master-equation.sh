# Laws of the piston's energy at six times after a start at one energy, beside the master equation
#
# Run by `ballpiston figure master-equation --out DIR`, whose flags replace these values, or by
# hand: sh master-equation.sh. Time on two cores: quick 1 s, default 10 s, full 2 min.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.2,0.05}"         # of the billiard; the lines are the limit delta -> 0
: "${epsilon:=0.0625}"         # energies of the piston at the start; two rows of panels for each
: "${samples:=$(by_effort 20000 1000000 10000000)}"  # orbits of each delta, and of the jump process
: "${seed:=0}"

# In units of the mean free time, the times and the law of the jump process are the same at every
# delta. Therefore one delta is enough for the jump process.
law() {
  ask "master-equation-$1.csv" energy-relaxation --rho "$rho" --epsilon "$epsilon" --model "$1" \
    --delta "$2" --samples "$samples" --seed "$seed" --format csv-histograms
}
law billiard "$delta"
law markov "${delta%%[,:]*}"

into master-equation-times.csv ballpiston analytic --rho "$rho" --delta "$delta" --format csv

# All laws in one table, with times in units of the mean free time. The error is binomial. A bin
# without an orbit has the binomial error of the exact law.
laws() {
  echo "model,delta,epsilon,time,lower,upper,density,error,exact,ratio,ratio_error"
  awk -F, -v OFS=, '
    /^#/ { next }
    $1 == "rho" { for (i = 1; i <= NF; i++) at[$i] = i; next }
    FILENAME ~ /times/ { tau[$at["delta"]] = $at["tau_ball_piston"]; next }
    $at["name"] == "piston_energy" {
      samples = $at["samples"]
      width = $at["upper"] - $at["lower"]
      exact = $at["exact_density"]
      share = $at["count"] ? $at["count"]/samples : exact*width
      error = sqrt(share*(1 - share)/samples)/width
      print $at["model"], $at["delta"], $at["epsilon"], \
        sprintf("%.3g", $at["time"]/tau[$at["delta"]]), $at["lower"], $at["upper"], \
        $at["density"], error, exact, $at["density"]/exact, error/exact
    }' master-equation-times.csv master-equation-billiard.csv master-equation-markov.csv
}
into master-equation.csv laws

draw master-equation
