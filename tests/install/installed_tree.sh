#!/bin/bash
# Installs the programs and libraries into an empty folder without root, and does there what other
# people do with them: compiles and runs the examples, asks the installed client.
#
#   installed_tree.sh BUILD_FOLDER
set -euo pipefail
build=$1

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix
export HOME=$work XDG_STATE_HOME=$work/state
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
    -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_FLAGS="-Wall -Wextra -Wpedantic -Werror"
  expect "Built target" cmake --build "$work/$example"
done
expect "delta 0.1: mean_hit_time" "$work/cpp-client/sweep"
expect "delta 0.1: mean_free_time_conditional" "$work/cpp-engine/engine"

# Every public header compiles alone, and none includes a header that is not installed.
(cd "$prefix/include" && find ballpiston -name '*.h' ! -path '*.pb.h' | sort |
  sed 's/.*/#include <&>/') >"$work/all.cc"
pkg=$(dirname "$(find "$prefix" -name ballpiston-core.pc)")
# shellcheck disable=SC2046
g++ -fsyntax-only "$work/all.cc" \
  $(PKG_CONFIG_PATH=$pkg pkg-config --cflags ballpiston-core ballpiston-client)

expect "ballpiston " ballpiston-web --version  # which `ballpiston web` starts
expect result.csv ballpiston run conditional-mean-free-time --rho 0.5296 \
  --delta 0.1 --epsilon 0.1 --save "$work/result.csv"
expect "# ensembleJobs/" head -1 "$work/result.csv"
export BALLPISTON_PYTHON=/usr/bin/python3
expect mean-free-time: ballpiston figure --list
expect figures/cell.svg ballpiston figure cell --out "$work/figures"
echo "the installed tree works"
