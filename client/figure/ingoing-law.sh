# Angles of first hits beside their equilibrium law, at several delta (the paper's histograms)
#
# Run by `ballpiston figure ingoing-law --out DIR`, whose flags replace these values, or by hand:
# sh ingoing-law.sh. Time on two cores: quick 1 s, default 10 s, full 1 min.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.325,0.175,0.0125}"                  # a column of panels for each
: "${epsilon:=0.03125,0.125,0.25,0.375,0.46875}"  # energies of the piston, a row for each
: "${exponent:=0}"                                # n of the outgoing law h^(n)
: "${samples:=$(by_effort 20000 300000 1000000)}" # first hits in each panel
: "${seed:=0}"
# The histograms have 1000 bins for each sigma. This number of neighbouring bins makes one bin of
# the picture. Fewer samples need wider bins; otherwise the noise hides the deviation.
merged=$(by_effort 40 20 10)

ask ingoing-law-histograms.csv first-hit --rho "$rho" --delta "$delta" \
  --epsilon "$epsilon" --exponent "$exponent" --samples "$samples" --seed "$seed" \
  --format csv-histograms

# Writes every histogram with the wider bins. Densities are means over a bin; `error` is the
# standard error.
merge() {
  echo "delta,epsilon,exponent,sigma,alpha,density,error,exact_density"
  awk -F, -v OFS=, -v merged="$merged" '
    function flush() {
      if (n) print key, (lower + upper)/2, density/n, sqrt(count)/(samples*(upper - lower)), exact/n
      n = count = density = exact = 0
    }
    /^#/ { next }
    $1 == "rho" { for (i = 1; i <= NF; i++) at[$i] = i; next }
    $at["name"] == "alpha" {
      this = $at["delta"] "," $at["epsilon"] "," $at["exponent"] "," $at["sigma"]
      if (this != key || n == merged) flush()
      key = this
      samples = $at["samples"]
      if (!n++) lower = $at["lower"]
      upper = $at["upper"]
      count += $at["count"]
      density += $at["density"]
      exact += $at["exact_density"]
    }
    END { flush() }' ingoing-law-histograms.csv
}
into ingoing-law.csv merge

draw ingoing-law
