#!/bin/bash
# Checks the server's locks with Clang: which mutex guards which data, and the order of the mutexes
# (server/mutex.h). Clang only parses. It parses all sources of a folder together, if the folder has
# a mutex. First it must report the seeded faults of tests/sanitizer/. Exits with 1 after any
# failure.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly GENERATED=build/thread-safety
readonly CLANG=(clang++ -std=c++20 -fsyntax-only -I. -DBALLPISTON_VERSION='"0"' -isystem "$GENERATED" -isystem /usr/include/eigen3
                -Wno-everything -Wthread-safety -Wthread-safety-beta)

generate_messages() {
  mkdir -p "$GENERATED"
  find proto -name '*.proto' -printf '%P\n' |
    xargs protoc -Iproto --cpp_out="$GENERATED" --grpc_out="$GENERATED" \
      --plugin=protoc-gen-grpc="$(command -v grpc_cpp_plugin)"
}

# Comments in the source mark the expected warnings and their lines. Other warnings are failures.
check_seeded() {
  "${CLANG[@]}" -Xclang -verify "$1" && return
  echo "thread-safety: $1: not reported as expected" >&2
  return 1
}

# Prints the name of a file that includes all sources of the folder.
together() {
  local file=$GENERATED/${1//\//_}.cc
  printf '#include "%s"\n' "$1"/*.cc >"$file"
  echo "$file"
}

folders_with_mutexes() {
  grep -rlw --include='*.h' --include='*.cc' Mutex server | xargs -n 1 dirname | sort -u
}

check_seeded tests/sanitizer/seeded_lock_faults.cc
generate_messages
for folder in $(folders_with_mutexes); do together "$folder"; done |
  xargs -n 1 -P "$(nproc)" "${CLANG[@]}" -Werror
