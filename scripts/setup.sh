#!/bin/bash
# Installs the Debian packages that the programs and the demo need. It installs only missing
# packages, so a second run changes nothing and needs no network.
#
#   scripts/setup.sh [FURTHER_PACKAGE...]
#
# A package for another architecture is written as PACKAGE:ARCHITECTURE. It is installed beside this
# machine's own packages.
#
# With SKIP_SETUP=1 in the environment it installs nothing: then you install the libraries yourself.
# It still rejects a CMake that is too old.
set -euo pipefail

readonly LEAST_CMAKE=3.25
readonly PACKAGES=(
  g++ cmake ninja-build ccache                                 # the build
  libgrpc++-dev libprotobuf-dev                                # the service
  protobuf-compiler protobuf-compiler-grpc
  libabsl-dev libeigen3-dev libhwy-dev librandom123-dev        # the core
  libboost-dev                                                 # its numbers of more than 64 bits
  libsqlite3-dev libssl-dev                                    # the store, the door
  zlib1g-dev                                                   # compressed rows and files
  prometheus-cpp-dev                                           # metrics
  libcli11-dev                                                 # the flags of both programs
  libcpp-httplib-dev pkgconf                                   # the client's page
  python3 python3-grpcio python3-matplotlib python3-numpy)     # the Python package and the figures

# The version of the installed CMake; without CMake, the version of its package; empty if unknown.
cmake_version() {
  if command -v cmake >/dev/null; then
    cmake --version | awk 'NR == 1 {print $3}'
  elif command -v apt-cache >/dev/null; then
    LC_ALL=C apt-cache policy cmake | awk '/Candidate:/ && $2 != "(none)" {sub(/-[^-]*$/, "", $2); print $2}'
  fi
}

require_cmake() {
  local version
  version=$(cmake_version)
  [[ -n $version && $(printf '%s\n' "$LEAST_CMAKE" "$version" | sort -V | head -1) != "$LEAST_CMAKE" ]] ||
    return 0
  echo "setup: CMake $version is too old; permitted: $LEAST_CMAKE (Debian 12) or newer" >&2
  exit 1
}

missing_of() {
  local own installed
  own=$(dpkg --print-architecture)
  installed=$(dpkg-query -W -f='${Package} ${Architecture} ${db:Status-Status}\n' "$@" 2>/dev/null |
    awk -v own="$own" '$3 == "installed" {print $1 ":" $2; if ($2 == own || $2 == "all") print $1}') || true
  comm -23 <(printf '%s\n' "$@" | sort -u) <(sort -u <<<"$installed")
}

as_root() {
  if [[ $(id -u) == 0 ]]; then "$@"; else sudo "$@"; fi
}

apt_get() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Acquire::Retries=3 \
    -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 "$@" >"$log" 2>&1 && return
  cat "$log" >&2
  echo "setup: apt-get $1 failed (its messages are above)" >&2
  exit 1
}

# Registers the architecture of each package:architecture, so that dpkg accepts the package.
add_architectures() {
  local package
  for package; do
    [[ $package != *:* ]] || as_root dpkg --add-architecture "${package##*:}"
  done
}

require_cmake
[[ ${SKIP_SETUP:-0} != 1 ]] || exit 0
if ! command -v dpkg-query >/dev/null; then
  echo "setup: not a Debian system; install these packages, or the same libraries, yourself:" \
    "${PACKAGES[*]} $*" >&2
  exit 0
fi

mapfile -t missing < <(missing_of "${PACKAGES[@]}" "$@")
((${#missing[@]})) || exit 0

if [[ $(id -u) != 0 ]] && ! command -v sudo >/dev/null; then
  echo "setup: packages are missing; to install them, root or sudo is needed." >&2
  echo "setup: as root, run:  apt-get install ${missing[*]}" >&2
  exit 1
fi
echo "setup: installing ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
add_architectures "${missing[@]}"
apt_get update
require_cmake
apt_get install -y --no-install-recommends "${missing[@]}"
