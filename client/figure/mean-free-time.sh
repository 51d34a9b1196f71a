# Conditional collision rates collapse on one curve (the paper's figure of mean free times)
#
# Run by `ballpiston figure mean-free-time --out DIR`, whose flags replace these values, or by hand:
# sh mean-free-time.sh. Time on two cores: quick 1 s, default 2 s, full 3 min.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.2,0.1,0.05}"
# Samples at each energy and delta; the paper has 10000.
: "${samples:=$(by_effort 1000 10000 1000000)}"
# Collisions at each delta of the inset. There are more of them, because they are correlated.
: "${collisions:=$(by_effort 10000 100000 10000000)}"
: "${seed:=0}"
# The paper's 59 energies: 1/100, ..., 49/100, and 1/200, 1/400, ..., 1/3200 from both ends.
energies=0.0003125,0.000625,0.00125,0.0025,0.005,0.01:0.49:49,0.495,0.4975,0.49875,0.499375,0.4996875

# --model billiard is needed: by default the server would answer with the closed forms that the
# figure tests.
ask mean-free-time.csv conditional-mean-free-time --rho "$rho" --delta "$delta" \
  --epsilon "$energies" --samples "$samples" --seed "$seed" --model billiard --format csv
ask mean-free-time-inset.csv equilibrium --rho "$rho" --delta "$delta" \
  --collisions "$collisions" --seed "$seed" --model billiard --format csv

# The exact curves: phi, the same at every delta, and the rate up to the largest delta.
into mean-free-time-phi.csv ballpiston analytic --rho "$rho" --delta "$delta" --epsilon 0:0.5:201 \
  --format csv
bound=$(ballpiston analytic --rho "$rho" --delta 1e-9 --format jsonl |
  sed 's/.*"pair_delta_bound":\([^,}]*\).*/\1/')
into mean-free-time-rate.csv ballpiston analytic --rho "$rho" --delta "0.00001:$bound:300:log" \
  --format csv

draw mean-free-time
