#!/bin/bash
# Charts speed against accuracy: every method of computing the pair, from a naive one with fixed
# time steps to the closed form and the limit of rare collisions. Takes a minute or so.
#
#   scripts/chart.sh FOLDER_OF_PROGRAMS
#
# The client starts its private server, in a folder of its own that goes when the chart is made. The
# times are those of this machine, so nothing else should be busy on it.
set -euo pipefail
cd "$(dirname "$0")/.."
programs=$(cd "$1" && pwd)
readonly programs RESULTS=chart
readonly PARAMETERS=(--rho 0.529561127988977 --delta 0.1 --epsilon 0.125 --seconds 1 --seed 0)

# What the client starts as its server: tells which process that is, so that it can be ended.
write_starter() {
  printf '#!/bin/sh\necho $$ >"%s/server.pid"\nexec "%s/ballpistond" "$@"\n' \
    "$private" "$programs" >"$private/ballpistond"
  chmod +x "$private/ballpistond"
}

clean_up() {
  local server
  if server=$(cat "$private/server.pid" 2>/dev/null); then
    kill "$server" 2>/dev/null || true
    while kill -0 "$server" 2>/dev/null; do sleep 0.05; done
  fi
  rm -rf "$private"
}

private=$(mktemp -d)  # a short path: that of a Unix socket may have 100 bytes
trap clean_up EXIT
write_starter
unset BALLPISTON_SERVER
export XDG_STATE_HOME=$private BALLPISTON_SERVER_PROGRAM=$private/ballpistond

printf '\n== ballpiston figure speed-accuracy %s\n' "${PARAMETERS[*]}"
"$programs/ballpiston" figure speed-accuracy "${PARAMETERS[@]}" --out "$RESULTS" --progress bar

printf '\n== Done in %d s\n' "$SECONDS"
echo "The picture:  $RESULTS/speed-accuracy.svg"
echo "The numbers:  $RESULTS/speed-accuracy.csv"
