# Temperatures along chains between a hot and a cold reservoir, and the linear law of T^(3/2)
#
# Run by `ballpiston figure temperature-profile --out DIR`, whose flags replace these values, or by
# hand: sh temperature-profile.sh. Time on two cores: quick 2 s, default 50 s, full 15 min.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.1}"              # of the billiard; the jump process is its limit delta -> 0
: "${cells:=$(by_effort 2,4,8 4,8,16 4,8,16)}"  # lengths of the chains
: "${hot:=1.5}"                # temperature at x = 0
: "${cold:=0.5}"               # at x = N
# Replicas of each chain, for the jump process and for the billiard. The billiard costs about fifty
# times as much.
: "${samples:=$(by_effort 200 1000 20000)}"
: "${billiard_samples:=$(by_effort 20 100 2000)}"
: "${seed:=0}"

conduct() {
  ask "temperature-profile-$1.csv" gas-conduction --rho "$rho" --delta "$delta" --cells "$cells" --hot "$hot" \
    --cold "$cold" --seed "$seed" --model "$1" --samples "$2" --format csv-curves
}
conduct markov "$samples"
conduct billiard "$billiard_samples"

draw temperature-profile
