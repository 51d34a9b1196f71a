#!/bin/bash
# Tests the page of `ballpiston web` in headless Chromium, with the programs in BIN.
#
#   scripts/web-test.sh BIN
#
# npm installs playwright-core and axe-core, in the versions of the lock file, in
# tests/web/node_modules. Node.js must have version 18.19 or newer, as in Debian 12.
set -euo pipefail
BALLPISTON_BIN=$(realpath "$1")
export BALLPISTON_BIN
cd "$(dirname "$0")/../tests/web"

# A complete installation is kept: a second run needs no network.
readonly STAMP=node_modules/.package-lock.json
if [[ ! $STAMP -nt package-lock.json ]]; then
  npm ci --no-audit --no-fund --loglevel=error
fi
exec node --test --test-reporter=spec page_test.mjs
