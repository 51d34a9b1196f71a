#!/bin/bash
# Builds the Debian packages of the last commit, and checks them with lintian.
#
#   scripts/deb.sh [FOLDER]      by default build/deb; the packages are FOLDER/*.deb
#
# The sources are those of the last commit: changes that are not committed are not packaged.
set -euo pipefail
cd "$(dirname "$0")/.."
out=$(realpath -m "${1:-build/deb}")

version=$(dpkg-parsechangelog --show-field Version)
source=$out/ballpiston-$version
rm -rf "$out"/ballpiston-[0-9]* "$out"/*ballpiston*_*
mkdir -p "$source"
git archive HEAD | tar -x -C "$source"

# Packages of debug symbols would be installed by `apt install build/deb/*.deb`.
export DEB_BUILD_OPTIONS="noautodbgsym ${DEB_BUILD_OPTIONS:-}"
# debhelper gives the build a home folder of its own, which would be without a compiler cache.
export CCACHE_DIR=${CCACHE_DIR:-$HOME/.cache/ccache}
if ! (cd "$source" && dpkg-buildpackage --unsigned-source --unsigned-changes) >"$out/build.log" 2>&1; then
  tail -n 60 "$out/build.log"
  echo "deb: the build failed; all of its output is in $out/build.log" >&2
  exit 1
fi
# As root lintian needs to be told that this is intended.
lintian --allow-root --fail-on error,warning "$out"/ballpiston_*.changes
printf '%s\n' "$out"/*.deb
