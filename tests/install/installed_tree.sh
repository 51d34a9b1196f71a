#!/bin/bash
# Installs the programs and libraries into an empty folder without root, and does there what other
# people do with them: compiles and runs the examples, asks the installed client.
#
#   installed_tree.sh BUILD_FOLDER
set -euo pipefail
build=$1

work=$(mktemp -d)
prefix=$work/prefix
unset "${!BALLPISTON_@}"
export HOME=$work XDG_STATE_HOME=$work/state XDG_CONFIG_HOME=$work/config
trap '{ "$prefix/bin/ballpiston" server stop; rm -rf "$work"; } &>/dev/null || true' EXIT
mkdir "$XDG_STATE_HOME"

# expect TEXT COMMAND: the command's output has to contain the text.
expect() {
  local text=$1 output
  shift
  output=$("$@" 2>&1) || { printf '%s\n' "$* failed:" "$output" >&2; exit 1; }
  [[ $output == *"$text"* ]] || { printf '%s\n' "$* printed no \"$text\":" "$output" >&2; exit 1; }
}

expect libballpiston_core.a cmake --install "$build" --prefix "$prefix"
export PATH=$prefix/bin:$PATH

for example in cpp-client cpp-engine; do
  expect "Build files" cmake -S "$prefix/share/ballpiston/examples/$example" -B "$work/$example" \
    -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_FLAGS="-Wall -Wextra -Wpedantic -Werror -march=native"
  expect "Built target" cmake --build "$work/$example"
done
expect "delta 0.1: mean_hit_time" "$work/cpp-client/sweep"
expect "delta 0.1: mean_free_time_conditional" "$work/cpp-engine/engine"

# Every public header compiles alone, and none includes a header that is not installed.
(cd "$prefix/include" && find ballpiston -name '*.h' ! -path '*.pb.h' | sort |
  sed 's/.*/#include <&>/') >"$work/all.cc"
pkg=$(dirname "$(find "$prefix" -name ballpiston-core.pc)")
# shellcheck disable=SC2046
g++ -std=c++20 -fsyntax-only "$work/all.cc" \
  $(PKG_CONFIG_PATH=$pkg pkg-config --cflags ballpiston-core ballpiston-client)

# In a shared library, compiled for this processor: the same bits.
cat >"$work/flow.cc" <<'END'
#include <ballpiston/core/billiard/event_flow.h>
#include <ballpiston/core/sampling/invariant_measure.h>

#include <iostream>

int main() {
  using namespace ballpiston;
  const PairGeometry pair = *PairGeometry::Create(0.5296, 0.2);
  CounterRandom random(1, 2, 3);
  ReferenceFlow flow(pair, DrawFromFlowMeasure(pair, random));
  double time = 0;
  for (int i = 0; i < 30; ++i) {
    const auto event = flow.Step();
    time += event.duration;
    if (event.kind == EventKind::kBallPiston) flow.ExchangeComponents();
  }
  std::cout << std::hexfloat << time;
}
END
read -ra flags < <(PKG_CONFIG_PATH=$pkg pkg-config --cflags --libs ballpiston-core)
g++ -std=c++20 "$work/flow.cc" "${flags[@]}" -o "$work/flow"
g++ -std=c++20 -O2 -march=native -fPIC -shared "$work/flow.cc" "${flags[@]}" -o "$work/flow.so"
g++ "$work/flow.so" -o "$work/native-flow"
bits=$("$work/flow")
[[ -n $bits ]]
expect "$bits" "$work/native-flow"

expect "ballpiston " ballpiston-web --version  # which `ballpiston web` starts
expect result.csv ballpiston run conditional-mean-free-time --rho 0.5296 \
  --delta 0.1 --epsilon 0.1 --save "$work/result.csv"
expect "# ensembleJobs/" head -1 "$work/result.csv"
export BALLPISTON_PYTHON=/usr/bin/python3
expect mean-free-time: ballpiston figure --list
expect figures/cell.svg ballpiston figure cell --out "$work/figures"
echo "the installed tree works"
