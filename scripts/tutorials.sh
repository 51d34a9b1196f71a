#!/bin/bash
# Runs the notebooks of client/examples/python with a private server of their own, and stores their
# output in them. A test compares what they print with the stored output.
#
#   scripts/tutorials.sh PROGRAMS PYTHON     the folders of the programs and of the Python package
set -euo pipefail
cd "$(dirname "$0")/.."
programs=$(realpath "$1")
scratch=$(mktemp -d)
export XDG_STATE_HOME=$scratch XDG_CONFIG_HOME=$scratch XDG_RUNTIME_DIR=$scratch
export BALLPISTON_PROGRAM=$programs/ballpiston PYDEVD_DISABLE_FILE_VALIDATION=1
PYTHONPATH=$(realpath "$2")
export PYTHONPATH
trap '"$programs/ballpiston" server stop >/dev/null 2>&1 || true; rm -rf "$scratch"' EXIT

cp client/examples/python/*.ipynb "$scratch"
(cd "$scratch" && /usr/bin/python3 -m nbconvert --to notebook --execute --inplace --log-level=WARN \
  --ExecutePreprocessor.record_timing=False ./*.ipynb)
cp "$scratch"/*.ipynb client/examples/python
