# Temperatures along chains between a hot and a cold reservoir, and the linear law of T^(3/2)
#
# Run by `ballpiston figure temperature-profile --out DIR`, whose flags replace these values, or by
# hand: sh temperature-profile.sh. It takes some two minutes of one core.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.1}"              # of the billiard; the jump process is its limit delta -> 0
: "${cells:=4,8,16}"           # lengths of the chains
: "${hot:=1.5}"                # temperature at x = 0
: "${cold:=0.5}"               # at x = N
: "${samples:=2000}"           # replicas of each chain, of the jump process
: "${billiard_samples:=200}"   # of the billiard, which costs some fifty times as much
: "${seed:=0}"

conduct() {
  ballpiston run gas-conduction --rho "$rho" --delta "$delta" --cells "$cells" --hot "$hot" \
    --cold "$cold" --seed "$seed" --model "$1" --samples "$2" --resume --format jsonl
}
into temperature-profile-markov.jsonl conduct markov "$samples"
into temperature-profile-billiard.jsonl conduct billiard "$billiard_samples"

# The curve temperature_profile of each line, as CSV. A temperature without an error leaves that
# column empty.
profiles() {
  echo "model,cells,hot,cold,position,temperature,standard_error"
  for model in markov billiard; do
    sed -n 's/.*"cells":"\([0-9x]*\)".*"temperature_profile","points":\[{\([^]]*\)}\].*/\1 \2/p' \
      "temperature-profile-$model.jsonl" |
      while read -r n points; do
        printf '%s\n' "$points" | sed 's/},{/\n/g' |
          sed -E 's/"value":([^,]*)(,"standard_error":([^,]*))?.*"position":([^,]*).*/\4,\1,\3/
                  s/^/'"$model,$n,$hot,$cold,/"
      done
  done
}
into temperature-profile.csv profiles

draw temperature-profile
